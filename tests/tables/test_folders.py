"""Two folders of meshes from anywhere: known answers, broken files, and the report."""

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

from tetgan.errors import UserError
from tetgan.evaluation.meshfolder import MeshFolder
from tetgan.evaluation.options import BootstrapOptions, EvaluationOptions, SetOptions, VarietyOptions
from tetgan.tables.folders import evaluate_folders

OPTIONS = EvaluationOptions(
    points=600,
    volume_points=4000,
    samples=6,
    sets=SetOptions(shapes=6, points=128),
    variety=VarietyOptions(pairs=6, closest=2, repeats=2),
    bootstrap=BootstrapOptions(resamples=50, frechet_resamples=20),
)
SUFFIXES = (".obj", ".off", ".ply", ".stl", ".glb")


def slab(height: float) -> trimesh.Trimesh:
    made = trimesh.creation.box((0.8, height, 0.6))
    made.apply_translation((0.5, 0.5, 0.5))
    return made


def rod(height: float) -> trimesh.Trimesh:
    made = trimesh.creation.cylinder(0.05, height, sections=12)
    made.apply_translation((0.5, 0.5, 0.5))
    return made


def write(folder: Path, shape, count: int = 8) -> Path:
    """Meshes of growing height, of every kind of file."""
    (folder / "deep").mkdir(parents=True)
    for i in range(count):
        where = folder / "deep" if i % 2 else folder
        shape(0.2 + 0.05 * i).export(where / f"{i}{SUFFIXES[i % len(SUFFIXES)]}")
    return folder


@pytest.fixture(scope="module")
def slabs(tmp_path_factory) -> Path:
    return write(tmp_path_factory.mktemp("slabs"), slab)


@pytest.fixture(scope="module")
def rods(tmp_path_factory) -> Path:
    return write(tmp_path_factory.mktemp("rods"), rod)


@pytest.fixture(scope="module")
def measure(tmp_path_factory):
    def run(samples: Path, reference: Path, **kwargs) -> tuple[dict, str]:
        out = tmp_path_factory.mktemp("report") / "report.json"
        evaluate_folders(samples, reference, out=out, **{"options": OPTIONS} | kwargs)
        return json.loads(out.read_text()), out.with_suffix(".md").read_text()

    return run


def values(section: dict) -> dict[str, float | None]:
    return {name: estimate["value"] for name, estimate in section["metrics"].items()}


@pytest.fixture(scope="module")
def same(measure, slabs, extractor):
    """A folder beside itself, with everything that can be given."""
    return measure(slabs, slabs, extractor=extractor, reconstructions=slabs, training=slabs)


@pytest.fixture(scope="module")
def apart(measure, rods, slabs, extractor):
    return measure(rods, slabs, extractor=extractor)


def test_perfect_copies_are_as_close_as_sampling_allows(same):
    got = values(same[0]["found"])
    # Six of eight on each side, drawn independently and their points too: not all originals are among them.
    # One may lie apart by its features, which the rounding in a few seconds of training decides.
    assert got["cov"] >= 0.5
    assert min(got["precision"], got["recall"]) >= 5 / 6
    assert got["manifold_edges"] == 1
    assert got["faces"] == 12
    assert got["volume_iou"] == 1
    area = np.mean([2 * (0.8 * 0.6 + (0.8 + 0.6) * (0.2 + 0.05 * i)) for i in range(8)])
    assert got["chamfer"] == pytest.approx(2 * area / (np.pi * OPTIONS.points), rel=0.15)
    assert got["novelty"] == pytest.approx(2 * area / (np.pi * OPTIONS.sets.points), rel=0.25)


def test_reconstructions_of_copies_measure_the_floor_itself(same):
    found, floor = values(same[0]["found"]), values(same[0]["floor"])
    assert found["chamfer"] == floor["chamfer"]
    assert floor["volume_iou"] == 1


def test_sets_that_are_apart_share_nothing(apart):
    got = values(apart[0]["found"])
    assert got["nna"] == 1
    assert got["precision"] == got["recall"] == 0
    assert got["jsd"] > 0.5
    floor = values(apart[0]["floor"])
    for name in ("mmd", "fid", "kid", "jsd"):
        assert got[name] > floor[name]


def test_a_collapsed_generator_has_no_variety_and_covers_one_shape(measure, slabs, same, tmp_path_factory):
    folder = tmp_path_factory.mktemp("collapsed")
    for i in range(8):
        slab(0.4).export(folder / f"{i}.ply")  # as one of the reference
    got = values(measure(folder, slabs)[0]["found"])
    assert got["cov"] == 1 / OPTIONS.sets.shapes  # one of the reference shapes has all of them
    area = 2 * (0.8 * 0.6 + (0.8 + 0.6) * 0.4)
    floor = 2 * area / (np.pi * OPTIONS.points)  # one surface, sampled twice
    assert 0.7 * floor < got["variety"] < 1.1 * floor
    assert got["variety"] < 0.8 * values(same[0]["found"])["variety"]


def test_the_floor_is_half_against_half(apart):
    assert apart[0]["found"]["metrics"]["mmd"]["n"] == 6
    assert apart[0]["floor"]["metrics"]["mmd"]["n"] == 4


def test_the_report_states_conventions_and_what_is_left_out(apart):
    _, text = apart
    for words in (
        "Nothing is moved or scaled",
        "the reference cut at random into two halves",
        "6 shapes on each side, Chamfer distance of 128 points",
        "held-out accuracy",
        "**Only 6 shapes on each side**",
        "FID at N = 6",
        "No --training, so no novelty",
        "No --reconstructions",
        "Half of the reference is fewer shapes",
    ):
        assert words in text
    assert "left out, listed below" not in text


