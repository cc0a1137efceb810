"""Point clouds of raw surfaces in a file: training shapes and held-out ones."""

from dataclasses import dataclass
from pathlib import Path
from zipfile import BadZipFile

import numpy as np
from jaxtyping import Float

from tetgan.errors import UserError


@dataclass(frozen=True, eq=False)
class Clouds:
    """Points of training shapes (N, P, 3) and of held-out ones (M, P, 3) in the unit cube, and their ids."""

    train: Float[np.ndarray, "N P 3"]
    train_ids: list[str]
    holdout: Float[np.ndarray, "M P 3"]
    holdout_ids: list[str]


def read_clouds(path: Path) -> Clouds:
    """Read what `sample_clouds` wrote.

    Raises:
        UserError: not a file of clouds.
    """
    try:
        with np.load(path, allow_pickle=False) as arrays:
            ids = {
                name: [str(shape_id) for shape_id in arrays[name]] for name in ("train_ids", "holdout_ids")
            }
            return Clouds(arrays["train"], ids["train_ids"], arrays["holdout"], ids["holdout_ids"])
    except (OSError, KeyError, ValueError, BadZipFile) as error:
        raise UserError(f"{path}: not a file of clouds ({error})") from None
