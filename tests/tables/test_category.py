"""The table: order, the paper's figures, seeds, and what is missing."""

import json
from hashlib import sha256
from pathlib import Path

import pandas as pd
import pytest

from tetgan.errors import UserError
from tetgan.tables.category import COLUMNS, tabulate_category
from tetgan.tables.paper import published, quoted_figure, read_paper
from tetgan.tables.rows import IDENTITY

PAPER = Path(__file__).parents[2] / "workflow" / "resources" / "paper_tables.csv"


def estimate(value, low=None, high=None, std=None):
    return {"value": value, "low": low, "high": high, "n": 4, "std": std}


def report(model: str, seed: int = 0, tets: int = 9216, digest: str = "abc", method=None, **metrics) -> dict:
    section = {
        "metrics": {name: estimate(*value) for name, value in metrics.items()},
        "generated": {"expected": 5, "found": 4},
        "reconstructed": {"expected": 2, "found": 2},
        "notes": ["FID at N = 4, below 768, is mostly bias"],
    }
    options = {
        "points": 10000,
        "fscore_threshold": 0.01,
        "samples": 4,
        "variety": {"definition": "text", "pairs": 250, "closest": 25, "repeats": 5},
        "volume_points": 20000,
        "sets": {"shapes": 4, "points": 512},
        "bootstrap": {"level": 0.95},
    }
    extractor = {"digest": digest, "accuracy": 0.971, "categories": ["chair", "car"]}
    method = method or model.partition("-")[0]
    shared = {
        "category": "chair",
        "model": model,
        "method": method,
        "options": options,
        "extractor": extractor,
    }
    if method == "real":
        return shared | {"smoothings": {"none": section}}
    own = {
        "grid": model[-2:],
        "tets": tets,
        "mode": "paper",
        "seed": seed,
        "train_minutes": 3.0,
        "reduced": "width",
    }
    return shared | own | {"smoothings": {"none": section, "wls": section}}


def make_table(tmp_path: Path, reports: list[dict], category: str = "chair") -> tuple[pd.DataFrame, str]:
    paths = []
    for i, each in enumerate(reports):
        paths.append(tmp_path / f"{i}.json")
        paths[-1].write_text(json.dumps(each))
    tabulate_category(paths, PAPER, category, tmp_path / "table.csv")
    return pd.read_csv(tmp_path / "table.csv", dtype=str, keep_default_na=False), (
        tmp_path / "table.md"
    ).read_text()


def test_rows_stand_in_the_order_of_the_paper_then_the_bounds(tmp_path):
    models = ["real", "pca-128", "pca-16", "representation-HR", "representation-LR", "tetgan-HR", "tetgan-LR"]
    tets = {"tetgan-HR": 27648, "representation-HR": 27648}
    table, _ = make_table(tmp_path, [report(model, tets=tets.get(model, 9216)) for model in models])
    assert list(table["model"] + " " + table["smoothing"]) == [
        *("tetgan-LR none", "tetgan-LR wls", "tetgan-HR none", "tetgan-HR wls"),
        *(
            "representation-LR none",
            "representation-LR wls",
            "representation-HR none",
            "representation-HR wls",
        ),
        *("pca-16 none", "pca-16 wls", "pca-128 none", "pca-128 wls", "real "),
    ]


def test_modes_are_rows_of_their_own_and_surfaces_have_none(tmp_path):
    modes = [report("tetgan-LR") | {"mode": mode} for mode in ("solid", "paper")]
    table, text = make_table(tmp_path, [*modes, report("occnet", tets=None)])
    assert list(table["model"] + " " + table["mode"] + " " + table["smoothing"]) == [
        *("tetgan-LR paper none", "tetgan-LR paper wls", "tetgan-LR solid none", "tetgan-LR solid wls"),
        *("occnet  none", "occnet  wls"),
    ]
    for name in ("tetgan-LR, no wLS", "tetgan-LR, solid, no wLS", "tetgan-LR, solid, wLS"):
        assert f"| {name} " in text


