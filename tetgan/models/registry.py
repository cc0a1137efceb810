"""Models by their options, and the folder that holds a trained one."""

import json
from pathlib import Path
from typing import Any

from safetensors import SafetensorError
from safetensors.torch import load_file, save_file

from tetgan.errors import UserError
from tetgan.files import whole_file
from tetgan.grids.hierarchy import GridHierarchy
from tetgan.models.baselines.pca import PcaGenerator
from tetgan.models.baselines.representation import RepresentationGenerator
from tetgan.models.generator import FieldGenerator
from tetgan.models.options import ModelOptions, PcaOptions, TetganOptions
from tetgan.models.tetgan import TetganGenerator
from tetgan.options import parse_options

OPTIONS, WEIGHTS = "options.json", "weights.safetensors"


def build_generator(
    options: ModelOptions,  # type: ignore[valid-type]
    hierarchy: GridHierarchy,
) -> FieldGenerator:
    """An untrained model; its weights are drawn from PyTorch's global generator."""
    if isinstance(options, TetganOptions):
        return TetganGenerator(options, hierarchy)
    if isinstance(options, PcaOptions):
        return PcaGenerator(options, hierarchy)
    return RepresentationGenerator(options, hierarchy)


def save_generator(
    folder: Path,
    generator: FieldGenerator,
    options: ModelOptions,  # type: ignore[valid-type]
    hierarchy: GridHierarchy,
    **further: Any,
) -> None:
    """Write `options.json` (the model's, the grid's digest and whatever else is told) and the weights."""
    record = {"model": options.model_dump(mode="json"), "grid_digest": hierarchy.digest, **further}
    with whole_file(folder / OPTIONS) as partial:
        partial.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
    weights = {name: value.detach().cpu().contiguous() for name, value in generator.state_dict().items()}
    with whole_file(folder / WEIGHTS) as partial:
        save_file(weights, partial)


def load_generator(folder: Path, hierarchy: GridHierarchy) -> FieldGenerator:
    """The trained model of a folder, on the CPU and ready to decode.

    Raises:
        UserError: the folder holds no whole model, or one of another grid.
    """
    try:
        record = json.loads((folder / OPTIONS).read_text(encoding="utf-8"))
        options = parse_options(ModelOptions, record["model"], str(folder / OPTIONS))
        weights = load_file(folder / WEIGHTS)
    except (OSError, ValueError, KeyError, SafetensorError) as error:
        raise UserError(f"{folder}: not a trained model ({error}); train it first") from None
    if record.get("grid_digest") != hierarchy.digest:
        raise UserError(f"{folder}: trained on another grid; use the fields it was trained on")
    generator = build_generator(options, hierarchy)
    generator.load_state_dict(weights)
    return generator.eval()
