"""A copy of the workflow in an empty folder, in which Snakemake runs as a person would run it."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent.parent
TARGETS = ["results/smoke/tables/chair.csv", "results/smoke/figures/chair/samples.png"]


class Project:
    """A folder with the workflow in it, in which Snakemake runs as a person would run it.

    `told` is the output of the smoke run.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        for name in ("config", "workflow"):
            shutil.copytree(ROOT / name, folder / name)
        shutil.copy(ROOT / "Snakefile", folder)

    def snakemake(self, *arguments: str) -> subprocess.CompletedProcess:
        scripts = Path(sys.executable).parent
        return subprocess.run(
            [scripts / "snakemake", *arguments, "--cores", "2"],
            cwd=self.folder,
            env=os.environ | {"PATH": f"{scripts}{os.pathsep}{os.environ['PATH']}"},
            capture_output=True,
            text=True,
            check=False,
        )

    def smoke(self, *arguments: str) -> subprocess.CompletedProcess:
        return self.snakemake(*arguments, "--configfile", "config/smoke.yaml")


def planned(result: subprocess.CompletedProcess) -> dict[str, int]:
    """Jobs of a dry run by rule, from the table of job counts."""
    assert result.returncode == 0, result.stdout + result.stderr
    jobs = {}
    for line in result.stdout.splitlines():
        words = line.split()
        if len(words) == 2 and words[1].isdigit() and not words[0].endswith(":") and words[0] != "total":
            jobs[words[0]] = int(words[1])
    return jobs
