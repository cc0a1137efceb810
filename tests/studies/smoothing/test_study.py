"""The smoothing study of ground-truth boxes, from stores and meshes to the table and its verdicts."""

import json
import runpy
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
import torch
import trimesh

from tetgan.errors import UserError
from tetgan.evaluation.options import EvaluationOptions
from tetgan.extractor.network import PointNet2, save_classifier
from tetgan.fields.extraction import extract_field
from tetgan.fields.store import index_fields, write_shard
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.grids.options import GridOptions
from tetgan.meshing.options import MeshingOptions
from tetgan.methods.representation.options import RepresentationOptions
from tetgan.models.files import build_generator, save_generator
from tetgan.shapes.archive import read_meshes, write_meshes
from tetgan.studies.options import SmoothingOptions
from tetgan.studies.smoothing.files import Study, read_study
from tetgan.studies.smoothing.report import CLAIMS, weigh_claim, weigh_features
from tetgan.studies.smoothing.smoothers import VARIANTS, Variant
from tetgan.studies.smoothing.study import measure_smoothing
from tetgan.studies.smoothing.table import FIGURES, IDENTITY, study_table, tabulate_smoothing

EVALUATION = EvaluationOptions.parse({"points": 1000, "samples": 4, "kernel": {"block": 2}})
OTHER_SEED = EvaluationOptions.parse({**EVALUATION.model_dump(), "seed": 1})
MODEL = {"category": "box", "model": "representation-LR", "grid": "LR", "seed": "0"}
IDS = [f"box-{number}" for number in range(8)]


def rounded_box(number):
    """A box of its own size with finely triangulated faces."""
    size = 0.35 + 0.35 * np.random.default_rng(number).random(3)
    mesh = trimesh.creation.box(size).subdivide().subdivide()
    return np.array(mesh.vertices) + 0.5, np.array(mesh.faces, dtype=np.int64)


@pytest.fixture(scope="module")
def inputs(tmp_path_factory):
    """Everything that the study reads: six training and two validation boxes on 1,536 tets."""
    folder = tmp_path_factory.mktemp("inputs")
    hierarchy = build_hierarchy(1, 2)
    boxes = {name: rounded_box(number) for number, name in enumerate(IDS)}
    write_meshes(folder / "boxes.zip", [(name, *box) for name, box in boxes.items()], [])
    fields = (extract_field(*box, hierarchy.finest) for box in boxes.values())
    write_shard(folder / "boxes.zarr.zip", IDS, fields, hierarchy.digest)
    splits = ["train"] * 6 + ["validation"] * 2
    pd.DataFrame({"id": IDS, "split": splits}).to_csv(folder / "catalogue.csv", index=False)
    grid = GridOptions.parse({"cells": 1, "depth": 2})
    index_fields([folder / "boxes.zarr.zip"], folder / "catalogue.csv", grid, folder / "index.json")
    options = RepresentationOptions.parse({"kind": "representation", "grid": "LR"})
    save_generator(folder / "model", build_generator(options, hierarchy), options, hierarchy)
    torch.manual_seed(0)
    (folder / "extractor").mkdir()
    about = {"categories": ["box", "ball"], "holdout_accuracy": 0.5}
    save_classifier(folder / "extractor", PointNet2(2), about)
    rng = np.random.default_rng(0)
    clouds = {f"{name}_ids": np.array(list("abcde")) for name in ("train", "holdout")}
    clouds |= {name: rng.random((5, 1024, 3)).astype(np.float32) for name in ("train", "holdout")}
    np.savez(folder / "clouds.npz", **clouds)
    return folder


def run(inputs, out, **changes):
    arguments = {
        "meshes": [inputs / "boxes.zip"],
        "clouds": inputs / "clouds.npz",
        "extractor": inputs / "extractor",
        "study": SmoothingOptions.parse({"crease_points": 200}),
        "meshing": MeshingOptions.parse({}),
        "evaluation": EVALUATION,
        "identity": MODEL,
    }
    measure_smoothing(inputs / "model", inputs / "index.json", out, **(arguments | changes))
    return out


@pytest.fixture(scope="module")
def folder(inputs, tmp_path_factory):
    return run(inputs, tmp_path_factory.mktemp("study") / "out")


