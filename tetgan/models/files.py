"""Build models from their options; read and write the folder of a trained one."""

import json
from pathlib import Path
from typing import Any

import torch
from safetensors import SafetensorError
from safetensors.torch import load_file, save_file
from torch import Tensor

from tetgan.errors import UserError
from tetgan.files import whole_file
from tetgan.grids.hierarchy import GridHierarchy
from tetgan.models.generator import FieldGenerator, LatentModel, SurfaceModel
from tetgan.models.method import MethodOptions
from tetgan.models.registry import ModelOptions, method_of
from tetgan.nn.device import device_name
from tetgan.options import parse_options

OPTIONS, WEIGHTS = "options.json", "weights.safetensors"

CPU = torch.device("cpu")


def build_generator(
    options: MethodOptions, hierarchy: GridHierarchy, of: FieldGenerator | None = None
) -> FieldGenerator:
    """An untrained model of fields; its weights are drawn from PyTorch's global generator.

    Args:
        of: the model that this one is built on, as a DefTet on a TetGAN.
    """
    under = [] if of is None else [of]
    model = method_of(options).load("build")(options, hierarchy, *under)
    assert isinstance(model, FieldGenerator), f"{options.kind}: no model of fields"
    return model


def build_surface_model(options: MethodOptions) -> SurfaceModel:
    """An untrained model of implicit surfaces; its weights are drawn from PyTorch's global generator."""
    model = method_of(options).load("build")(options)
    assert isinstance(model, SurfaceModel), f"{options.kind}: no model of implicit surfaces"
    return model


def save_generator(
    folder: Path,
    generator: LatentModel,
    options: MethodOptions,
    hierarchy: GridHierarchy | None = None,
    **further: Any,
) -> None:
    """Write `options.json` (the model's, digest of its grid, device, all `further`) and the weights.

    Of a model built on another, `of` holds `model` of that one's `options.json`, and `of` if it is built on a
    third; the weights hold all of them.
    """
    grid = {"grid_digest": hierarchy.digest} if hierarchy else {}
    state = generator.state_dict()
    device = next((value.device for value in state.values()), CPU)
    record = {
        "model": options.model_dump(mode="json"),
        **grid,
        "device": device_name(device),
        **further,
    }
    with whole_file(folder / OPTIONS) as partial:
        partial.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
    weights = {name: value.detach().cpu().contiguous() for name, value in state.items()}
    with whole_file(folder / WEIGHTS) as partial:
        save_file(weights, partial)


def load_record(folder: Path) -> dict[str, Any]:
    """What the `options.json` of a trained model says.

    Raises:
        UserError: the folder holds no whole model.
    """
    return _read_model(folder)[0]


def load_options(folder: Path) -> MethodOptions:
    """The options of the trained model of a folder.

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
    if method_of(options).sampling is not None:
        raise UserError(f"{folder}: a model of kind {options.kind}, which has no fields")
    if record.get("grid_digest") != hierarchy.digest:
        raise UserError(f"{folder}: trained on another grid; use the fields it was trained on")
    generator = _rebuild(record, hierarchy, folder)
    generator.load_state_dict(weights)
    return generator.eval()


def _rebuild(record: dict[str, Any], hierarchy: GridHierarchy, folder: Path) -> FieldGenerator:
    """The untrained model of a record, on those that it is built on."""
    options = parse_options(ModelOptions, record.get("model", {}), str(folder / OPTIONS))
    of = _rebuild(record["of"], hierarchy, folder) if "of" in record else None
    return build_generator(options, hierarchy, of)


def load_surface_model(folder: Path) -> SurfaceModel:
    """The trained model of implicit surfaces of a folder, on the CPU and ready to decode.

    Raises:
        UserError: the folder holds no whole model, or one of fields.
    """
    _, options, weights = _read_model(folder)
    if method_of(options).sampling is None:
        raise UserError(f"{folder}: a model of kind {options.kind}, not of implicit surfaces")
    model = build_surface_model(options)
    model.load_state_dict(weights)
    return model.eval()


def _read_model(folder: Path) -> tuple[dict[str, Any], MethodOptions, dict[str, Tensor]]:
    """What `options.json` says, the model's options in it, and the weights."""
    try:
        record = json.loads((folder / OPTIONS).read_text(encoding="utf-8"))
        options = parse_options(ModelOptions, record["model"], str(folder / OPTIONS))
        return record, options, load_file(folder / WEIGHTS)
    except (OSError, ValueError, KeyError, SafetensorError) as error:
        raise UserError(f"{folder}: not a trained model ({error}); train it first") from None
