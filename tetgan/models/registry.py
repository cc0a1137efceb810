"""Models by their options, and the folder that holds a trained one."""

import json
from pathlib import Path
from typing import Any

from safetensors import SafetensorError
from safetensors.torch import load_file, save_file
from torch import Tensor

from tetgan.errors import UserError
from tetgan.files import whole_file
from tetgan.grids.hierarchy import GridHierarchy
from tetgan.models.baselines.deftet import DeftetGenerator
from tetgan.models.baselines.implicit import SurfaceModel
from tetgan.models.baselines.occnet import OccNetGenerator
from tetgan.models.baselines.pca import PcaGenerator
from tetgan.models.baselines.representation import RepresentationGenerator
from tetgan.models.baselines.shapegan import ShapeGanGenerator
from tetgan.models.baselines.shapegan_vae import ShapeGanVae
from tetgan.models.generator import FieldGenerator, LatentModel
from tetgan.models.options import (
    DeftetOptions,
    ImplicitOptions,
    ModelOptions,
    OccNetOptions,
    PcaOptions,
    RepresentationOptions,
    ShapeGanOptions,
    TetganOptions,
)
from tetgan.models.tetgan import TetganGenerator
from tetgan.options import parse_options

OPTIONS, WEIGHTS = "options.json", "weights.safetensors"


def build_generator(
    options: ModelOptions,  # type: ignore[valid-type]
    hierarchy: GridHierarchy,
    of: TetganOptions | None = None,
) -> FieldGenerator:
    """An untrained model of fields; its weights are drawn from PyTorch's global generator.

    Args:
        of: the model that a DefTet moves the boundary of.
    """
    if isinstance(options, TetganOptions):
        return TetganGenerator(options, hierarchy)
    if isinstance(options, DeftetOptions):
        assert of is not None
        return DeftetGenerator(options, hierarchy, TetganGenerator(of, hierarchy))
    if isinstance(options, PcaOptions):
        return PcaGenerator(options, hierarchy)
    assert isinstance(options, RepresentationOptions), "no model of fields"
    return RepresentationGenerator(options, hierarchy)


def build_surface_model(options: ImplicitOptions) -> SurfaceModel:
    """An untrained model of implicit surfaces; its weights are drawn from PyTorch's global generator."""
    if isinstance(options, OccNetOptions):
        return OccNetGenerator(options)
    if isinstance(options, ShapeGanOptions):
        return ShapeGanGenerator(options)
    return ShapeGanVae(options)


def save_generator(
    folder: Path,
    generator: LatentModel,
    options: ModelOptions,  # type: ignore[valid-type]
    hierarchy: GridHierarchy | None = None,
    **further: Any,
) -> None:
    """Write `options.json` (the model's, its grid's digest and whatever else is told) and the weights.

    A model that stands on another tells that one's options as `of`; the weights hold both.
    """
    grid = {"grid_digest": hierarchy.digest} if hierarchy else {}
    record = {"model": options.model_dump(mode="json"), **grid, **further}
    with whole_file(folder / OPTIONS) as partial:
        partial.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
    weights = {name: value.detach().cpu().contiguous() for name, value in generator.state_dict().items()}
    with whole_file(folder / WEIGHTS) as partial:
        save_file(weights, partial)


def load_options(folder: Path) -> Any:
    """The options (`ModelOptions`) of the trained model of a folder.

    Raises:
        UserError: the folder holds no whole model.
    """
    return _read_model(folder)[1]


def load_generator(folder: Path, hierarchy: GridHierarchy) -> FieldGenerator:
    """The trained model of fields of a folder, on the CPU and ready to decode.

    Raises:
        UserError: the folder holds no whole model, or one of another grid.
    """
    record, options, weights = _read_model(folder)
    if isinstance(options, ImplicitOptions):
        raise UserError(f"{folder}: a model of kind {options.kind}, which has no fields")
    if record.get("grid_digest") != hierarchy.digest:
        raise UserError(f"{folder}: trained on another grid; use the fields it was trained on")
    of = parse_options(TetganOptions, record["of"], str(folder / OPTIONS)) if "of" in record else None
    generator = build_generator(options, hierarchy, of)
    generator.load_state_dict(weights)
    return generator.eval()


def load_surface_model(folder: Path) -> SurfaceModel:
    """The trained model of implicit surfaces of a folder, on the CPU and ready to decode.

    Raises:
        UserError: the folder holds no whole model, or one of fields.
    """
    _, options, weights = _read_model(folder)
    if not isinstance(options, ImplicitOptions):
        raise UserError(f"{folder}: a model of kind {options.kind}, not of implicit surfaces")
    model = build_surface_model(options)
    model.load_state_dict(weights)
    return model.eval()


def _read_model(folder: Path) -> tuple[dict[str, Any], Any, dict[str, Tensor]]:
    """What `options.json` says, the model's options in it, and the weights."""
    try:
        record = json.loads((folder / OPTIONS).read_text(encoding="utf-8"))
        options = parse_options(ModelOptions, record["model"], str(folder / OPTIONS))
        return record, options, load_file(folder / WEIGHTS)
    except (OSError, ValueError, KeyError, SafetensorError) as error:
        raise UserError(f"{folder}: not a trained model ({error}); train it first") from None
