"""Eq. 5: occupied tets that the displacement does not believe in."""

import numpy as np
from jaxtyping import Bool, Int

from tetgan.fields.field import Field, surface_tets


def filter_occupancy(
    field: Field, neighbors: Int[np.ndarray, "T 4"], mu: float, gamma: float
) -> Bool[np.ndarray, "T"]:
    """Occupancy without the surface tets that lie further than `gamma * mu` from the surface.

    One pass, as in the paper: the tets it lays bare are not looked at again.
    """
    far = np.linalg.norm(field.displacement, axis=1) > gamma * mu
    return field.occupancy & ~(far & surface_tets(field.occupancy, neighbors))