def test_columns_are_identity_then_six_a_metric(tmp_path):
    table, _ = make_table(tmp_path, [report("tetgan-LR")])
    assert tuple(table.columns[: len(IDENTITY)]) == IDENTITY
    assert list(table.columns[len(IDENTITY) :][:6]) == [
        "chamfer",
        "chamfer_std",
        "chamfer_low",
        "chamfer_high",
        "chamfer_n",
        "chamfer_paper",
    ]
    assert len(table.columns) == len(IDENTITY) + 6 * len(COLUMNS)


def test_the_papers_figures_stand_beside_its_rows_alone_as_printed(tmp_path):
    table, text = make_table(
        tmp_path, [report(m) for m in ("tetgan-LR", "tetgan-HR", "representation-LR", "real")]
    )
    printed = table.set_index(["model", "smoothing"])["variety_paper"]
    assert printed["tetgan-LR", "none"] == "0.0033"
    assert printed["tetgan-HR", "wls"] == "0.0040"
    assert printed["representation-LR", "none"] == printed["real", ""] == ""
    assert "(paper 0.0040)" in text


def test_one_seed_keeps_its_own_deviation_and_interval(tmp_path):
    table, _ = make_table(tmp_path, [report("tetgan-LR", variety=(0.5, 0.4, 0.6, 0.1))])
    row = table.iloc[0]
    assert [row[f"variety{part}"] for part in ("", "_std", "_low", "_high")] == ["0.5", "0.1", "0.4", "0.6"]
    assert (row["variety_n"], row["seeds"], row["n"], row["tets"]) == ("4", "1", "4", "9216")


def test_every_metric_has_its_place_in_the_readable_table(tmp_path):
    metrics = {name: (round(0.1 + 0.01 * i, 3),) for i, name in enumerate(COLUMNS)}
    _, text = make_table(tmp_path, [report("tetgan-LR", **metrics)])
    for name, (value,) in metrics.items():
        assert f"| {value}" in text, name
    assert "MMD, COV, 1-NNA: 4 shapes on each side, Chamfer distance of 512 points a shape" in text


def test_several_seeds_give_their_mean_and_deviation(tmp_path):
    seeds = [
        report("tetgan-LR", seed, chamfer=(value, value - 1, value + 1, 9))
        for seed, value in enumerate((2, 4))
    ]
    row = make_table(tmp_path, seeds)[0].iloc[0]
    assert row["seeds"] == "2"
    assert [float(row[f"chamfer{part}"]) for part in ("", "_std", "_low", "_high")] == pytest.approx(
        [3, 2**0.5, 2, 4]
    )


def test_missing_is_empty_never_zero(tmp_path):
    table, text = make_table(tmp_path, [report("tetgan-LR", fid=(None,))])
    assert table.iloc[0]["fid"] == table.iloc[0]["kid"] == ""
    assert "— (paper 2.09)" in text


def test_notes_name_the_extractor_the_floor_and_remarks(tmp_path):
    reports = [report("tetgan-LR"), report("real", fid=(0.7,), kid=(0.001,))]
    _, text = make_table(tmp_path, reports)
    assert "Extractor abc: PointNet++ on chair, car; held-out accuracy 97.1 %" in text
    assert "Floor (row `real`): FID 0.7, KID 0.001." in text
    assert "FID at N = 4, below 768, is mostly bias. (all rows)" in text


def test_different_extractors_cannot_be_compared(tmp_path):
    table, text = make_table(tmp_path, [report("tetgan-LR"), report("tetgan-HR", digest="xyz")])
    assert set(table["extractor"]) == {"abc", "xyz"}
    assert "cannot be compared" in text


def test_metrics_of_another_category_are_refused(tmp_path):
    with pytest.raises(UserError, match="metrics of 'chair', not of 'car'"):
        make_table(tmp_path, [report("tetgan-LR")], category="car")
    with pytest.raises(UserError, match="no metrics"):
        make_table(tmp_path, [])


def test_published_figures_are_complete():
    # Every figure was read against the paper; whoever changes one does so knowingly.
    assert sha256(PAPER.read_bytes()).hexdigest().startswith("6d9f82e75af85a24")
    figures = read_paper(PAPER)
    # Table 1: 10 models, 4 metrics. Supplement: 4 categories; FID and variety of 4 models, Chamfer of 3.
    tables = figures[figures["table"].isin(["Table 1", "Supplement FID", "Supplement variety"])]
    assert len(tables) == 10 * 4 + (4 + 4) * 4
    assert (figures["table"] == "Supplement reconstruction").sum() == 3 * 4
    assert not figures.duplicated(["category", "model", "metric"]).any()


