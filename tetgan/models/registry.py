"""Models by their options, and the folder that holds a trained one."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from safetensors import SafetensorError
from safetensors.torch import load_file, save_file

from tetgan.errors import UserError
from tetgan.files import whole_file
from tetgan.grids.hierarchy import GridHierarchy
from tetgan.models.baselines.deftet import DeftetGenerator
from tetgan.models.baselines.pca import PcaGenerator
from tetgan.models.baselines.representation import RepresentationGenerator
from tetgan.models.generator import FieldGenerator
from tetgan.models.options import DeftetOptions, ModelOptions, PcaOptions, TetganOptions
from tetgan.models.tetgan import TetganGenerator
from tetgan.options import parse_options

OPTIONS, WEIGHTS = "options.json", "weights.safetensors"


def build_generator(
    options: ModelOptions,  # type: ignore[valid-type]
    hierarchy: GridHierarchy,
    of: TetganOptions | None = None,
) -> FieldGenerator:
    """An untrained model; its weights are drawn from PyTorch's global generator.

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
    return RepresentationGenerator(options, hierarchy)


def save_generator(
    folder: Path,
    generator: FieldGenerator,
    options: ModelOptions,  # type: ignore[valid-type]
    hierarchy: GridHierarchy,
    **further: Any,
) -> None:
    """Write `options.json` (the model's, the grid's digest and whatever else is told) and the weights.

    A model that stands on another tells that one's options as `of`; the weights hold both.
    """
    record = {"model": options.model_dump(mode="json"), "grid_digest": hierarchy.digest, **further}
    with whole_file(folder / OPTIONS) as partial:
        partial.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
    weights = {name: value.detach().cpu().contiguous() for name, value in generator.state_dict().items()}
    with whole_file(folder / WEIGHTS) as partial:
        save_file(weights, partial)


def load_options(folder: Path) -> ModelOptions:  # type: ignore[valid-type]
    """The options that the trained model of a folder was built with.

    Raises:
        UserError: the folder holds no model.
    """
    with _a_model(folder):
        return parse_options(ModelOptions, _read_record(folder)["model"], str(folder / OPTIONS))


def load_generator(folder: Path, hierarchy: GridHierarchy) -> FieldGenerator:
    """The trained model of a folder, on the CPU and ready to decode.

    Raises:
        UserError: the folder holds no whole model, or one of another grid.
    """
    options, of = load_options(folder), None
    with _a_model(folder):
        record = _read_record(folder)
        if "of" in record:
            of = parse_options(TetganOptions, record["of"], str(folder / OPTIONS))
        weights = load_file(folder / WEIGHTS)
    if record.get("grid_digest") != hierarchy.digest:
        raise UserError(f"{folder}: trained on another grid; use the fields it was trained on")
    generator = build_generator(options, hierarchy, of)
    generator.load_state_dict(weights)
    return generator.eval()


def _read_record(folder: Path) -> dict[str, Any]:
    return json.loads((folder / OPTIONS).read_text(encoding="utf-8"))


@contextmanager
def _a_model(folder: Path) -> Iterator[None]:
    try:
        yield
    except (OSError, ValueError, KeyError, SafetensorError) as error:
        raise UserError(f"{folder}: not a trained model ({error}); train it first") from None
