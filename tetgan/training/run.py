"""Stage: fields, points or voxels in, a trained model out."""

import hashlib
from pathlib import Path
from typing import Any, NamedTuple

from tetgan.errors import UserError
from tetgan.fields.samplings import open_sampling
from tetgan.grids.hierarchy import GridHierarchy
from tetgan.models.files import WEIGHTS, load_generator, load_record, save_generator
from tetgan.models.generator import FieldGenerator
from tetgan.models.method import Method, MethodOptions
from tetgan.models.registry import method_of
from tetgan.options import Options
from tetgan.training.data import open_training
from tetgan.training.loop import TrainingLoop
from tetgan.training.options import CommonTraining
from tetgan.training.processes import launched_together, process_group


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
        UserError: the index is no such data, or has no training shapes; `of` is missing, not needed, or of
            another kind or grid than is needed; several processes were started for a model that one trains;
            the training diverges in its first epoch.
    """
    kind = method_of(options)
    if not kind.trained:
        raise UserError(f"--model: nothing is trained for a model of kind '{kind.name}'")
    _check_of(kind, of)
    if launched_together() > 1 and not kind.shares_batches:
        raise UserError(f"{kind.name}: several processes cannot train one such model together; start one")
    if kind.train is not None:
        kind.load("train")(index, options, training, seed, out_folder)
        return
    assert isinstance(training, CommonTraining), f"{kind.name}: training options derive from CommonTraining"
    with process_group(training.device):
        store = _open(index, kind)
        under = None if of is None else _load_under(kind, of, store.hierarchy)
        standing = {} if under is None else {"of": under.generator}
        learner = kind.load("learner")(options, training, store, seed, **standing)
        loop = TrainingLoop(
            learner,
            out_folder,
            seed,
            options={
                "model": options.model_dump(exclude={"training", "meshing"}),
                "training": training.model_dump(exclude=set(training.may_change)),
            },
            further={} if under is None else {"model underneath": under.digest},
            validate_every=training.validate_every,
            checkpoint_seconds=training.checkpoint_seconds,
        )

        def save(**about: Any) -> None:
            of_record = {} if under is None else {"of": under.record}
            save_generator(
                out_folder,
                learner.generator,
                options,
                getattr(store, "hierarchy", None),
                **of_record,
                training=training.model_dump(mode="json"),
                seed=seed,
                **about,
            )

        loop.run(save)


def _check_of(kind: Method, of: Path | None) -> None:
    if kind.of and of is None:
        others = " or ".join(kind.of)
        raise UserError(
            f"--of: '{kind.name}' needs the folder of a trained model ({others}) that it is built on"
        )
    if of is not None and not kind.of:
        raise UserError(f"--of: a model of kind '{kind.name}' is built on no other")


def _open(index: Path, kind: Method) -> Any:
    if kind.sampling is None:
        return open_training(index)
    return open_sampling(index, kind.sampling["kind"])


class _Under(NamedTuple):
    """The trained model that another is built on; `record` is what that one remembers of it."""

    generator: FieldGenerator
    record: dict[str, Any]
    digest: str


def _load_under(kind: Method, folder: Path, hierarchy: GridHierarchy) -> _Under:
    record = {key: value for key, value in load_record(folder).items() if key in ("model", "of")}
    found = record["model"]["kind"]
    if found not in kind.of:
        others = " or ".join(kind.of)
        raise UserError(f"{folder}: a model of kind '{found}'; '{kind.name}' is built on {others}")
    digest = hashlib.sha256((folder / WEIGHTS).read_bytes()).hexdigest()
    return _Under(load_generator(folder, hierarchy).requires_grad_(False), record, digest)
