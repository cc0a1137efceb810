"""Validation of the config, and the helpers that rules share."""

import json
import os
import shlex
import sys
from functools import cache
from pathlib import Path

from tetgan import code
from tetgan.config import Config, load_config
from tetgan.errors import UserError
from tetgan.models.registry import method_of

try:
    config.update(load_config(config))
except UserError as error:
    sys.exit(f"error: {error}")

SETTINGS = Config.parse(config)
# The commands and scripts of all jobs inherit it.
os.environ.update(TETGAN_PLUGINS=" ".join(SETTINGS.plugins))
RESULTS = f"results/{config['run']}" if config["run"] else "results"
WORKFLOW = Path(workflow.current_basedir.get_path_or_uri(secret_free=True)).parent
SHOWN_MODELS = [
    name for name in SETTINGS.table_models if SETTINGS.models[name].kind == "tetgan"
]
METHODS = {name: method_of(model) for name, model in SETTINGS.models.items()}
TRAINED = [name for name, method in METHODS.items() if method.trained]
SIMPLIFIED = [name for name in METHODS if name not in TRAINED]


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
LOGGED_MODELS = [name for name in SETTINGS.table_models if METHODS[name].logged]

# Those of the ablation that are trained: some take over the weights of another and mesh differently.
ABLATED_MODELS = [
    name for name in config["ablation"] if SETTINGS.trained_as(name) == name
]

# Every table and figure of the target `paper`: each file of rules adds its own.
PAPER_TARGETS = []


cached_digest = cache(code.code_digest)


def code_digest(*entry_points, of_model=False):
    """Parameter of a job: digest of the code behind it, as Snakemake cannot see inside a command.

    So an edited module makes the jobs run again that import it, and no others.

    Args:
        entry_points: `module:function`, or the name of a script.
        of_model: add the code of the method of the job's model, and of the model under it.
    """
    stages = [
        WORKFLOW / "scripts" / name if name.endswith(".py") else name
        for name in entry_points
    ]

    def digest(wildcards):
        methods = methods_behind(wildcards.model) if of_model else []
        return cached_digest(
            *stages,
            *sorted({name for method in methods for name in method.entry_points}),
        )

    return digest


def methods_behind(model):
    """The method of a model, and that of the model under it."""
    under = SETTINGS.models[model].of if METHODS[model].of else None
    return [METHODS[name] for name in (model, under) if name]


def figure(name, title=None):
    """Outputs of a figure: the picture, which the report shows, and the data behind it."""
    return {
        "picture": report(
            f"<results>/figures/{{category}}/{name}.png",
            caption=f"../report/{name}.rst",
            category="Figures",
            labels={"category": "{category}", "figure": title or name},
        ),
        "data": f"<results>/figures/{{category}}/{name}.csv",
    }


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
    if METHODS[wildcards.model].sampling is None:
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
    if METHODS[wildcards.model].of:
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
