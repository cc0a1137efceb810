"""Time in which the command line answers `--help`."""

import subprocess
import sys

from records import Records, record, wall_seconds


def run(quick: bool) -> Records:
    """The fastest of several starts, each in a process of its own."""
    command = [sys.executable, "-m", "tetgan", "--help"]
    seconds, _ = wall_seconds(
        lambda: subprocess.run(command, check=True, capture_output=True), repeats=2 if quick else 5
    )
    return {"tetgan --help": record(seconds, "s", 1.5)}


if __name__ == "__main__":
    print(run(quick=False))
