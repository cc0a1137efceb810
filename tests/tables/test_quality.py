"""The quality table of made-up certificates, and of real ones."""

import json

import numpy as np
import pandas as pd
import pytest

from tetgan.errors import UserError
from tetgan.geometry.adjacency import boundary_faces
from tetgan.solids.record import quality_record
from tetgan.solids.solid import SolidMesh
from tetgan.tables.quality import IDENTITY, tabulate_quality

CORNER = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
TET = np.array([[0, 1, 2, 3]])
RECORD = quality_record(SolidMesh(CORNER, TET, boundary_faces(TET)))
EMPTY = quality_record(SolidMesh(np.empty((0, 3)), TET[:0], TET[:0, :3]))


@pytest.fixture
def sampled(tmp_path):
    """Makes a folder of samples without meshes; a row is what differs from the certificate of one tet."""

    def make(category, model, seed, mode, *, none, wls=None, method="tetgan"):
        folder = tmp_path / "samples" / category / model / str(seed) / mode
        for smoothing, kinds in (("none", none), ("wls", wls)):
            if kinds is None:
                continue
            rows = [
                {"set": kind, "id": f"{number:04d}", **(EMPTY if row is None else RECORD | row)}
                for kind, rows in kinds.items()
                for number, row in enumerate(rows)
            ]
            (folder / smoothing).mkdir(parents=True)
            pd.DataFrame(rows).to_csv(folder / smoothing / "certificate.csv", index=False)
        (folder / "about.json").write_text(json.dumps({"tets": 192, "method": method}))
        return folder

    return make


@pytest.fixture
def quality(tmp_path, paper, read):
    def make(*folders, catalogues=()):
        tabulate_quality(folders, catalogues, paper, tmp_path / "quality.csv")
        return read(tmp_path / "quality.csv")

    return make


def test_modes_stand_side_by_side(sampled, quality):
    bad = {"tets": 3, "inverted_tets": 1, "valid": False, "self_intersections": 4, "min_dihedral": 0.5}
    faithful = [{"volume": 1.0}, bad | {"volume": 2.0}, {"volume": 4.0}]
    solid = [
        {"volume": 0.9, "faces": 8, "held": 2, "dropped_components": 2},
        {"volume": 2.2, "faces": 8},
        {"volume": 4.0, "faces": 4},
    ]
    table, text = quality(
        sampled("chair", "tetgan-LR", 0, "paper", none={"generated": faithful}),
        sampled("chair", "tetgan-LR", 0, "solid", none={"generated": solid}),
    )
    paper, ours = (row for _, row in table.iterrows())
    assert table[list(IDENTITY)].to_numpy().tolist() == [
        ["chair", "tetgan-LR", "192", mode, "none", "generated", "1", "3", "0"] for mode in ("paper", "solid")
    ]
    assert float(paper["valid"]) == pytest.approx(2 / 3)
    assert (paper["inverted_tets"], float(paper["inverted_share"])) == ("1", 1 / 5)
    assert (float(paper["min_dihedral"]), paper["self_intersections"]) == (0.5, "4")
    assert ours["radius_ratios"] == paper["radius_ratios"] == RECORD["radius_ratios"].replace("1", "3")
    assert float(ours["min_radius_ratio"]) == pytest.approx(RECORD["min_radius_ratio"])
    assert [paper[name] for name in ("held_share", "dropped_components", "volume_to_paper")] == [""] * 3
    assert (float(ours["valid"]), ours["inverted_tets"], ours["dropped_components"]) == (1.0, "0", "2")
    assert float(ours["held_share"]) == pytest.approx(0.2)  # 2 of half of 20 faces
    assert float(ours["volume_to_paper"]) == pytest.approx(1.0)  # the median of 0.9, 1.1 and 1
    assert ours["volume_ratio"] == ""  # nobody knows the shape of a sample
    assert set(table["manifold_edges_paper"]) == {"98.5%"}
    assert "| tetgan-LR, solid, no wLS" in text
    assert "1 (20 %)" in text and "100 % [100, 100] (paper 98.5%)" in text


def test_intervals_hold_what_they_are_of_and_narrow_with_more_meshes(sampled, quality):
    rng = np.random.default_rng(0)
    rows = [
        {"valid": bool(good), "volume": 1 + spread}
        for good, spread in zip(rng.random(400) < 0.5, rng.random(400), strict=True)
    ]
    faithful = [{"volume": 1.0}] * 400
    table, text = quality(
        sampled("chair", "few", 0, "paper", none={"generated": faithful[:16]}),
        sampled("chair", "few", 0, "solid", none={"generated": rows[:16]}),
        sampled("chair", "many", 0, "paper", none={"generated": faithful}),
        sampled("chair", "many", 0, "solid", none={"generated": rows}),
    )
    few, many = (row for _, row in table[table["mode"] == "solid"].iterrows())
    for name in ("valid", "volume_to_paper"):
        low, value, high = (float(many[name + part]) for part in ("_low", "", "_high"))
        assert low <= value <= high
        assert high - low < (float(few[f"{name}_high"]) - float(few[f"{name}_low"])) / 2
    share = float(many["valid"])
    half = 1.96 * np.sqrt(share * (1 - share) / 400)  # the normal interval of a share
    assert float(many["valid_high"]) - share == pytest.approx(half, rel=0.2)
    assert f"| {100 * share:.3g} % [" in text
    faithful_row = table[table["mode"] == "paper"].iloc[0]
    assert faithful_row["volume_to_paper_low"] == faithful_row["volume_ratio_high"] == ""


