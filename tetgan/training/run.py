"""Stage: fields, points or voxels in, a trained model out."""

from pathlib import Path

from tetgan.errors import UserError
from tetgan.models.method import MethodOptions
from tetgan.models.registry import method_of
from tetgan.options import Options
from tetgan.training.processes import launched_together


def train_model(
    index: Path,
    options: MethodOptions,
    training: Options,
    seed: int,
    out_folder: Path,
    *,
    of: Path | None = None,
) -> None:
    """Train a model on the training split of an index, in the way of its kind.

    Args:
        index: `index.json` of the fields, points or voxels.
        training: of the class that goes with the model's kind.
        out_folder: receives `options.json` and `weights.safetensors`; where there are steps to take also
            `log.csv`, `events/` for TensorBoard, and `checkpoint.pt`, from which a killed run goes on.
        of: folder of the trained model that this one is built on, as a DefTet is on a TetGAN.

    Raises:
        UserError: the index is no such data, or has no training shapes; `of` is missing or not needed;
            several processes were started for a model that one trains.
    """
    kind = method_of(options)
    if not kind.trained:
        raise UserError(f"--model: nothing is trained for a model of kind '{kind.name}'")
    if kind.of and of is None:
        others = " or ".join(kind.of)
        raise UserError(f"--of: '{kind.name}' needs the folder of the trained model ({others}) it stands on")
    if of is not None and not kind.of:
        raise UserError(f"--of: a model of kind '{kind.name}' stands on no other")
    if launched_together() > 1 and not kind.shares_batches:
        raise UserError(f"{kind.name}: several processes cannot train one such model together; start one")
    further = {} if of is None else {"of": of}
    kind.load("train")(index, options, training, seed, out_folder, **further)
