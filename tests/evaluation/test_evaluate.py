"""The two stages, on boxes whose measures are known."""

import json
import shutil

import numpy as np
import pandas as pd
import pytest
import trimesh

from tetgan.errors import UserError
from tetgan.evaluation.evaluate import evaluate_model, evaluate_real
from tetgan.evaluation.options import BootstrapOptions, EvaluationOptions, SetOptions, VarietyOptions
from tetgan.shapes.archive import write_meshes

OPTIONS = EvaluationOptions(
    points=1500,
    volume_points=5000,
    samples=4,
    sets=SetOptions(shapes=5, points=256),
    variety=VarietyOptions(pairs=6, closest=2, repeats=2),
    bootstrap=BootstrapOptions(resamples=50, frechet_resamples=20),
)
IDS = ["a", "b", "c", "d", "e", "f"]


def box(height: float) -> trimesh.Trimesh:
    """A box of 0.5 by `height` by 0.5 that stands on y = 0.2."""
    made = trimesh.creation.box((0.5, height, 0.5))
    made.apply_translation((0.5, 0.2 + height / 2, 0.5))
    return made


@pytest.fixture(scope="module")
def originals(tmp_path_factory):
    """Two shards of repaired meshes and the catalogue that splits them."""
    folder = tmp_path_factory.mktemp("data")
    items = [(name, box(0.2 + 0.05 * i).vertices, box(0.2 + 0.05 * i).faces) for i, name in enumerate(IDS)]
    records = [
        {"id": name, "path": "", "sha256": "", "split": "", "status": "ok", "reason": ""} for name in IDS
    ]
    for part in range(2):
        write_meshes(folder / f"{part}.zip", items[part::2], records[part::2])
    table = pd.DataFrame(records)
    table["split"] = ["validation", "validation", "train", "train", "train", "train"]
    table.to_csv(folder / "catalogue.csv", index=False)
    return [folder / "0.zip", folder / "1.zip"], folder / "catalogue.csv"


@pytest.fixture(scope="module")
def samples(tmp_path_factory):
    """Reconstructions of `a` (perfect) and `b` (missing), five generated boxes, one of them empty."""
    root = tmp_path_factory.mktemp("samples")
    for name in ("none", "wls"):
        rows = []
        for kind, ids in (("generated", ["0", "1", "2", "3", "4", "5"]), ("reconstructed", ["a", "b"])):
            (root / name / kind).mkdir(parents=True)
            for i, shape_id in enumerate(ids):
                made = shape_id not in ("b", "5")
                if made:
                    box(0.2 + 0.05 * i).export(root / name / kind / f"{shape_id}.ply")
                iou = 0.75 if kind == "reconstructed" else None
                rows.append(
                    {"set": kind, "id": shape_id, "iou": iou, "tets": 8 * made, "inverted_tets": 2 * made}
                )
        pd.DataFrame(rows).to_csv(root / name / "certificate.csv", index=False)
    (root / "about.json").write_text(json.dumps({"method": "tetgan", "tets": 1536, "train_minutes": 2.5}))
    return root


@pytest.fixture(scope="module")
def measure(originals, clouds, extractor, tmp_path_factory):
    """Runs the stage on a folder of samples and reads its report."""

    def run(samples, options=OPTIONS, catalogue=originals[1]):
        identity = {"category": "slab", "model": "tetgan-LR", "grid": "LR", "mode": "paper", "seed": 0}
        out = tmp_path_factory.mktemp("metrics") / "metrics.json"
        evaluate_model(
            samples,
            originals[0],
            clouds[0],
            extractor,
            options=options,
            identity=identity,
            out=out,
            catalogue=catalogue,
        )
        return json.loads(out.read_text())

    return run


@pytest.fixture(scope="module")
def report(measure, samples):
    return measure(samples)


def test_identity_comes_with_the_samples_own_account(report):
    assert report["model"] == "tetgan-LR"
    assert (report["method"], report["tets"], report["train_minutes"]) == ("tetgan", 1536, 2.5)
    assert len(report["extractor"]["digest"]) == 12
    assert set(report["smoothings"]) == {"none", "wls"}


