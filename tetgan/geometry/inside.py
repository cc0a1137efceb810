"""Points inside of closed surfaces, by winding number."""

import numpy as np
from jaxtyping import Bool, Float, Int


def is_inside(
    points: Float[np.ndarray, "P 3"],
    vertices: Float[np.ndarray, "V 3"],
    faces: Int[np.ndarray, "F 3"],
    *,
    either_way: bool = False,
) -> Bool[np.ndarray, "P"]:
    """Where the fast winding number (Barill et al. 2018) is above ½.

    The threshold forgives the approximation, and gaps in the surface.

    Args:
        vertices, faces: a surface that faces outward.
        either_way: the surface may face inward as well.

    Raises:
        ValueError: the mesh has no faces.
    """
    import igl  # noqa: PLC0415

    if len(faces) == 0:
        raise ValueError("a mesh without faces has no inside")
    vertices, faces = np.ascontiguousarray(vertices, np.float64), np.ascontiguousarray(faces, np.int64)
    turns = igl.fast_winding_number(vertices, faces, points)
    return np.asarray((np.abs(turns) if either_way else turns) > 0.5)
