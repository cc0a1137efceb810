"""Fields to train on."""

from pathlib import Path

from tetgan.errors import UserError
from tetgan.fields.store import FieldStore


def open_training(index: Path) -> FieldStore:
    """The data set of an `index.json`.

    Raises:
        UserError: the index is missing or malformed, or no shape of it is for training.
    """
    store = FieldStore.open(index)
    if not store.ids("train"):
        raise UserError(f"{index}: no training shapes; add shapes to the source")
    return store
