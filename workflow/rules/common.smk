"""Validation of the config, and the helpers that rules share."""

import hashlib
import json
import os
import shlex
import sys
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from tetgan.code import code_digest
from tetgan.config import Config, load_config
from tetgan.errors import UserError
from tetgan.models.kinds import kind_of

try:
    config.update(load_config(config))
except UserError as error:
    sys.exit(f"error: {error}")

SETTINGS = Config.parse(config)
# The commands and scripts of all jobs inherit it.
os.environ.update(TETGAN_PLUGINS=" ".join(SETTINGS.plugins))
RESULTS = f"results/{config['run']}" if config["run"] else "results"
CAPTIONS = (
    Path(workflow.current_basedir.get_path_or_uri(secret_free=True)).parent / "report"
)
SOURCES = {".py", ".html", ".css", ".js"}
SHOWN_MODELS = [
    name for name in SETTINGS.table_models if SETTINGS.models[name].kind == "tetgan"
]
KINDS = {name: kind_of(model) for name, model in SETTINGS.models.items()}
TRAINED = [name for name, kind in KINDS.items() if kind.trained]
SIMPLIFIED = [name for name in KINDS if name not in TRAINED]


SAMPLING_MODULES = [
    f"fields/{name}" for name in ("arrays", "dataset", "points", "samplings", "voxels")
]


def each_mode(pattern, models, modes=None, seeds=config["seeds"]):
    """Paths of each model in each of its modes, or in those that `modes` gives for it."""
    return [
        path
        for model in models
        for path in expand(
            pattern,
            model=model,
            seed=seeds,
            mode=modes(model) if modes else SETTINGS.modes_of(model),
        )
    ]


def one_of(names):
    """Constraint of a wildcard; with no names nothing matches."""
    return "|".join(names) or "(?!)"


FIGURE_MODELS = SETTINGS.figures.models or SHOWN_MODELS
LOGGED_MODELS = [name for name in SETTINGS.table_models if KINDS[name].logged]

# Those of the ablation that are trained: some take over the weights of another and mesh differently.
ABLATED_MODELS = [
    name for name in config["ablation"] if SETTINGS.trained_as(name) == name
]

# What a simulation is made of.
SIMULATION = [
    *("meshing/reading", "meshing/orientation", "meshing/connectivity"),
    *("studies/elasticity", "studies/simulation", "studies/simulation_study"),
]

# Every table and figure of the target `paper`: each file of rules adds its own.
PAPER_TARGETS = []


def stage_digest(*rooms):
    """Digest of the modules behind a stage: editing one of them makes the stage run again.

    Snakemake cannot see inside a command, so each stage carries this as a parameter.
    """
    package = Path(find_spec("tetgan").origin).parent
    digest = hashlib.sha256()
    for room in rooms:
        found = package / room
        sources = [
            path for path in sorted(found.rglob("*.*")) if path.suffix in SOURCES
        ] or [found.with_suffix(".py")]
        for source in sources:
            name = source.relative_to(package).as_posix()
            digest.update(name.encode() + source.read_bytes())
    return digest.hexdigest()[:12]


def model_code(stage, *rooms):
    """Parameter of a job: digest of the module of a stage and of a model's kind, and of what they import in some rooms.

    So editing one kind of model leaves what was made of the others alone.
    """

    @cache
    def digest(model):
        return code_digest([stage, *KINDS[model].modules], rooms)

    return lambda wildcards: digest(wildcards.model)


def section(*keys):
    """Parameter of a job: the part of the config at `keys` as JSON; a key in braces is a wildcard."""

    def lookup(wildcards):
        part = config
        for key in keys:
            part = part[key.format(**wildcards)]
        return json.dumps(part)

    return lookup


def model_options(wildcards):
    """What a model is built from. How it is meshed plays no part in its training."""
    options = SETTINGS.models[wildcards.model]
    return options.model_dump_json(exclude={"training", "meshing"})


def training_options(wildcards):
    return SETTINGS.training_of(wildcards.model).model_dump_json()


def meshing_options(wildcards):
    return SETTINGS.meshing_of(wildcards.model).model_dump_json()


def identity(wildcards):
    """What a row of the table says of its model, beside the metrics; the samples name the method."""
    model = SETTINGS.models[wildcards.model]
    return json.dumps(
        {
            "category": wildcards.category,
            "model": wildcards.model,
            "grid": getattr(model, "grid", ""),
            "sampling": getattr(model, "sampling", None),
            "mode": wildcards.mode,
            "seed": int(wildcards.seed),
            "simplified": wildcards.model in SIMPLIFIED,
            "reduced": SETTINGS.reductions(wildcards.model),
            "without": SETTINGS.without(wildcards.model),
        }
    )


def ablation_changes(wildcards):
    """How each model of the ablation differs from the full one, in words."""
    return json.dumps(
        {name: SETTINGS.changes(name) for name in SETTINGS.ablation}, ensure_ascii=False
    )


def study_identity(wildcards):
    """What the rows of a study say of the model whose fields or samples it took."""
    return json.dumps({**wildcards, "grid": SETTINGS.models[wildcards.model].grid})


def model_fields(wildcards):
    """Index and shards of the fields, or of the points or voxels, that a model learns from."""
    model = SETTINGS.models[wildcards.model]
    if KINDS[wildcards.model].sampling is None:
        folder = f"<results>/fields/{wildcards.category}/{model.grid}"
    else:
        folder = f"<results>/samplings/{wildcards.category}/{model.sampling}"
    return {
        "index": f"{folder}/index.json",
        "shards": [
            f"{folder}/{part}-of-{config['shards']}.zarr.zip"
            for part in shard_numbers()
        ],
    }


def trained_model(wildcards, model=None):
    """Weights and options of a model, which are another's where only the meshing differs."""
    name = SETTINGS.trained_as(model or wildcards.model)
    folder = f"<results>/models/{wildcards.category}/{name}/{wildcards.seed}"
    return {
        "weights": f"{folder}/weights.safetensors",
        "options": f"{folder}/options.json",
    }


def training_inputs(wildcards):
    """Fields, and for a model built on another, as DefTet is, the weights of that one."""
    inputs = model_fields(wildcards)
    if KINDS[wildcards.model].of:
        of = SETTINGS.models[wildcards.model].of
        inputs["of"] = trained_model(wildcards, of)["weights"]
    return inputs


def standing_on(wildcards, input):
    """Option that names the model under another one."""
    return (
        f"--of {shlex.quote(str(Path(input.of).parent))}"
        if "of" in input.keys()
        else ""
    )


def simplified_samples(wildcards):
    """Samples of the model that a simplified one is made from."""
    of = SETTINGS.models[wildcards.model].of
    return (
        f"<results>/samples/{wildcards.category}/{of}/{wildcards.seed}/{wildcards.mode}"
    )


def shard_numbers():
    return range(1, config["shards"] + 1)


def fields_mem_mb(wildcards, attempt):
    """Memory of one extraction: the hierarchy and one shape's queries; a coarse bound."""
    grid = SETTINGS.grids[wildcards.grid]
    tets = 24 * (grid.cells or 4) ** 3 * 8**grid.depth
    return attempt * (600 + tets // 200)


def training_threads(wildcards):
    """Cores of one training: several run side by side, as a second core speeds one up by a sixth only."""
    return max(1, (workflow.cores or 1) // max(1, len(SHOWN_MODELS)))


def training_mem_mb(wildcards, attempt):
    """Memory of one training run: the default's largest takes 1.4 GiB; paper sizes need a profile."""
    return attempt * 2500
