"""Time and memory: made-up benchmark files with sums done by hand."""

import numpy as np
import pandas as pd
import pytest

from tetgan.errors import UserError
from tetgan.tables.runtime import BENCHMARKS, COLUMNS, tabulate_runtime

HEAD = "s\th:m:s\tmax_rss\tmax_vms\tmax_uss\tmax_pss\tio_in\tio_out\tmean_load\tcpu_time\n"
SHARDS = 2


def benchmark(seconds, rss=100, cpu=1):
    return f"{seconds}\t0:00:01\t{rss}\t1\t1\t1\t0\t0\t50\t{cpu}\n"


@pytest.fixture
def results(tmp_path):
    """A folder of results with four chairs, three of them repaired and two of those in training."""
    folder = tmp_path / "results"
    catalogue = folder / "data" / "chair" / "catalogue.csv"
    catalogue.parent.mkdir(parents=True)
    rows = [("ok", "train"), ("filled", "train"), ("ok", "validation"), ("rejected", "train")]
    table = pd.DataFrame(rows, columns=["status", "split"])
    columns = ["id", "path", "sha256", "reason", "faces_in", "faces_out", "volume", "distance"]
    table.assign(**dict.fromkeys([*columns, "filled_share", "seconds"], "")).to_csv(catalogue, index=False)
    clouds = folder / "clouds" / "chair.npz"
    clouds.parent.mkdir()
    arrays = {"train": np.zeros((3, 4, 3), "f4"), "holdout": np.zeros((2, 4, 3), "f4")}
    np.savez(clouds, **arrays, train_ids=np.array(["a", "b", "c"]), holdout_ids=np.array(["d", "e"]))
    return folder


@pytest.fixture
def runtime(tmp_path, results, paper, write, read):
    """The table of some reports and benchmark files, by stage and model or grid."""

    def make(reports, files):
        for place, text in files.items():
            path = results / "benchmarks" / f"{place}.tsv"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(HEAD + text)
        tabulate_runtime(write(reports), results, paper, SHARDS, tmp_path / "runtime.csv")
        table, text = read(tmp_path / "runtime.csv")
        assert tuple(table.columns) == COLUMNS
        names = table["model"].where(table["model"] != "", table["grid"])
        return table.set_index([table["stage"], names]), text

    return make


def test_studies_stand_where_they_were_measured(runtime, report):
    files = {
        "simulate_samples/chair/tetgan-LR/0/paper": benchmark(30),
        "find_nearest_real/chair": benchmark(4),
        "measure_resolution": benchmark(5),
    }
    table, _ = runtime([report("chair", "tetgan-LR"), report("chair", "tetgan-HR")], files)
    assert table.loc[("simulate_samples", "tetgan-LR"), ["jobs", "seconds", "seconds_a_shape"]].tolist() == [
        *("1", "30.0", "")
    ]
    stages = set(table["stage"])
    assert ("simulate_samples", "tetgan-HR") not in table.index
    assert {"find_nearest_real", "measure_resolution"} <= stages
    assert not {"add_parts", "interpolate_shapes", "measure_smoothing", "find_nearest"} & stages


def test_shards_are_summed_and_divided_by_the_shapes(runtime, report):
    files = {
        "repair_shapes/chair/1-of-2": benchmark(6, rss=300, cpu=4),
        "repair_shapes/chair/2-of-2": benchmark(2, rss=200, cpu=1),
        "repair_shapes/chair/1-of-16": benchmark(1000),  # of a run that was cut otherwise
        "extract_fields/chair/LR/1-of-2": benchmark(2),
        "extract_fields/chair/LR/2-of-2": benchmark(1, rss=400),
        "sample_clouds/chair": benchmark(10),
    }
    table, text = runtime([report("chair", "tetgan-LR"), report("chair", "real")], files)
    columns = ["jobs", "jobs_measured", "shapes", "seconds", "seconds_a_shape", "cpu_seconds", "max_rss_mib"]
    assert list(table.loc[("repair_shapes", ""), columns]) == ["2", "2", "4", "8.0", "2.0", "5.0", "300.0"]
    assert list(table.loc[("extract_fields", "LR"), columns]) == ["2", "2", "3", "3.0", "1.0", "2.0", "400.0"]
    assert list(table.loc[("sample_clouds", ""), columns]) == ["1", "1", "5", "10.0", "2.0", "1.0", "100.0"]
    both = table.loc[("preprocess", "LR")]
    assert (both["seconds_a_shape"], both["max_rss_mib"]) == ("3.0", "400.0")
    assert both["paper"] == "1-2 seconds"
    assert "1-2 seconds" in text


