"""Every shipped config plans its `paper` target, with nothing there yet; profiles name rules that exist."""

import re

import pytest
import yaml
from smoke_project import ROOT, planned

CONFIGS = sorted(path.name for path in (ROOT / "config").glob("*.yaml"))
PROFILES = sorted((ROOT / "workflow" / "profiles").glob("*/config.yaml"))


def rule_names() -> set[str]:
    files = [ROOT / "workflow" / "Snakefile", *(ROOT / "workflow" / "rules").glob("*.smk")]
    named = re.compile(r"^ *(?:rule|use rule \w+ as) (\w+)(?::| with:)", re.MULTILINE)
    return {name for path in files for name in named.findall(path.read_text())}


@pytest.mark.parametrize("name", CONFIGS)
def test_a_config_plans_everything_it_holds(untouched, name):
    # ShapeNet and COSEG need not be there: what is missing shows when its repair runs.
    jobs = planned(untouched.snakemake("-n", "paper", "--configfile", f"config/{name}"))
    held = yaml.safe_load((ROOT / "config" / name).read_text()).get("categories", ["chair"])
    assert jobs["tabulate_category"] == jobs["draw_samples"] == jobs["evaluate_real"] == len(held)
    assert jobs["tabulate_supplement"] == 3
    for table in ("manifold", "quality", "dataset", "runtime"):
        assert jobs[f"tabulate_{table}"] == 1


def test_the_smoke_run_has_every_rule(untouched):
    jobs = planned(untouched.smoke("-n", "paper", "results/smoke/report.html"))
    assert rule_names() - {"all", "figures", "draw"} <= jobs.keys()


@pytest.mark.parametrize("name", ["overnight.yaml", "paper.yaml"])
def test_the_large_configs_hold_all_six_categories(name):
    config = yaml.safe_load((ROOT / "config" / name).read_text())
    assert set(config["categories"]) == {"chair", "sofa", "bench", "table", "car", "vase"}


def test_a_source_that_is_not_there_is_named_in_one_line(untouched):
    job = "results/paper/data/chair/1-of-64.zip"
    result = untouched.snakemake(job, "--configfile", "config/paper.yaml")
    assert result.returncode != 0
    log = untouched.folder / "results/paper/logs/repair_shapes/chair/1-of-64.log"
    assert log.read_text().splitlines() == ["error: sources.chair.path: no folder ShapeNetCore.v2"]


@pytest.mark.parametrize("path", PROFILES, ids=lambda path: path.parent.name)
def test_a_profile_names_rules_that_exist(path):
    profile = yaml.safe_load(path.read_text())
    named = {*profile.get("set-resources", {}), *profile.get("set-threads", {})}
    assert named <= rule_names()


def test_the_cluster_profile_gives_a_gpu_to_every_rule_that_trains():
    profile = yaml.safe_load((ROOT / "workflow/profiles/slurm/config.yaml").read_text())
    assert profile["executor"] == "slurm"
    given = {rule for rule, resources in profile["set-resources"].items() if resources.get("gpu")}
    assert {name for name in rule_names() if name.startswith("train_")} <= given


@pytest.mark.parametrize("granted", [0, 4])
def test_every_gpu_granted_is_a_process_of_the_training(untouched, granted):
    weights = "results/smoke/models/chair/tetgan-LR/0/weights.safetensors"
    result = untouched.smoke("-n", "-p", weights, "--set-resources", f"train_model:gpu={granted}")
    assert planned(result)["train_model"] == 1
    assert f" --processes {granted} " in result.stdout


@pytest.mark.parametrize("path", PROFILES, ids=lambda path: path.parent.name)
def test_a_profile_plans_the_smoke_run(path, untouched, tmp_path):
    # Without its executor, which is a plugin that need not be installed here.
    profile = {key: value for key, value in yaml.safe_load(path.read_text()).items() if key != "executor"}
    (tmp_path / "config.yaml").write_text(yaml.safe_dump(profile))
    jobs = planned(untouched.smoke("-n", "paper", "--workflow-profile", str(tmp_path)))
    assert jobs["train_extractor"] == 1
