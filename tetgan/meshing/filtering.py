"""Eq. 5: drops occupied surface tets whose displacement is implausibly large."""

import numpy as np
from jaxtyping import Bool, Int

from tetgan.fields.field import Field, VertexField, surface_tets


def filter_occupancy(
    field: Field | VertexField, neighbors: Int[np.ndarray, "T 4"], mu: float, gamma: float | None
) -> Bool[np.ndarray, "T"]:
    """Occupancy without the surface tets that lie further than `gamma * mu` from the surface.

    One pass, as in the paper: the tets it lays bare are not looked at again. Without a gamma nothing is
    dropped. Nor is it where displacements are zero, or known at vertices alone: Eq. 5 has nothing to compare.
    """
    if gamma is None or isinstance(field, VertexField):
        return field.occupancy
    far = np.linalg.norm(field.displacement, axis=1) > gamma * mu
    return field.occupancy & ~(far & surface_tets(field.occupancy, neighbors))
