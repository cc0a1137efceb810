"""A mistake in the config stops the workflow at once, with one line that names it."""

import pytest


@pytest.mark.parametrize(
    ("config", "words"),
    [
        ("training={tetgan: {epoch: 3}}", ["training.tetgan.epoch", "did you mean 'epochs'"]),
        ("grids={LR: {cells: 0, depth: 1}}", ["grids.LR.cells", "greater than or equal to 1"]),
        ("sampling={count: 3}", ["sampling", "called 'samples'"]),
        ("sources={chair: {kind: magic}}", ["sources.chair", "magic"]),
    ],
)
def test_a_mistake_is_one_line(project, config, words):
    result = project.snakemake("-n", "results/tables/chair.csv", "--config", config)
    assert result.returncode != 0
    lines = [line for line in result.stderr.splitlines() if line.strip()]
    assert len(lines) == 1
    assert lines[0].startswith("error: config: ")
    for word in words:
        assert word in lines[0]
