"""Comparison of two folders of results, file by file, apart from times.

    python benchmarks/same_results.py before/results/smoke after/results/smoke

A refactoring keeps every byte of weights, meshes, fields and pictures, and every value of tables and JSON.
Times, memory, paths and versions differ from run to run and are left out; logs, checkpoints and benchmark
files are not compared. Exit code 1 where anything else differs.
"""

import argparse
import csv
import io
import json
import re
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

SKIPPED = re.compile(r"(^|/)(logs|benchmarks|events)/|checkpoint|\.snakemake|runtime\.|report\.html$")
"""Files that hold nothing but times, or that no later stage reads."""

TIMES = re.compile(r"seconds|minutes|hours|_mib$|^cpu|^wall|version|^device")
"""Columns and keys whose values differ between equal runs."""


def main() -> int:
    """Compare, print what differs, and say how much was equal."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    arguments = parser.parse_args()
    before, after = (set(list_files(folder)) for folder in (arguments.before, arguments.after))
    problems = [f"only before: {name}" for name in sorted(before - after)]
    problems += [f"only after: {name}" for name in sorted(after - before)]
    for name in sorted(before & after):
        problems += [
            f"{name}: {what}" for what in differences(arguments.before / name, arguments.after / name)
        ]
    print("\n".join([*problems, f"{len(before & after)} files compared, {len(problems)} differences"]))
    return int(bool(problems))


def list_files(folder: Path) -> Iterator[str]:
    """Paths of all files that are compared, relative to the folder."""
    for path in folder.rglob("*"):
        name = path.relative_to(folder).as_posix()
        if path.is_file() and not SKIPPED.search(name):
            yield name


def differences(before: Path, after: Path) -> list[str]:
    """How two files of one name differ; nothing where they are equal."""
    if before.read_bytes() == after.read_bytes():
        return []
    if before.suffix == ".json":
        return _of_values(json.loads(before.read_text()), json.loads(after.read_text()), "")
    if before.suffix == ".csv":
        return _of_tables(before.read_text(), after.read_text())
    if before.suffix == ".zip":
        return _of_archives(before, after)
    if before.suffix == ".md":
        return [] if _without_times(before) == _without_times(after) else ["text"]
    return ["bytes"]


def _of_values(before: Any, after: Any, place: str) -> list[str]:
    if isinstance(before, dict) and isinstance(after, dict):
        found = [f"{place}.{key} added" for key in after.keys() - before.keys() if not TIMES.search(key)]
        found += [f"{place}.{key} gone" for key in before.keys() - after.keys() if not TIMES.search(key)]
        for key in before.keys() & after.keys():
            if not TIMES.search(key):
                found += _of_values(before[key], after[key], f"{place}.{key}")
        return found
    if isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        return [
            one
            for number, pair in enumerate(zip(before, after, strict=True))
            for one in _of_values(*pair, f"{place}[{number}]")
        ]
    return [] if before == after else [f"{place}: {before!r:.80} -> {after!r:.80}"]


def _of_tables(before: str, after: str) -> list[str]:
    rows = [list(csv.DictReader(io.StringIO(text))) for text in (before, after)]
    if len(rows[0]) != len(rows[1]):
        return [f"{len(rows[0])} rows -> {len(rows[1])}"]
    return [
        one
        for number, pair in enumerate(zip(*rows, strict=True))
        for one in _of_values(*pair, f"row {number}")
    ]


def _of_archives(before: Path, after: Path) -> list[str]:
    with zipfile.ZipFile(before) as one, zipfile.ZipFile(after) as other:
        names = set(one.namelist()) | set(other.namelist())
        return [
            f"member {name}"
            for name in sorted(names)
            if not name.endswith(".csv")
            and (
                name not in one.namelist()
                or name not in other.namelist()
                or one.read(name) != other.read(name)
            )
        ]


def _without_times(path: Path) -> list[str]:
    """Lines of a Markdown table with numbers of minutes and memory taken out."""
    return [re.sub(r"[\d.]+ (min|s|MiB|GiB)\b", "", line) for line in path.read_text().splitlines()]


if __name__ == "__main__":
    sys.exit(main())
