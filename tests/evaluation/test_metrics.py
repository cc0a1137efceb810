"""The list of metrics, and docs/metrics.md beside it."""

import re
from pathlib import Path

from tetgan.evaluation.metrics import BY_NAME, GROUPS, METRICS, names_of

DOCS = Path(__file__).parents[2] / "docs" / "metrics.md"


def documented() -> dict[str, list[str]]:
    """Rows of the tables of the docs, by the heading above them."""
    found: dict[str, list[str]] = {}
    heading = ""
    for line in DOCS.read_text().splitlines():
        if line.startswith("#"):
            heading = line.lstrip("# ")
        elif line.startswith("| `"):
            found.setdefault(heading, []).append(line)
    return found


def test_the_docs_have_every_metric_as_the_list_has_it():
    expected = {
        GROUPS[group]: [
            f"| `{name}` | {BY_NAME[name].heading} | {BY_NAME[name].meaning} |" for name in names_of(group)
        ]
        for group in GROUPS
    }
    assert documented() == expected


def test_names_are_unique_and_every_group_has_a_metric():
    assert len(BY_NAME) == len(METRICS)
    assert {metric.group for metric in METRICS} == set(GROUPS)
    assert all(re.fullmatch("[a-z][a-z0-9_]*", name) for name in BY_NAME)