def test_seeds_are_averaged_and_the_log_tells_the_time_of_training(runtime, report):
    files = {
        "train_model/chair/tetgan-LR/0": benchmark(10, rss=100),
        "train_model/chair/tetgan-LR/1": benchmark(20, rss=700),
        "sample_model/chair/tetgan-LR/0/paper": benchmark(30),
        "sample_model/chair/tetgan-LR/1/paper": benchmark(50),
    }
    table, text = runtime([report("chair", "tetgan-LR", seed) for seed in (0, 1)], files)
    trained = table.loc[("train_model", "tetgan-LR")]
    assert (trained["jobs"], trained["shapes"], trained["seconds"]) == ("2", "2", "15.0")
    assert trained["seconds_std"] == "7.07"  # the root of 50
    assert (trained["seconds_a_shape"], trained["max_rss_mib"], trained["train_minutes"]) == (
        "",
        "700.0",
        "3.0",
    )
    assert trained["paper"] == "approximately two days on two NVIDIA A40 GPUs"
    sampled = table.loc[("sample_model", "tetgan-LR")]
    # Eight generated and two reconstructed.
    assert (sampled["mode"], sampled["shapes"], sampled["seconds_a_shape"]) == ("paper", "10", "4.0")
    assert (sampled["train_minutes"], sampled["paper"]) == ("", "")
    assert "15 ± 7.07" in text


def test_the_paper_states_the_time_of_its_method_whatever_the_model_is_called(runtime, report):
    reports = [
        report("chair", "my-net", method="tetgan"),
        report("chair", "tetgan-like", method="pca"),
    ]
    table, _ = runtime(reports, {})
    printed = table.loc["train_model", "paper"]
    assert printed["my-net"] == "approximately two days on two NVIDIA A40 GPUs"
    assert printed["tetgan-like"] == ""


def test_a_missing_benchmark_leaves_its_row_empty(runtime, report):
    files = {"extract_fields/chair/LR/1-of-2": benchmark(2, rss=50)}
    table, text = runtime([report("chair", "tetgan-LR"), report("sofa", "tetgan-LR")], files)
    halved = table.loc[("extract_fields", "LR")].query("category == 'chair'").iloc[0]
    assert (halved["jobs"], halved["jobs_measured"], halved["max_rss_mib"]) == ("2", "1", "50.0")
    assert (halved["seconds"], halved["seconds_a_shape"], halved["cpu_seconds"]) == ("", "", "")
    # Nothing is known of sofas but that there is a model of them.
    sofa = table[(table["category"] == "sofa") & (table["stage"] != "train_model")]
    columns = ["seconds", "seconds_std", "seconds_a_shape", "cpu_seconds", "max_rss_mib"]
    assert set(sofa[columns].to_numpy().ravel()) == {""}
    assert set(sofa["jobs_measured"]) == {"0", ""}
    assert "1 of 2" in text


def test_a_job_too_short_to_measure_is_no_zero(runtime, report):
    files = {
        "train_extractor": benchmark(0.4, rss="NA", cpu="NA"),
        "evaluate_real/chair": benchmark(1, "-", "-"),
    }
    table, _ = runtime([report("chair", "real")], files)
    for stage in ("train_extractor", "evaluate_real"):
        row = table.loc[(stage, "")]
        assert (row["max_rss_mib"], row["cpu_seconds"]) == ("", "")
    assert table.loc[("train_extractor", ""), "seconds"] == "0.4"


def test_repeats_of_a_benchmark_are_averaged(runtime, report):
    table, _ = runtime([report("chair", "real")], {"train_extractor": benchmark(2) + benchmark(4)})
    assert table.loc[("train_extractor", ""), "seconds"] == "3.0"


def test_models_without_a_grid_and_ground_truth_have_the_rows_that_are_theirs(runtime, report):
    table, _ = runtime([report("chair", "occnet") | {"grid": None}, report("chair", "representation-LR")], {})
    further = {"extract_samplings", "simplify_samples"}  # nothing here needs them
    stages = [stage for place in BENCHMARKS if (stage := place.split("/")[0]) not in further]
    assert list(dict.fromkeys(table["stage"])) == [*stages, "preprocess"]
    assert list(table.loc["extract_fields"].index) == ["LR"]
    assert set(table.loc["train_model"].index) == {"occnet", "representation-LR"}
    assert table.loc[("train_model", "representation-LR"), "train_minutes"] == ""


def test_implicit_models_have_samplings_and_simplified_ones_are_not_trained(runtime, report):
    own = {"grid": None, "sampling": "points"}
    implicit = report("chair", "occnet") | own
    simplified = report("chair", "occnet-simplified") | own | {"simplified": True}
    files = {
        "extract_samplings/chair/points/1-of-2": benchmark(2),
        "extract_samplings/chair/points/2-of-2": benchmark(4),
        "simplify_samples/chair/occnet-simplified/0/paper": benchmark(5),
    }
    table, text = runtime([implicit, simplified], files)
    drawn = table[table["sampling"] == "points"]
    assert drawn[["stage", "shapes", "seconds_a_shape"]].to_numpy().tolist() == [
        ["extract_samplings", "3", "2.0"]
    ]
    assert list(table.loc["train_model"].index) == list(table.loc["sample_model"].index) == ["occnet"]
    assert table.loc[("simplify_samples", "occnet-simplified"), "seconds_a_shape"] == "0.5"
    assert "| points" in text


def test_a_file_that_is_no_benchmark_is_named(runtime, report, results):
    path = results / "benchmarks" / "train_extractor.tsv"
    path.parent.mkdir()
    path.write_text("nonsense\n1\n")
    with pytest.raises(UserError, match=r"train_extractor\.tsv: not a benchmark"):
        runtime([report("chair", "real")], {})