def test_a_row_a_shape_and_variant_and_one_of_the_shape_itself(folder):
    study = read_study(folder)
    assert len(study.rows) == 2 * (1 + len(VARIANTS))
    for variant in VARIANTS:
        assert list(study.of(variant).index) == ["box-6", "box-7"]
    assert (study.of_repaired()["bend_w1"] == 0).all()
    assert study.of_repaired()["bend_p95"].tolist() == pytest.approx([90, 90])
    figures = [
        "chamfer",
        "bend_p95",
        "volume_ratio",
        "volume_to_repaired",
        "crease_distance",
        "inverted_tets",
    ]
    measured = study.rows[study.rows["smoothing"] != "repaired"]
    assert measured[figures].notna().all(axis=None)
    assert (study.rows["chamfer"] > 0).all()


def test_smoothing_takes_volume_and_no_smoothing_none(folder):
    study = read_study(folder)
    for variant in VARIANTS:
        ratio = study.of(variant)["volume_ratio"]
        assert (ratio == 1).all() if variant.smoothing == "none" else (ratio < 1).all()
    assert (study.of(Variant(False, "none"))["inverted_tets"] == 0).all()


def test_every_variant_has_fid_and_kid_at_the_same_n(folder):
    report = read_study(folder).report
    assert report["samples"] == 4
    assert set(report["features"]) == {variant.name for variant in VARIANTS}
    for metrics in report["features"].values():
        assert metrics["fid"]["value"] > 0
        assert metrics["kid"]["n"] == 4
    assert any("mostly bias" in note for note in report["notes"])


def test_the_example_shows_one_shape_in_all_variants(folder):
    shapes = {name: vertices for name, vertices, _ in read_meshes(folder / "example.zip")}
    assert list(shapes) == ["repaired", *(variant.name for variant in VARIANTS)]
    np.testing.assert_allclose(shapes["repaired"], rounded_box(6)[0])


def test_the_same_seed_gives_the_same_bytes(inputs, folder, tmp_path):
    again = run(inputs, tmp_path / "again")
    for path in folder.iterdir():
        assert path.read_bytes() == (again / path.name).read_bytes()


def test_too_few_held_out_clouds_leave_fid_empty(inputs, tmp_path):
    with np.load(inputs / "clouds.npz") as arrays:
        few = {name: arrays[name][:1] if name.startswith("holdout") else arrays[name] for name in arrays}
    np.savez(tmp_path / "few.npz", **few)
    study = read_study(run(inputs, tmp_path / "out", clouds=tmp_path / "few.npz"))
    assert study.report["features"]["blocky-none"]["fid"]["value"] is None
    assert weigh_features("fid", study).holds == "undecided"
    tabulate_smoothing([tmp_path / "out"], tmp_path / "table.csv")
    assert pd.read_csv(tmp_path / "table.csv")["fid"].isna().all()


def test_no_validation_shape_is_an_error(inputs, tmp_path):
    write_meshes(tmp_path / "other.zip", [("other", *rounded_box(0))], [])
    with pytest.raises(UserError, match="no validation shape"):
        run(inputs, tmp_path / "out", meshes=[tmp_path / "other.zip"])
    assert not (tmp_path / "out").exists()


def test_the_table_has_a_row_a_variant_and_the_floor(folder, tmp_path):
    tabulate_smoothing([folder], tmp_path / "smoothing.csv")
    table = pd.read_csv(tmp_path / "smoothing.csv")
    assert len(table) == len(VARIANTS) + 1
    assert tuple(table.columns[: len(IDENTITY)]) == IDENTITY
    assert len(table.columns) == len(IDENTITY) + 4 * len(FIGURES)
    displaced = table[(table["displaced"] == True) & (table["smoothing"] == "wls")].iloc[0]  # noqa: E712
    rows = read_study(folder).of(Variant(True, "wls"))
    assert displaced["chamfer"] == pytest.approx(rows["chamfer"].mean())
    assert displaced["chamfer_low"] <= displaced["chamfer"] <= displaced["chamfer_high"]
    assert displaced["n"] == 2
    assert displaced["beta"] == 0.5
    assert table["fid"].isna().sum() == 1  # the repaired shapes
    assert table["chamfer_std"].isna().all()  # of one seed
    text = (tmp_path / "smoothing.md").read_text()
    for claim in CLAIMS:
        assert claim.statement in text
    assert "displaced, cotangent" in text


