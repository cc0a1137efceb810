"""Provenance of results: code, packages, machine, seeds, and the time of each stage."""

import json
import os
import platform
import re
import subprocess
from collections.abc import Iterator, Mapping
from importlib import metadata
from pathlib import Path
from typing import Any

import pandas as pd
import torch

import tetgan
from tetgan.errors import UserError


def package_versions() -> dict[str, str]:
    """Versions of Python, of this package and of what it depends on directly."""
    versions = {"python": platform.python_version(), "tetgan": metadata.version("tetgan")}
    for requirement in sorted(metadata.requires("tetgan") or (), key=str.lower):
        name = re.match(r"[\w.-]+", requirement)
        if name and "extra ==" not in requirement:
            versions[name.group()] = _installed(name.group())
    return versions


def _installed(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return "not installed"


def code_commit(folder: Path | None = None) -> str:
    """Commit of the checkout that the package runs from, and whether files differ from it.

    Args:
        folder: another folder than the package's.
    """
    folder = folder or Path(tetgan.__file__).parent
    # A package installed below somebody else's checkout is no part of it.
    if _git(folder, "ls-files", "--error-unmatch", "__init__.py") is None:
        return "not a git checkout"
    commit = _git(folder, "rev-parse", "HEAD")
    if commit is None:
        return "no commit yet"
    return f"{commit} with uncommitted changes" if _git(folder, "diff", "HEAD", "--name-only") else commit


def _git(folder: Path, *arguments: str) -> str | None:
    """Output of git, or None where it fails or is missing."""
    try:
        result = subprocess.run(
            ["git", "-C", str(folder), *arguments], capture_output=True, text=True, check=True
        )
    except (OSError, subprocess.CalledProcessError):
        return None
    return result.stdout.strip()


def machine() -> dict[str, str]:
    """The machine that this runs on."""
    cuda = torch.cuda.is_available()
    return {
        "system": f"{platform.system()} {platform.release()} {platform.machine()}",
        "processor": _processor(),
        "cores": str(os.cpu_count()),
        "memory": f"{os.sysconf('SC_PAGE_SIZE') * os.sysconf('SC_PHYS_PAGES') / 2**30:.0f} GiB",
        "device": torch.cuda.get_device_name() if cuda else "cpu (no CUDA device)",
    }


def _processor() -> str:
    listed = Path("/proc/cpuinfo")
    found = re.search(r"model name\s*:\s*(.+)", listed.read_text()) if listed.exists() else None
    return found.group(1) if found else platform.processor() or "unknown"


def training_devices(results: Path) -> dict[str, str]:
    """Device that each network was trained on; empty where it was not kept.

    Models go by `{category}/{model}/{seed}`, the extractor of FID's features by `extractor`.
    """
    found = {}
    for path in sorted([*results.glob("models/*/*/*/options.json"), *results.glob("extractor/options.json")]):
        try:
            device = json.loads(path.read_text(encoding="utf-8")).get("device", "")
        except (ValueError, AttributeError):
            raise UserError(f"{path}: not the options of a trained model; train it again") from None
        found["/".join(path.relative_to(results).parts[:-1]).removeprefix("models/")] = str(device)
    return found


def seeds_of(config: Mapping[str, Any]) -> dict[str, str]:
    """Every seed of a configuration under its dotted key."""
    return {key: _listed(value) for key, value in _leaves(config) if key.split(".")[-1] in ("seed", "seeds")}


def _listed(value: Any) -> str:
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)


def _leaves(part: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in part.items():
        if isinstance(value, Mapping):
            yield from _leaves(value, f"{above}{key}.")
        else:
            yield f"{above}{key}", value


def stage_times(benchmarks: Path) -> pd.DataFrame:
    """Time and memory of each stage from Snakemake's benchmark files, the longest stage first.

    Returns:
        Columns `stage`, `jobs`, `minutes` of all of them, `longest` in minutes, `peak` memory of a job in
        MiB (missing where Snakemake measured none).

    Raises:
        UserError: a file is no benchmark.
    """
    records = [
        {"stage": path.relative_to(benchmarks).with_suffix("").parts[0], **_benchmark(path)}
        for path in sorted(benchmarks.rglob("*.tsv"))
    ]
    table = pd.DataFrame(records, columns=["stage", "seconds", "peak"])
    stages = table.groupby("stage", as_index=False).agg(
        jobs=("seconds", "size"), minutes=("seconds", "sum"), longest=("seconds", "max"), peak=("peak", "max")
    )
    stages[["minutes", "longest"]] /= 60
    return stages.sort_values(["minutes", "stage"], ascending=[False, True], ignore_index=True)


def _benchmark(path: Path) -> dict[str, float]:
    """Seconds and MiB of one job; of repeated measurements the mean time and the peak memory."""
    try:
        table = pd.read_csv(path, sep="\t")[["s", "max_rss"]].apply(pd.to_numeric, errors="coerce")
    except (ValueError, KeyError) as error:
        raise UserError(f"{path}: not a benchmark of Snakemake ({error}); remove it") from None
    return {"seconds": float(table["s"].mean()), "peak": float(table["max_rss"].max())}
