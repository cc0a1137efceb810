"""The manifold table: its meshes, and the two figures that the paper states."""

import pytest

from tetgan.tables.manifold import tabulate_manifold

EDGES = {"manifold_edges": (0.98, 0.97, 0.99, None, 7), "boundary_edges": (0,), "nonmanifold_edges": (0.02,)}


@pytest.fixture
def manifold(tmp_path, paper, write, read):
    def make(reports):
        tabulate_manifold(write(reports), paper, tmp_path / "manifold.csv")
        return read(tmp_path / "manifold.csv")

    return make


def test_ground_truth_and_generated_chairs_stand_beside_the_papers_figures(manifold, report):
    models = ["real", "representation-LR", "pca-16", "tetgan-LR"]
    table, text = manifold([report("chair", model, **EDGES, manifold_shapes=(0.25,)) for model in models])
    columns = ["model", "shapes", "manifold_edges", "manifold_edges_paper", "manifold_shapes"]
    assert table[columns].to_numpy().tolist() == [
        ["tetgan-LR", "generated", "0.98", "98.5%", "0.25"],
        ["representation-LR", "ground truth", "0.98", "98.9%", "0.25"],
        ["pca-16", "generated", "0.98", "", "0.25"],
        ["real", "repaired", "0.98", "", "0.25"],
    ]
    assert set(table["boundary_edges"]) == {"0.0"}  # measured, not missing
    assert set(table["n"]) == {"7"}
    assert "0.98 [0.97, 0.99] (paper 98.5%)" in text


def test_the_method_decides_which_shapes_the_edges_belong_to(manifold, report):
    reports = [
        report("chair", "my-net", method="tetgan", **EDGES),
        report("chair", "my-fields", method="representation", **EDGES),
        report("chair", "tetgan-like", method="other", **EDGES),
    ]
    table, _ = manifold(reports)
    assert table[["model", "shapes", "manifold_edges_paper"]].to_numpy().tolist() == [
        ["my-net", "generated", "98.5%"],
        ["tetgan-like", "generated", ""],
        ["my-fields", "ground truth", "98.9%"],
    ]


def test_the_paper_states_nothing_of_other_categories(manifold, report):
    table, _ = manifold([report(category, "tetgan-LR", **EDGES) for category in ("chair", "vase")])
    assert list(table["category"]) == ["chair", "vase"]
    assert list(table["manifold_edges_paper"]) == ["98.5%", ""]


def test_what_was_not_measured_is_empty(manifold, report):
    table, text = manifold([report("chair", "tetgan-LR", manifold_edges=(None,))])
    row = table.iloc[0]
    assert (row["manifold_edges"], row["n"], row["nonmanifold_edges"], row["manifold_shapes"]) == ("",) * 4
    assert "— (paper 98.5%)" in text


def test_seeds_are_averaged(manifold, report):
    reports = [report("chair", "tetgan-LR", seed, manifold_edges=(0.9 + seed / 10,)) for seed in (0, 1)]
    row = manifold(reports)[0].iloc[0]
    assert float(row["manifold_edges"]) == pytest.approx(0.95)
    assert float(row["manifold_edges_std"]) == pytest.approx(0.1 / 2**0.5)
    assert row["seeds"] == "2"