def test_without_an_extractor_there_are_no_features_and_it_says_so(measure, slabs):
    report, text = measure(slabs, slabs)
    assert report["extractor"] is None
    assert "fid" not in report["found"]["metrics"]
    assert "No --extractor, so no FID, KID, FID∞, Precision, Recall." in text


def test_the_same_folders_give_the_same_report(measure, rods, slabs, extractor, apart):
    assert measure(rods, slabs, extractor=extractor) == apart


def test_broken_meshes_are_listed_and_stop_nothing(measure, slabs, tmp_path):
    samples = write(tmp_path / "samples", slab)
    (samples / "cut.ply").write_bytes(b"ply\nformat ascii 1.0\nelement vertex 3\n")
    (samples / "empty.off").write_text("OFF\n0 0 0\n")
    (samples / "wild.obj").write_text("v 0 0 0\nv 1 0 nan\nv 0 1 1\nv 1 1 1\nf 1 2 3\nf 2 3 4\n")
    (samples / "0.off").write_text("OFF\n0 0 0\n")
    found = write(tmp_path / "reconstructions", slab, 2)
    slab(0.3).export(found / "stranger.ply")
    report, text = measure(samples, slabs, reconstructions=found)
    assert report["meshes"]["samples"] == {"files": 12, "unusable": 4}
    reasons = {Path(path).name: why for path, why in report["problems"].items()}
    assert set(reasons) == {"cut.ply", "empty.off", "wild.obj", "0.off", "stranger.ply"}
    assert reasons["0.off"] == "0.obj has the same name"
    assert reasons["wild.obj"] == "coordinates not finite"
    assert "no 'stranger' in" in reasons["stranger.ply"]
    assert "4 of 12 meshes of the samples are left out" in text
    assert "`" + str(samples / "wild.obj") + "`: coordinates not finite" in text
    assert report["found"]["metrics"]["chamfer"]["n"] == 2
    assert report["found"]["metrics"]["faces"]["n"] == 8
    assert report["found"]["metrics"]["empty_samples"]["value"] == pytest.approx(3 / 11)


def test_a_reconstruction_without_a_surface_is_counted(measure, slabs, tmp_path):
    found = write(tmp_path / "reconstructions", slab, 3)
    (found / "2.ply").unlink()
    (found / "2.off").write_text("OFF\n0 0 0\n")
    report, text = measure(slabs, slabs, reconstructions=found)
    metrics = report["found"]["metrics"]
    assert metrics["empty_reconstructions"]["value"] == pytest.approx(1 / 3)
    assert metrics["volume_iou"]["value"] == pytest.approx(2 / 3)
    assert (metrics["volume_iou"]["n"], metrics["chamfer"]["n"]) == (3, 2)
    assert report["floor"]["metrics"]["volume_iou"]["value"] == 1
    assert "1 of 3 reconstructions have no surface" in text
    assert metrics["empty_samples"]["value"] == 0


def test_frames_that_differ_are_noticed_and_can_be_fitted(measure, slabs, tmp_path):
    (tmp_path / "large").mkdir()
    for i in range(6):
        made = slab(0.2 + 0.05 * i)
        made.apply_scale(40)
        made.export(tmp_path / "large" / f"{i}.ply")
    stored, text = measure(tmp_path / "large", slabs)
    assert "longest side of a sample is 32, of a reference mesh 0.8" in text
    fitted, text = measure(tmp_path / "large", slabs, fit=True)
    assert "longest side of a sample" not in text
    assert "centred in the unit cube, the longest side 1" in text
    assert values(fitted["found"])["mmd"] < 0.05
    assert values(stored["found"])["mmd"] > 100


def test_a_mesh_split_into_triangles_keeps_its_edges(tmp_path):
    slab(0.3).export(tmp_path / "a.stl")
    surface = MeshFolder(tmp_path, fit=False).surface("a")
    assert len(surface.vertices) == 8
    assert len(surface.faces) == 12


def test_a_reference_of_three_has_no_floor(measure, slabs, tmp_path):
    report, text = measure(slabs, write(tmp_path / "few", slab, 3))
    assert report["floor"] is None
    assert "there is no floor" in text
    assert report["found"]["metrics"]["cov"]["n"] == 3


def test_nothing_to_measure_is_one_line(slabs, tmp_path):
    out = tmp_path / "report.json"
    with pytest.raises(UserError, match="no such folder"):
        evaluate_folders(tmp_path / "absent", slabs, options=OPTIONS, out=out)
    (tmp_path / "empty").mkdir()
    with pytest.raises(UserError, match="no mesh"):
        evaluate_folders(slabs, tmp_path / "empty", options=OPTIONS, out=out)
    (tmp_path / "broken").mkdir()
    slab(0.3).export(tmp_path / "broken" / "good.ply")
    (tmp_path / "broken" / "bad.off").write_text("OFF\n0 0 0\n")
    with pytest.raises(UserError, match=r"1 of 2 meshes can be used, and it takes two; bad.off: "):
        evaluate_folders(tmp_path / "broken", slabs, options=OPTIONS, out=out)
    with pytest.raises(UserError, match=r"name a \.json"):
        evaluate_folders(slabs, slabs, options=OPTIONS, out=tmp_path / "report.md")
    assert not out.exists()
