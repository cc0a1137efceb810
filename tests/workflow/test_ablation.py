"""The ablation's table and figure: the models they train, and no others."""

import numpy as np
import pandas as pd
import yaml
from PIL import Image
from smoke_project import ROOT, planned

from tetgan.config import Config

TABLE, FIGURE = "tables/ablation.csv", "figures/chair/ablations.png"
DEFAULT = Config.parse(yaml.safe_load((ROOT / "config" / "config.yaml").read_text()))


def test_every_ablation_is_trained_but_the_one_that_is_only_meshed_differently(project):
    jobs = planned(project.snakemake("-n", f"results/{TABLE}"))
    assert jobs["train_model"] == len(DEFAULT.ablation) - 1
    assert jobs["sample_model"] == jobs["evaluate_model"] == len(DEFAULT.ablation)


def test_the_table_of_a_category_needs_no_ablation(project):
    jobs = planned(project.snakemake("-n", "results/tables/chair.csv"))
    assert jobs["evaluate_model"] == sum(len(DEFAULT.modes_of(name)) for name in DEFAULT.table_models)


def test_the_surface_network_waits_for_the_model_it_stands_on(project):
    target = "results/models/chair/surface-gcn/0/weights.safetensors"
    assert planned(project.snakemake("-n", target))["train_model"] == 2


def test_how_a_model_is_meshed_does_not_train_it_again(smoked):
    project, _, _ = smoked
    changed = project.smoke("-n", "results/smoke/tables/chair.csv", "--config", "meshing={beta: 0.9}")
    jobs = planned(changed)
    assert jobs["sample_model"] > 0
    assert "train_model" not in jobs


def test_the_smoke_run_ends_with_a_whole_table_and_a_figure(smoked):
    project, _, _ = smoked
    results = project.folder / "results" / "smoke"
    targets = [f"results/smoke/{name}" for name in (TABLE, FIGURE)]
    run = project.smoke(*targets)
    assert run.returncode == 0, run.stdout + run.stderr
    table = pd.read_csv(results / TABLE)
    rows = table.set_index(["model", "smoothing"])
    assert list(dict.fromkeys(table["model"])) == ["tetgan-LR", "surface-gcn", "tet-gcn", "no-filter", "real"]
    assert table.loc[table["model"] == "no-filter", "changes"].tolist() == 2 * ["gamma off (full: 4.0)"]
    measured = rows.loc[("no-filter", "none")]
    assert measured[["volume", "thickness", "floating", "components", "train_minutes"]].notna().all()
    for other in "surface-gcn", "tetgan-LR":  # the same occupancy
        assert rows.loc[(other, "none"), "iou"] == measured["iou"]
    unfiltered, filtered, moved = (
        pd.read_csv(results / f"samples/chair/{model}/0/paper/none/certificate.csv")["tets"]
        for model in ("no-filter", "tetgan-LR", "surface-gcn")
    )
    assert (unfiltered >= filtered).all() and (unfiltered == moved).all()
    assert (results / TABLE).with_suffix(".md").read_text().startswith("# Ablations on chair")
    picture = np.asarray(Image.open(results / FIGURE).convert("L"))
    assert 0.01 < (picture < 230).mean() < 0.9