def test_seeds_become_one_row_with_their_deviation(inputs, folder, tmp_path):
    other = run(inputs, tmp_path / "other", identity={**MODEL, "seed": "1"}, evaluation=OTHER_SEED)
    tabulate_smoothing([folder, other], tmp_path / "both.csv")
    one, two = (study_table(read_study(each)) for each in (folder, other))
    both = pd.read_csv(tmp_path / "both.csv")
    assert len(both) == len(one) and set(both["seeds"]) == {2}
    expected = np.stack([one["chamfer"], two["chamfer"]])
    np.testing.assert_allclose(both["chamfer"], expected.mean(axis=0))
    np.testing.assert_allclose(both["chamfer_std"], expected.std(axis=0, ddof=1))
    assert (both["chamfer_std"] > 0).any()
    text = (tmp_path / "both.md").read_text()
    assert " ± " in text and "| Seed " in text


def test_no_study_is_an_error(tmp_path):
    with pytest.raises(UserError, match="no study"):
        tabulate_smoothing([], tmp_path / "smoothing.csv")
    with pytest.raises(UserError, match="not a smoothing study"):
        tabulate_smoothing([tmp_path], tmp_path / "smoothing.csv")


def study_of(differences):
    """A study in which wLS differs from cotangent by so much in the 95th percentile of the bend."""
    rows = [
        {"id": str(number), "displaced": True, "smoothing": smoothing, "bend_p95": 40 + by}
        for number, difference in enumerate(differences)
        for smoothing, by in (("wls", difference), ("cotangent", 0.0))
    ]
    return Study(pd.DataFrame(rows), {"evaluation": EVALUATION.model_dump()})


@pytest.mark.parametrize(
    ("differences", "holds"),
    [([3.0, 4, 5, 4], "yes"), ([-3.0, -4, -5, -4], "no"), ([-3.0, 4, -5, 4], "undecided")],
)
def test_a_claim_holds_where_its_interval_leaves_zero_out(differences, holds):
    finding = weigh_claim(CLAIMS[0], study_of(differences))
    assert finding.holds == holds
    assert finding.difference == pytest.approx(np.mean(differences))
    lower = CLAIMS[0]._replace(sign=-1)
    swapped = {"yes": "no", "no": "yes", "undecided": "undecided"}
    assert weigh_claim(lower, study_of(differences)).holds == swapped[holds]


def test_fid_rises_only_where_intervals_part():
    def features(low, high):
        return {"fid": {"value": (low + high) / 2, "low": low, "high": high}}

    def judged(before, after):
        report = {"features": {"displaced-none": features(*before), "displaced-wls": features(*after)}}
        return weigh_features("fid", Study(pd.DataFrame(), report)).holds

    assert judged((1.0, 2.0), (3.0, 4.0)) == "yes"
    assert judged((3.0, 4.0), (1.0, 2.0)) == "no"
    assert judged((1.0, 3.0), (2.0, 4.0)) == "undecided"


def test_the_report_is_whole_json(folder):
    report = json.loads((folder / "report.json").read_text())
    assert report["meshing"]["beta"] == 0.5
    assert report["tets"] == 1536


def test_the_figure_has_its_data_beside_it(folder, tmp_path):
    job = SimpleNamespace(
        input=SimpleNamespace(studies=[str(folder)]),
        params=SimpleNamespace(names=["a-model"]),
        output=SimpleNamespace(picture=str(tmp_path / "smoothing.png")),
    )
    script = Path(__file__).parents[3] / "workflow" / "scripts" / "draw_smoothing.py"
    runpy.run_path(str(script), init_globals={"snakemake": job})
    data = pd.read_csv(tmp_path / "smoothing.csv")
    assert len(data) == 1 + len(VARIANTS) and set(data["id"]) == {"box-6"}
    bends = data.filter(regex=r"^bend_\d+_\d+$")
    assert bends.shape[1] == 18 and np.allclose(bends.sum(axis=1), 1)
    repaired = data["smoothing"] == "repaired"
    assert bends.loc[repaired, ["bend_0_10", "bend_80_90", "bend_90_100"]].sum(axis=1).item() > 0.99
    assert (tmp_path / "smoothing.png").stat().st_size > 10_000
