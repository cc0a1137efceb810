"""Many samples under load: rows, reasons, the sample that a figure shows, remeshing and the table."""

import importlib.util

import numpy as np
import pandas as pd
import pytest

from tetgan.errors import UserError
from tetgan.geometry.adjacency import boundary_faces
from tetgan.geometry.tets import TetMesh
from tetgan.mechanics.options import LoadCase, RemeshOptions, SimulationOptions
from tetgan.mechanics.remesh import RemeshWorker, can_remesh
from tetgan.mechanics.simulation import simulate
from tetgan.mechanics.study import first_standing, is_standing, simulate_samples
from tetgan.mechanics.table import tabulate_simulation
from tetgan.solids.export import write_tets
from tetgan.solids.solid import SolidMesh

needs_ftetwild = pytest.mark.skipif(
    importlib.util.find_spec("pytetwild") is None, reason="pytetwild is not installed"
)
CASE = LoadCase(order=1)


@pytest.fixture(scope="module")
def leaning(bar):
    """A column that leans so far that its middle is no longer above its foot."""
    solid = bar(4, 1, length=0.8, side=0.2)
    x, y, z = solid.vertices.T
    return TetMesh(np.stack([y + 0.8 * x, x, z], axis=1), solid.tets[:, [0, 2, 1, 3]])


@pytest.fixture(scope="module")
def samples(bar, leaning, tmp_path_factory):
    """Four samples: empty, one with an inverted tet, one that leans, a block beside a crumb; then a block."""
    folder = tmp_path_factory.mktemp("samples")
    block = bar(2, 2, length=0.5, side=0.5)
    crumb = block.vertices[[0, 1, 3, 9]] * 0.1 + np.array([0.8, 0, 0])
    crumb_tet = np.arange(4)[None] + len(block.vertices)
    broken = block.vertices.copy()
    broken[np.argmin(((broken - 0.25) ** 2).sum(axis=1))] += 0.6
    bodies = {
        "1": TetMesh(broken, block.tets),
        "2": leaning,
        "3": TetMesh(np.concatenate([block.vertices, crumb]), np.concatenate([block.tets, crumb_tet])),
        "4": block,
    }
    for name, body in bodies.items():
        mesh = SolidMesh(body.vertices, body.tets, boundary_faces(body.tets))
        write_tets(folder / "none" / "generated" / f"{name}.vtu", mesh)
    rows = pd.DataFrame({"set": "generated", "id": ["0", *bodies]})
    rows.to_csv(folder / "none" / "certificate.csv", index=False)
    return folder


@pytest.fixture(scope="module")
def study(samples, tmp_path_factory):
    out = tmp_path_factory.mktemp("study") / "study.csv"
    options = SimulationOptions(case=CASE, remeshed=0)
    simulate_samples(samples, out, options, {"category": "block", "model": "by-hand", "mode": "solid"})
    return out


def test_every_sample_has_a_row_and_a_reason(study):
    rows = pd.read_csv(study, dtype={"id": str}).fillna({"reason": ""}).set_index("id")
    assert rows["reason"].tolist() == ["nothing in it", "inverted tets", "", "", ""]
    assert rows["pieces"].tolist()[2:] == [1, 2, 1]
    assert rows.loc["3", "share"] == pytest.approx(48 / 49)
    assert rows["standing"].tolist()[2:] == [False, True, True]
    # The largest piece of the third is the fourth.
    assert rows.loc["3", "peak_displacement"] == rows.loc["4", "peak_displacement"] > 0
    assert (rows["imbalance"].dropna() < 1e-9).all() and (rows["seconds"].dropna() > 0).all()


def test_the_table_counts_them(study, tmp_path):
    tabulate_simulation([study], tmp_path / "table.csv")
    row = pd.read_csv(tmp_path / "table.csv").iloc[0]
    assert row["seeds"] == 1 and np.isnan(row["displacement_std"])
    assert (row["n"], row["simulated"], row["failed"]) == (5, 3, 2)
    assert row["reasons"] == "1 nothing in it; 1 inverted tets"
    assert (row["in_pieces"], row["standing"], row["remeshed"]) == (1, 2, 0)
    assert row["displacement_p5"] <= row["displacement"] <= row["displacement_p95"]
    assert np.isnan(row["difference"])
    assert "1 inverted tets" in (tmp_path / "table.md").read_text()


