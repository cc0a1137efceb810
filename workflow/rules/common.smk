"""Validation of the config, and the helpers that rules share."""

import hashlib
import json
import sys
from importlib.util import find_spec
from pathlib import Path

from tetgan.config import Config, load_config
from tetgan.errors import UserError

try:
    config.update(load_config(config))
except UserError as error:
    sys.exit(f"error: {error}")

SETTINGS = Config.parse(config)
RESULTS = f"results/{config['run']}" if config["run"] else "results"
CAPTIONS = (
    Path(workflow.current_basedir.get_path_or_uri(secret_free=True)).parent / "report"
)
SOURCES = {".py", ".html", ".css", ".js"}
SHOWN_MODELS = [
    name for name, model in SETTINGS.models.items() if model.kind == "tetgan"
]


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


def section(*keys):
    """Parameter of a job: the part of the config at `keys` as JSON; a key in braces is a wildcard."""

    def lookup(wildcards):
        part = config
        for key in keys:
            part = part[key.format(**wildcards)]
        return json.dumps(part)

    return lookup


def training_options(wildcards):
    return SETTINGS.training_of(wildcards.model).model_dump_json()


def identity(wildcards):
    """What a row of the table says of its model, beside the metrics."""
    model = SETTINGS.models[wildcards.model]
    return json.dumps(
        {
            "category": wildcards.category,
            "model": wildcards.model,
            "grid": model.grid,
            "mode": wildcards.mode,
            "seed": int(wildcards.seed),
            "reduced": SETTINGS.reductions(wildcards.model),
        }
    )


def model_fields(wildcards):
    """Index and shards of the fields that a model learns from."""
    folder = (
        f"<results>/fields/{wildcards.category}/{SETTINGS.models[wildcards.model].grid}"
    )
    return {
        "index": f"{folder}/index.json",
        "shards": [
            f"{folder}/{part}-of-{config['shards']}.zarr.zip"
            for part in shard_numbers()
        ],
    }


def shard_numbers():
    return range(1, config["shards"] + 1)


def fields_mem_mb(wildcards, attempt):
    """Memory of one extraction: the hierarchy and one shape's queries; a coarse bound."""
    grid = SETTINGS.grids[wildcards.grid]
    tets = 24 * (grid.cells or 4) ** 3 * 8**grid.depth
    return attempt * (600 + tets // 200)


def training_threads(wildcards):
    """Cores of one training: models train side by side, as a second core speeds one up by a sixth only."""
    return max(1, (workflow.cores or 1) // max(1, len(SHOWN_MODELS)))


def training_mem_mb(wildcards, attempt):
    """Memory of one training run: a bound for laptop sizes, more at each retry; paper sizes need a profile."""
    return attempt * 4000