def test_missing_and_empty_meshes_are_counted(report):
    section = report["smoothings"]["none"]
    assert section["generated"] == {"expected": 6, "found": 5}
    assert section["reconstructed"] == {"expected": 2, "found": 1}
    assert section["metrics"]["chamfer"]["n"] == 1


def test_what_has_no_surface_is_counted_where_it_can_be(report):
    """Of two reconstructions one is perfect and one is missing; of six samples one is empty."""
    section = report["smoothings"]["none"]
    metrics = section["metrics"]
    assert metrics["volume_iou"] | {"low": None, "high": None} == {
        "value": 0.5,
        "low": None,
        "high": None,
        "n": 2,
        "std": None,
    }
    assert 0 < metrics["fscore"]["value"] <= 0.5
    assert metrics["fscore"]["n"] == 2
    assert (metrics["empty_reconstructions"]["value"], metrics["empty_reconstructions"]["n"]) == (0.5, 2)
    assert (metrics["empty_samples"]["value"], metrics["empty_samples"]["n"]) == (pytest.approx(1 / 6), 6)
    for name in ("chamfer", "chamfer_l1", "normal_consistency", "faces"):
        assert metrics[name]["n"] == 1
    assert section["notes"][0] == (
        "1 of 2 reconstructions have no surface: Chamfer, Chamfer L1, Normals, Faces are of the others, "
        "F-score, Volume IoU count them as 0"
    )
    assert any(
        note.startswith("1 of 6 generated shapes have no surface: FID, KID,") for note in section["notes"]
    )


def test_nothing_is_empty_where_all_have_a_surface(measure, samples, tmp_path):
    kept = tmp_path / "samples"
    shutil.copytree(samples / "wls", kept / "wls")
    certificate = kept / "wls" / "certificate.csv"
    table = pd.read_csv(certificate, dtype={"id": str})
    table[~table["id"].isin(["b", "5"])].to_csv(certificate, index=False)
    section = measure(kept)["smoothings"]["wls"]
    metrics = section["metrics"]
    assert (metrics["empty_reconstructions"]["value"], metrics["empty_samples"]["value"]) == (0, 0)
    assert metrics["volume_iou"]["value"] == 1
    assert not any("no surface" in note for note in section["notes"])


def test_a_perfect_reconstruction_measures_the_noise_floor(report):
    metrics = report["smoothings"]["none"]["metrics"]
    # Area of the box over (pi n), both ways; borders are shared by faces, so nothing is added.
    area = 2 * 0.25 + 4 * 0.5 * 0.2
    assert metrics["chamfer"]["value"] == pytest.approx(2 * area / (np.pi * OPTIONS.points), rel=0.1)
    assert metrics["normal_consistency"]["value"] > 0.95
    assert metrics["faces"]["value"] == 12
    assert metrics["manifold_edges"]["value"] == metrics["manifold_shapes"]["value"] == 1
    assert metrics["boundary_edges"]["value"] == metrics["nonmanifold_edges"]["value"] == 0
    assert metrics["iou"]["value"] == 0.75
    assert metrics["inverted_tets"]["value"] == 0.25


def test_fid_and_kid_are_measured_at_the_same_n_and_warn(report):
    section = report["smoothings"]["none"]
    assert section["metrics"]["fid"]["n"] == section["metrics"]["kid"]["n"] == 4
    assert section["metrics"]["fid"]["value"] > 0
    assert any("FID at N = 4" in note for note in section["notes"])


def test_sets_are_compared_at_the_same_n(report):
    metrics = report["smoothings"]["none"]["metrics"]
    assert {metrics[name]["n"] for name in ("mmd", "cov", "nna", "jsd", "novelty")} == {5}
    for name in ("cov", "nna", "jsd", "precision", "recall"):
        estimate = metrics[name]
        assert 0 <= estimate["low"] <= estimate["value"] <= estimate["high"] <= 1
    assert {metrics[name]["n"] for name in ("fid_infinity", "precision", "recall")} == {4}