def test_seeds_become_one_row_with_their_deviation(study, tmp_path):
    rows = pd.read_csv(study, dtype={"id": str}, keep_default_na=False, na_values=[""])
    rows.assign(peak_displacement=3 * rows["peak_displacement"]).to_csv(tmp_path / "other.csv", index=False)
    rows.assign(mode="paper").to_csv(tmp_path / "paper.csv", index=False)
    files = [study, tmp_path / "paper.csv", tmp_path / "other.csv"]
    tabulate_simulation(files, tmp_path / "table.csv")
    table = pd.read_csv(tmp_path / "table.csv").set_index("mode")
    assert table["seeds"].to_dict() == {"solid": 2, "paper": 1}
    assert table["n"].to_dict() == {"solid": 10, "paper": 5}
    one = table.loc["paper", "displacement"]
    assert table.loc["solid", "displacement_std"] == pytest.approx(np.std([one, 3 * one], ddof=1))
    assert table.loc["solid", "simulated_std"] == 0
    assert "6 ± 0" in (tmp_path / "table.md").read_text()


def test_a_file_that_is_no_study_is_named(tmp_path):
    (tmp_path / "other.csv").write_text("a,b\n1,2\n")
    with pytest.raises(UserError, match=r"other.csv: not a simulation study"):
        tabulate_simulation([tmp_path / "other.csv"], tmp_path / "table.csv")


def test_the_figure_shows_the_first_whole_one_that_stands(samples):
    found = first_standing(samples, CASE)
    assert (found.sample, found.whole, found.standing) == ("4", True, True)
    assert found.result.record()["left_out"] == 0


def test_without_such_a_one_it_shows_the_largest_piece_of_another(samples, tmp_path):
    (tmp_path / "none").mkdir()
    for name in ("generated", "certificate.csv"):
        (tmp_path / "none" / name).symlink_to(samples / "none" / name)
    (tmp_path / "none" / "certificate.csv").unlink()
    pd.DataFrame({"set": "generated", "id": ["2", "3"]}).to_csv(
        tmp_path / "none" / "certificate.csv", index=False
    )
    found = first_standing(tmp_path, CASE)
    assert (found.sample, found.whole, found.standing) == ("3", False, True)
    assert 0 < found.result.record()["left_out"] < 0.1


def test_a_column_that_leans_too_far_does_not_stand(leaning, bar):
    upright = bar(1, 1, length=0.2, side=0.2)
    assert is_standing(simulate(upright, CASE))
    assert not is_standing(simulate(leaning, CASE))


def test_a_folder_without_samples_is_named(tmp_path):
    (tmp_path / "none" / "generated").mkdir(parents=True)
    with pytest.raises(UserError, match="no generated samples"):
        simulate_samples(tmp_path, tmp_path / "study.csv", SimulationOptions(remeshed=0), {})


def test_without_pytetwild_one_line_says_so(samples, tmp_path, monkeypatch, caplog):
    monkeypatch.setattr("tetgan.mechanics.study.can_remesh", lambda: False)
    options = SimulationOptions(case=CASE, samples=5, remeshed=2)
    simulate_samples(samples, tmp_path / "study.csv", options, {})
    told = [record.message for record in caplog.records if "pytetwild" in record.message]
    assert told == ["no sample is remeshed: pytetwild is not installed (pip install 'tetgan[remesh]')"]
    assert "difference" not in pd.read_csv(tmp_path / "study.csv")


@needs_ftetwild
def test_a_remeshed_block_is_the_same_block(bar, tmp_path, monkeypatch):
    assert can_remesh()
    monkeypatch.chdir(tmp_path)
    block = bar(2, 2, length=0.5, side=0.5)
    with RemeshWorker(RemeshOptions(edge=0.2)) as worker:
        other = worker.remesh(block)
    # The envelope is a thousandth of the diagonal, on six sides.
    assert (other.volumes > 0).all() and other.volumes.sum() == pytest.approx(0.125, rel=0.02)
    assert not list(tmp_path.iterdir())
    one, two = (simulate(body, LoadCase()).record()["peak_displacement"] for body in (block, other))
    assert one == pytest.approx(two, rel=0.1)


@needs_ftetwild
@pytest.mark.slow
def test_the_study_compares_with_ftetwild(samples, tmp_path):
    out = tmp_path / "study.csv"
    simulate_samples(samples, out, SimulationOptions(remeshed=2), {"mode": "solid"})
    rows = pd.read_csv(out, dtype={"id": str}).set_index("id")
    assert rows["difference"].notna().tolist() == [False, False, True, True, False]
    assert rows["refined_difference"].abs().max() < 0.1


@needs_ftetwild
@pytest.mark.slow
def test_large_bodies_are_not_cut_into_eight(samples, tmp_path, monkeypatch):
    monkeypatch.setattr("tetgan.mechanics.study._MOST_REFINED", 0)
    out = tmp_path / "study.csv"
    simulate_samples(samples, out, SimulationOptions(remeshed=1), {"mode": "solid"})
    rows = pd.read_csv(out)
    assert rows["difference"].notna().any() and rows["refined_difference"].isna().all()
