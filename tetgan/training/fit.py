"""Training of models of fields that are fitted at once, apart from the loop, whose edits leave them alone."""

from pathlib import Path
from typing import Any

from tetgan.models.files import build_generator, save_generator
from tetgan.models.method import MethodOptions
from tetgan.options import Options
from tetgan.training.data import ResidentFields, open_training


def fit_model(index: Path, options: MethodOptions, training: Options, seed: int, folder: Path) -> None:
    """Build a model of fields and call its `fit`, which gets a function from a slice of tets to their fields.

    Raises:
        UserError: there are no training shapes.
    """
    store = open_training(index)
    generator: Any = build_generator(options, store.hierarchy)
    generator.fit(ResidentFields(store, "train").tets)
    save_generator(folder, generator, options, store.hierarchy)
