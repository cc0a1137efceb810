"""Trained models packed into small folders that need no fields, and the pretrained ones of this package."""

import shutil
from pathlib import Path

import torch
from safetensors.torch import load_file, save_file

from tetgan.errors import UserError
from tetgan.fields.store import FieldStore
from tetgan.files import whole_folder
from tetgan.models.files import OPTIONS, WEIGHTS, load_generator, load_options

INDEX = "index.json"

PRETRAINED = Path(__file__).parent / "pretrained"


def pack_model(model: Path, index: Path, folder: Path) -> None:
    """Write the options, the weights in half precision, and an index of fields that lists no shape.

    Args:
        model: folder of a trained model of fields.
        index: of the fields that it was trained on.
        folder: a new one.

    Raises:
        UserError: no trained model, one of other fields, one that is nothing without its shapes, or a folder
            that is there already.
    """
    if folder.exists():
        raise UserError(f"{folder}: is there already; name a new folder")
    store = FieldStore.open(index)
    if load_options(model).kind == "representation":
        raise UserError(f"{model}: a representation has no weights; its fields are all there is of it")
    load_generator(model, store.hierarchy)  # it fits the fields, and all of it is there
    weights = {name: value.half() for name, value in load_file(model / WEIGHTS).items()}
    if not all(torch.isfinite(value).all() for value in weights.values()):
        raise UserError(f"{model}: a weight is too large for half precision")
    with whole_folder(folder, INDEX) as partial:
        shutil.copyfile(model / OPTIONS, partial / OPTIONS)
        save_file(weights, partial / WEIGHTS)
        store.write_without_shapes(partial / INDEX)


def find_model(name: Path) -> Path:
    """The folder of that name, or else the pretrained model of that name.

    Raises:
        UserError: neither is there.
    """
    pretrained = PRETRAINED / name.name
    if name.is_dir():
        return name
    if len(name.parts) == 1 and (pretrained / OPTIONS).is_file():
        return pretrained
    known = ", ".join(sorted(path.parent.name for path in PRETRAINED.glob(f"*/{OPTIONS}")))
    raise UserError(f"{name}: no folder of a trained model, and no pretrained one (there are: {known})")


def index_beside(model: Path) -> Path:
    """The index that a packed model brings along.

    Raises:
        UserError: it has none.
    """
    if not (model / INDEX).is_file():
        raise UserError(
            f"{model}: not packed; name with --index the fields, points or voxels it learned from"
        )
    return model / INDEX
