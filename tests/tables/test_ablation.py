"""The ablation's table: its order, its columns, and the two figures that the paper published."""

import pytest

from tetgan.errors import UserError
from tetgan.evaluation.metrics import names_of
from tetgan.evaluation.options import EvaluationOptions
from tetgan.tables.ablation import COLUMNS, tabulate_ablation

MODELS = ["tetgan-LR", "tet-gcn", "no-local", "no-global", "real"]
WITHOUT = {"no-local": ["local"], "no-global": ["global"]}
CHANGES = {"tetgan-LR": "", "tet-gcn": "convolution shared (full: tet)"}


@pytest.fixture
def make(report, write, read, paper, tmp_path):
    """Writes the table of some models on chairs and reads it."""

    def get(models, changes=CHANGES, **metrics):
        reports = [
            report("chair", model, method="real" if model == "real" else "tetgan", **metrics)
            | {"grid": "LR", "without": WITHOUT.get(model, [])}
            for model in models
        ]
        tabulate_ablation(write(reports), paper, "chair", tmp_path / "ablation.csv", changes)
        return read(tmp_path / "ablation.csv")

    return get


@pytest.fixture
def report(report):
    """Reports with the conventions that the notes tell."""

    def get(category, model, **others):
        return report(category, model, **others) | {"options": EvaluationOptions().model_dump(mode="json")}

    return get


def test_rows_keep_the_order_they_are_given_in(make):
    table, _ = make(["tet-gcn", "tetgan-LR", "no-local", "real"])
    assert list(table["model"]) == ["tet-gcn", "tetgan-LR", "no-local", "real"]


def test_changes_stand_beside_the_models(make):
    table, text = make(MODELS)
    assert list(table.columns[:2]) == ["model", "changes"]
    assert dict(zip(table["model"], table["changes"], strict=True))["tet-gcn"] == CHANGES["tet-gcn"]
    assert CHANGES["tet-gcn"] in text


def test_the_two_published_figures_stand_beside_their_rows_alone(make):
    table, text = make(MODELS, fid=(3.0, 2.0, 4.0))
    printed = dict(zip(table["model"], table["fid_paper"], strict=True))
    assert printed == {
        "tetgan-LR": "2.09",
        "tet-gcn": "",
        "no-local": "12.27",
        "no-global": "23.35",
        "real": "",
    }
    assert "(paper 12.27)" in text and "(paper 23.35)" in text


def test_solids_have_columns_of_their_own(make):
    table, text = make(MODELS, volume=(0.1, 0.05, 0.2), floating=(0.25,))
    assert set(names_of("solids")) <= set(COLUMNS)
    assert len(set(COLUMNS)) == len(COLUMNS)
    assert list(table[["volume", "volume_low", "volume_high"]].iloc[0]) == ["0.1", "0.05", "0.2"]
    assert (table["thickness"] == "").all()  # not measured is empty
    assert "| 0.25" in text and "Floating tets" in text


def test_there_must_be_something_to_compare(make, report, write, paper, tmp_path):
    with pytest.raises(UserError, match="no models to compare; name them in the config under 'ablation'"):
        make(["real"])
    with pytest.raises(UserError, match="metrics of 'chair', not of 'car'"):
        tabulate_ablation(write([report("chair", "tetgan-LR")]), paper, "car", tmp_path / "x.csv", {})
