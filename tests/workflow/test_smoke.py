"""The smoke run from end to end, and the jobs that rerun after a change."""

import json

import numpy as np
import pandas as pd
import pytest
from PIL import Image
from smoke_project import TARGETS, planned


def test_the_smoke_run_ends_with_a_whole_table(smoked):
    project, _, _ = smoked
    table = pd.read_csv(project.folder / TARGETS[0])
    rows = table[["model", "smoothing"]].fillna("none").apply(tuple, axis=1).tolist()
    for model in ("tetgan-LR", "tetgan-HR"):
        assert (model, "none") in rows
        assert (model, "wls") in rows
    for model in ("representation-LR", "representation-HR", "pca-16", "real"):
        assert model in set(table["model"])
    for model, simplified in (("occnet", False), ("shapegan-vae", False), ("shapegan-gan-simplified", True)):
        row = table[table["model"] == model]
        assert (len(row), row["simplified"].item()) == (1, simplified)
        assert row["smoothing"].isna().item()
    measured = table[table["model"].str.startswith("representation")]
    assert measured[["chamfer", "faces", "manifold_edges", "iou"]].notna().all(axis=None)
    assert (measured["iou"] == 1).all()
    assert measured["volume_iou"].between(0.01, 1).all()
    real = table[table["model"] == "real"]
    sets = ["mmd", "cov", "nna", "jsd", "novelty", "fid_infinity", "precision", "recall", "volume_iou"]
    assert real[sets].notna().all(axis=None)
    paper = table[(table["model"] == "tetgan-HR") & (table["smoothing"] == "none")]
    assert list(paper["mode"]) == ["paper", "solid"]
    assert list(paper["fid_paper"]) == pytest.approx([1.35, 1.35])
    solid = table[(table["mode"] == "solid") & (table["model"] == "representation-LR")]
    assert solid[["inverted_tets", "valid"]].to_numpy().tolist() == [[0, 1], [0, 1]]
    assert (project.folder / TARGETS[0]).with_suffix(".md").read_text().count("|") > 50


def test_the_gathered_tables_hold_what_the_run_measured(smoked):
    project, _, _ = smoked
    names = ("fid", "variety", "reconstruction", "manifold", "quality", "dataset", "runtime")
    folder = project.folder / "results/smoke/tables"
    tables = {name: pd.read_csv(folder / f"{name}.csv") for name in names}
    assert tables["fid"]["sofa"].isna().all()  # the smoke run has chairs alone
    assert tables["fid"].set_index("model").loc["tetgan-LR", "sofa_paper"].tolist() == [3.35] * 4
    shown = tables["manifold"][tables["manifold"]["shapes"] != "reconstructed"]
    assert {"generated", "ground truth", "repaired"} == set(shown["shapes"])
    assert shown[["manifold_edges", "boundary_edges", "nonmanifold_edges"]].sum(axis=1).round(9).eq(1).all()
    solid = tables["quality"][tables["quality"]["mode"] == "solid"]
    of_fields = {"tetgan-LR", "tetgan-HR", "tetflow-LR", "representation-LR", "representation-HR"}
    assert set(solid["model"]) == of_fields
    solid = solid[solid["n"] > 0]  # a model hardly trained may leave everything empty
    faults = ["inverted_tets", "nonmanifold_edges", "nonmanifold_vertices", "self_intersections"]
    assert (solid["valid"].eq(1) & solid[faults].eq(0).all(axis=1) & solid["min_dihedral"].ge(14.999)).all()
    chair = tables["dataset"].set_index("category").loc["chair"]
    assert (chair["listed"], chair["holdout"], chair["listed_paper"]) == (36, 24, 6778)
    runtime = tables["runtime"]
    assert (runtime["jobs"].dropna() == runtime["jobs_measured"].dropna()).all()
    assert (runtime.loc[runtime["stage"] != "preprocess", "seconds"] > 0).all()


def test_a_missing_benchmark_runs_nothing_again(smoked):
    project, _, _ = smoked
    benchmark = project.folder / "results/smoke/benchmarks/train_extractor.tsv"
    content = benchmark.read_bytes()
    benchmark.unlink()
    rerun = planned(project.smoke("-n", "paper"))
    benchmark.write_bytes(content)
    assert rerun == {}


def test_the_picture_shows_something(smoked):
    project, _, _ = smoked
    picture = np.asarray(Image.open(project.folder / TARGETS[1]).convert("L"))
    assert 0.02 < (picture < 230).mean() < 0.9


def test_a_second_run_does_nothing(smoked):
    project, _, _ = smoked
    assert planned(project.smoke("-n", "paper", *TARGETS)) == {}


def test_the_smoke_run_leaves_the_default_run_alone(smoked):
    project, before, after = smoked
    assert before == after
    assert before["train_model"] > 0
    assert {path.name for path in (project.folder / "results").iterdir()} == {"smoke"}


def test_a_deleted_output_reruns_only_what_depends_on_it(smoked):
    project, _, _ = smoked
    shard = "results/smoke/fields/chair/LR/1-of-2.zarr.zip"
    content = (project.folder / shard).read_bytes()
    (project.folder / shard).unlink()
    rerun = planned(project.smoke("-n", *TARGETS, shard))
    (project.folder / shard).write_bytes(content)
    on_lr, in_two_modes = 6, 3  # TetGAN, TetFlow, the representation; and three PCAs
    assert rerun == {
        "extract_fields": 1,
        "index_fields": 1,
        "train_model": on_lr,
        "sample_model": on_lr + in_two_modes,
        "evaluate_model": on_lr + in_two_modes,
        "tabulate_category": 1,
        "draw_samples": 1,
    }


def test_an_edited_option_reruns_only_what_depends_on_it(smoked):
    project, _, _ = smoked
    rerun = planned(project.smoke("-n", *TARGETS, "--config", "samples={count: 9}"))
    assert "sample_model" in rerun
    assert "train_model" not in rerun


def test_the_certificates_and_the_index_agree_with_the_catalogue(smoked):
    project, _, _ = smoked
    results = project.folder / "results" / "smoke"
    catalogue = pd.read_csv(results / "data/chair/catalogue.csv")
    index = json.loads((results / "fields/chair/LR/index.json").read_text())
    assert index["mu"] > 0
    used = catalogue[catalogue["status"].isin(["ok", "filled"])]
    validation = set(used.loc[used["split"] == "validation", "id"])
    certificate = pd.read_csv(results / "samples/chair/tetgan-LR/0/paper/none/certificate.csv")
    assert set(certificate.loc[certificate["set"] == "reconstructed", "id"]) == validation
