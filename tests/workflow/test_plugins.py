"""The model of docs/extending.md in the workflow: found, planned, made, and made again when it is edited."""

import json

import pytest
import yaml
from smoke_project import planned
from worked_example import CONFIG, MODULE, write_module

METRICS = "results/{run}/metrics/chair/linear/0/paper.json"


@pytest.fixture
def with_module(monkeypatch):
    """Puts the module and its config into a project."""

    def put(project, **changes):
        write_module(project.folder)
        (project.folder / "my.yaml").write_text(yaml.safe_dump(CONFIG | changes))
        monkeypatch.setenv("PYTHONPATH", str(project.folder), prepend=":")
        return project

    return put


def test_a_dry_run_plans_it_like_any_other(untouched, with_module):
    project = with_module(untouched)
    jobs = planned(project.snakemake("-n", METRICS.format(run="mine"), "--configfile", "my.yaml"))
    assert jobs["train_model"] == jobs["sample_model"] == jobs["evaluate_model"] == 1
    table = planned(project.snakemake("-n", "results/mine/tables/chair.csv", "--configfile", "my.yaml"))
    without = planned(project.snakemake("-n", "results/tables/chair.csv"))
    assert table["train_model"] == without["train_model"] + 1


def test_a_module_that_is_not_there_is_one_line(untouched, with_module):
    project = with_module(untouched, plugins=["my_models.curved"])
    result = project.snakemake("-n", "--configfile", "my.yaml")
    assert result.returncode != 0
    assert result.stderr.strip() == (
        "error: plugins: my_models.curved: No module named 'my_models.curved'; install it, or set PYTHONPATH"
    )


def test_it_is_made_and_an_edit_makes_it_again_but_nothing_else(smoked, with_module):
    project, _, _ = smoked
    with_module(project, run="smoke")
    configs = ("--configfile", "config/smoke.yaml", "my.yaml")
    target = METRICS.format(run="smoke")
    made = project.snakemake(target, *configs)
    assert made.returncode == 0, made.stdout + made.stderr
    measured = json.loads((project.folder / target).read_text())
    assert (measured["model"], measured["grid"], measured["simplified"]) == ("linear", "LR", False)
    folder = project.folder / "results/smoke/samples/chair/linear/0/paper"
    assert {"none", "wls", "about.json"} <= {path.name for path in folder.iterdir()}
    others = ("results/smoke/figures/chair/samples.png", "results/smoke/samples/chair/pca-16/0/paper")
    assert planned(project.snakemake("-n", target, *others, *configs)) == {}
    write_module(project.folder, MODULE.replace("mse_loss", "l1_loss"))
    again = {"train_model": 1, "sample_model": 1, "evaluate_model": 1}
    assert planned(project.snakemake("-n", target, *others, *configs)) == again