def test_the_running_text_is_quoted_where_it_says_something():
    figures = read_paper(PAPER)
    assert quoted_figure(figures, "table", "data set", "shapes") == "8436"
    assert quoted_figure(figures, "chair", "generated", "manifold_edges") == "98.5%"
    assert quoted_figure(figures, "chair", "generated", "fid") is None


def of(method: str, grid: str = "", simplified: bool = False, without=()) -> dict:
    return {"method": method, "grid": grid, "simplified": simplified, "without": list(without)}


def test_supplement_belongs_to_the_grid_it_names():
    figures = read_paper(PAPER)
    vase = {"fid": "2.57", "variety": "0.0023", "chamfer": "0.0055"}
    assert published(figures, "vase", of("tetgan", "HR"), "none") == vase
    assert published(figures, "vase", of("tetgan", "LR"), "none") == {}
    assert published(figures, "sofa", of("tetgan", "LR"), "wls")["chamfer"] == "0.0024"
    assert published(figures, "car", of("tetgan", "LR"), "none") == {}


def test_baselines_stand_beside_their_own_figures():
    figures = read_paper(PAPER)
    assert published(figures, "chair", of("occnet"), "none")["faces"] == "86901"
    assert published(figures, "chair", of("occnet", simplified=True), "none")["chamfer"] == "0.019"
    assert "chamfer" not in published(figures, "chair", of("shapegan-gan"), "none")
    assert published(figures, "chair", of("shapegan-gan", simplified=True), "none")["fid"] == "3.87"
    assert published(figures, "vase", of("shapegan-vae"), "none")["fid"] == "20.51"
    assert published(figures, "vase", of("shapegan-vae", simplified=True), "none") == {}
    assert published(figures, "chair", of("pca", "LR"), "none") == {}


def test_a_tetgan_without_critics_has_the_figures_of_the_papers_ablation():
    figures = read_paper(PAPER)
    assert published(figures, "chair", of("tetgan", "LR", without=["local"]), "none") == {"fid": "12.27"}
    assert published(figures, "chair", of("tetgan", "HR", without=["global"]), "wls") == {"fid": "23.35"}
    assert published(figures, "chair", of("tetgan", "LR", without=["local", "global"]), "none") == {}


def test_the_method_places_a_row_and_gives_it_the_papers_figures_whatever_the_name(tmp_path):
    mine = report("my-net", method="tetgan") | {"grid": "LR"}
    pca, bound = report("tetgan-best", method="pca"), report("best", method="representation")
    table, text = make_table(tmp_path, [report("real"), pca, bound, report("occnet"), mine])
    rows = table[table["smoothing"] != "wls"].set_index("model")
    assert list(rows.index) == ["my-net", "occnet", "best", "tetgan-best", "real"]
    assert rows["variety_paper"].to_dict() == {
        "my-net": "0.0033",
        "occnet": "0.0041",
        "best": "",
        "tetgan-best": "",
        "real": "",
    }
    assert "| my-net, no wLS " in text


def test_a_model_that_is_never_smoothed_has_no_smoothing(tmp_path):
    occnet = report("occnet", variety=(0.5,)) | {"grid": "", "tets": None, "simplified": True}
    del occnet["smoothings"]["wls"]
    table, _ = make_table(tmp_path, [report("tetgan-LR"), occnet])
    rows = table.set_index("model")
    assert list(rows.loc["tetgan-LR", "smoothing"]) == ["none", "wls"]
    row = rows.loc["occnet"]
    assert (row["smoothing"], row["grid"], row["tets"], row["simplified"]) == ("", "", "", "True")
    assert row["variety_paper"] == "0.0039"


def test_other_columns_are_not_the_papers_figures(tmp_path):
    for content in ("model,value\na,1\n", ""):
        (tmp_path / "bad.csv").write_text(content)
        with pytest.raises(
            UserError, match=r"bad\.csv: no table of the paper's figures; its columns are table,"
        ):
            read_paper(tmp_path / "bad.csv")