def test_solids_of_known_shapes_are_measured_by_their_volumes(sampled, quality, tmp_path):
    catalogue = tmp_path / "data" / "chair" / "catalogue.csv"
    catalogue.parent.mkdir(parents=True)
    catalogue.write_text("id,split,cube_volume\n0000,train,2.0\n0001,train,1.0\n0002,holdout,\n")
    solids = [{"volume": 1.9}, {"volume": 1.05}, {"volume": 9.0}]
    truth = sampled("chair", "fields", 0, "solid", none={"generated": solids}, method="representation")
    (row,) = quality(truth, catalogues=[catalogue])[0].to_dict("records")
    assert float(row["volume_ratio"]) == pytest.approx(1.0)  # the median of 0.95 and 1.05
    catalogue.write_text("id,split\n0000,train\n")
    with pytest.raises(UserError, match="no column 'cube_volume'; repair the shapes again"):
        quality(truth, catalogues=[catalogue])


def test_shapes_smoothings_and_seeds(sampled, quality):
    kinds = {"generated": [{}, {}], "reconstructed": [{}]}
    folders = [
        sampled("chair", "my-net", seed, "paper", none=kinds, wls={"generated": [{"cavities": 1}, {}]})
        for seed in (0, 1)
    ]
    truth = sampled("chair", "my-fields", 0, "paper", none=kinds, method="representation")
    named = sampled("chair", "tetgan-like", 0, "paper", none={"generated": [{}]}, method="other")
    other = sampled("vase", "my-net", 0, "paper", none=kinds)
    table, _ = quality(*folders, truth, named, other)
    columns = ["category", "model", "smoothing", "shapes", "seeds", "n", "cavities", "manifold_edges_paper"]
    assert table[columns].to_numpy().tolist() == [
        ["chair", "my-net", "none", "generated", "2", "4", "0", "98.5%"],
        ["chair", "my-net", "none", "reconstructed", "2", "2", "0", ""],
        ["chair", "my-net", "wls", "generated", "2", "4", "2", "98.5%"],
        ["chair", "my-fields", "none", "training", "1", "2", "0", "98.9%"],
        ["chair", "my-fields", "none", "validation", "1", "1", "0", ""],
        ["chair", "tetgan-like", "none", "generated", "1", "1", "0", ""],
        ["vase", "my-net", "none", "generated", "1", "2", "0", ""],
        ["vase", "my-net", "none", "reconstructed", "1", "1", "0", ""],
    ]


def test_meshes_are_compared_by_id_and_seed(sampled, quality):
    twice = {"generated": [{"volume": 1.0}, {"volume": 2.0}]}
    folders = [
        sampled("chair", "tetgan-LR", 0, "paper", none={"generated": [{"volume": 0.5}, None]}),
        sampled("chair", "tetgan-LR", 1, "paper", none={"generated": [None, {"volume": 0.4}]}),
        sampled("chair", "tetgan-LR", 0, "solid", none=twice),
        sampled("chair", "tetgan-LR", 1, "solid", none=twice),
    ]
    table, _ = quality(*folders)
    assert float(table["volume_to_paper"].iloc[1]) == pytest.approx((1 / 0.5 + 2 / 0.4) / 2)
    assert (table["n"].iloc[0], table["empty"].iloc[0]) == ("2", "2")


def test_nothing_but_empty_meshes_have_no_figures(sampled, quality):
    table, text = quality(sampled("chair", "tetgan-LR", 0, "solid", none={"generated": [None]}))
    row = table.iloc[0]
    assert (row["n"], row["empty"], row["valid"], row["inverted_tets"], row["volume_ratio"]) == (
        *("0", "1"),
        *[""] * 3,
    )
    assert "— (paper 98.5%)" in text


def test_what_is_no_folder_of_samples_is_named(sampled, quality):
    folder = sampled("chair", "tetgan-LR", 0, "paper", none={"generated": [{}]})
    with pytest.raises(UserError, match="no folder"):
        quality(folder / "none")
    with pytest.raises(UserError, match="no samples to make a table of"):
        quality()
    certificate = folder / "none" / "certificate.csv"
    pd.read_csv(certificate, dtype=str).drop(columns="p1_dihedral").to_csv(certificate, index=False)
    with pytest.raises(UserError, match=r"certificate\.csv: no certificate of solids; sample"):
        quality(folder)
    certificate.unlink()
    with pytest.raises(UserError, match="no samples; expected"):
        quality(folder)
