"""Which way tets face, decided exactly."""

import igl.predicates
import numpy as np
from jaxtyping import Float, Int


def orientations(vertices: Float[np.ndarray, "V 3"], tets: Int[np.ndarray, "T 4"]) -> Int[np.ndarray, "T"]:
    """Sign of each tet's volume: 1, 0 where it is flat, -1 where it is inverted.

    Exact for the coordinates as they are stored, where a volume in floating point can have either sign
    (Shewchuk 1997, through libigl). Coordinates must be finite.
    """
    corners = np.asarray(vertices, dtype=np.float64)[tets]
    # The predicate is positive where the last point lies below the plane of the others.
    signs = igl.predicates.orient3d(*(np.ascontiguousarray(corners[:, k]) for k in range(4)))
    return -signs.astype(np.int64)