def test_copies_of_training_shapes_are_not_novel(report):
    # Generated are boxes 0.2 to 0.4 high, training ones 0.3 to 0.45: the first two differ by 0.1 and 0.05.
    area = 0.5 + 4 * 0.5 * 0.33
    floor = 2 * area / (np.pi * OPTIONS.sets.points)
    novelty = report["smoothings"]["none"]["metrics"]["novelty"]["value"]
    assert floor < novelty < 2.5 * floor


def test_without_a_catalogue_there_is_no_novelty(measure, samples):
    metrics = measure(samples, catalogue=None)["smoothings"]["none"]["metrics"]
    assert metrics["novelty"]["value"] is None
    assert metrics["mmd"]["value"] is not None


def test_the_same_inputs_give_the_same_figures(measure, samples, report):
    assert measure(samples) == report


def test_too_few_samples_leave_metrics_empty(measure, samples):
    options = OPTIONS.model_copy(
        update={
            "samples": 6,
            "sets": SetOptions(shapes=6, points=64),
            "variety": VarietyOptions(pairs=20, closest=2),
        }
    )
    section = measure(samples, options)["smoothings"]["wls"]
    for metric in (
        "variety",
        "fid",
        "kid",
        "fid_infinity",
        "precision",
        "recall",
        "mmd",
        "cov",
        "nna",
        "jsd",
    ):
        assert section["metrics"][metric]["value"] is None
    missing, sampled = section["notes"][0], section["notes"][-1]
    assert "reconstructions have no surface" in missing and "generated shapes have no surface" in sampled
    assert section["notes"][1:-1] == [
        "variety needs 7 surfaces and has 5",
        "FID, KID, FID∞, Precision, Recall need 6 surfaces on each side and have 5, 6",
        "MMD, COV, 1-NNA, JSD need 6 surfaces on each side and have 5, 6",
    ]


def test_nothing_generated_nor_reconstructed_is_not_an_error(measure, tmp_path):
    (tmp_path / "none").mkdir()
    report = measure(tmp_path)
    metrics = report["smoothings"]["none"]["metrics"]
    assert {estimate["value"] for estimate in metrics.values()} == {None}
    assert report["smoothings"]["none"]["generated"] == {"expected": 0, "found": 0}


def test_no_samples_at_all_is_an_error(measure, tmp_path):
    with pytest.raises(UserError, match="no samples"):
        measure(tmp_path)


def test_real_shapes_measure_their_own_floor(originals, clouds, extractor, tmp_path):
    shards, catalogue = originals
    out = tmp_path / "real.json"
    evaluate_real(shards, catalogue, clouds[0], extractor, options=OPTIONS, category="slab", out=out)
    report = json.loads(out.read_text())
    assert (report["category"], report["model"], report["method"]) == ("slab", "real", "real")
    section = report["smoothings"]["none"]
    assert section["generated"] == {"expected": 6, "found": 6}
    assert section["metrics"]["chamfer"]["n"] == 2  # the validation meshes
    assert section["metrics"]["variety"]["n"] == 4  # the training meshes
    area = 0.5 + 4 * 0.5 * 0.225
    assert section["metrics"]["chamfer"]["value"] == pytest.approx(
        2 * area / (np.pi * OPTIONS.points), rel=0.1
    )
    assert section["metrics"]["faces"] == {"value": 12, "low": 12, "high": 12, "n": 6, "std": None}
    assert section["metrics"]["manifold_shapes"]["value"] == 1
    assert section["metrics"]["fid"]["n"] == 4
    assert section["metrics"]["volume_iou"]["value"] == 1
    assert {section["metrics"][name]["n"] for name in ("mmd", "cov", "nna", "jsd", "novelty")} == {5}
    note = next(note for note in section["notes"] if "sampled twice, 256 points each" in note)
    assert float(note.split(": ")[1].split(". ")[0]) == pytest.approx(
        2 * area / (np.pi * OPTIONS.sets.points), rel=0.3
    )
