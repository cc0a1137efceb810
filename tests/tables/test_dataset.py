"""The data set table: counts of made-up catalogues, and the paper's sizes."""

import pandas as pd
import pytest

from tetgan.errors import UserError
from tetgan.tables.dataset import count_shapes, tabulate_dataset

ROWS = [
    # status, split, reason
    ("ok", "train", ""),
    ("ok", "train", ""),
    ("ok", "validation", ""),
    ("filled", "train", "hollow inside"),
    ("rejected", "train", "no faces"),
    ("rejected", "validation", "repair hangs"),
    ("rejected", "train", "repair hangs"),
    ("surface", "holdout", ""),
]
COUNTS = ["listed", "ok", "filled", "rejected", "train", "validation", "holdout"]


def write_catalogue(path):
    path.parent.mkdir(parents=True)
    table = pd.DataFrame(ROWS, columns=["status", "split", "reason"])
    table["id"] = [f"{number:04d}" for number in range(len(table))]
    numbers = dict.fromkeys(["faces_in", "faces_out", "volume", "distance", "filled_share", "seconds"])
    table.assign(path="", sha256="", **numbers).to_csv(path, index=False)
    return path


@pytest.fixture
def dataset(tmp_path, paper, read):
    def make(*categories):
        catalogues = [write_catalogue(tmp_path / category / "catalogue.csv") for category in categories]
        tabulate_dataset(catalogues, paper, tmp_path / "dataset.csv")
        return read(tmp_path / "dataset.csv")

    return make


def test_every_shape_is_counted_once_and_every_reason(dataset):
    table, text = dataset("chair")
    row = table.set_index("category").loc["chair"]
    assert [row[name] for name in COUNTS] == ["7", "3", "1", "3", "3", "1", "1"]
    assert row["reasons"] == "2 repair hangs; 1 no faces"
    assert "7 (paper 6778)" in text


def test_the_papers_categories_are_rows_even_where_nothing_was_run(dataset):
    table, text = dataset("lamp", "vase")
    assert list(table["category"]) == ["chair", "sofa", "bench", "table", "car", "vase", "lamp"]
    assert list(table["listed_paper"]) == ["6778", "3173", "1813", "8436", "3514", "300", ""]
    assert set(table.loc[table["category"] == "sofa", [*COUNTS, "reasons"]].to_numpy().ravel()) == {""}
    assert "— (paper 3173)" in text


def test_nothing_of_a_kind_is_zero_where_the_catalogue_is_known():
    table = pd.DataFrame([("ok", "train", "")], columns=["status", "split", "reason"])
    counts = count_shapes(table)
    assert counts == {
        "listed": 1,
        "ok": 1,
        "filled": 0,
        "rejected": 0,
        "train": 1,
        "validation": 0,
        "holdout": 0,
        "reasons": "",
    }


def test_two_catalogues_of_a_category_are_refused(tmp_path, paper):
    paths = [write_catalogue(tmp_path / name / "chair" / "catalogue.csv") for name in "ab"]
    with pytest.raises(UserError, match="second catalogue of 'chair'"):
        tabulate_dataset(paths, paper, tmp_path / "dataset.csv")
