"""Elements of degree 2 whose boundary follows a surface, as far as they stay valid."""

from typing import NamedTuple

import igl
import numpy as np
from jaxtyping import Float

from tetgan.geometry.triangles import TriangleMesh
from tetgan.solids.elements import MIDDLES, Elements

_LEAST = 0.05  # of the straight tet's Jacobian: how small a curved one's coefficients may be

_CORNERS = np.stack(np.meshgrid(*[np.arange(4)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)

_KINDS, _KIND = np.unique(np.sort(_CORNERS, axis=1), axis=0, return_inverse=True)

_MEANS = (_KIND.ravel() == np.arange(len(_KINDS))[:, None]).astype(float)
_MEANS /= _MEANS.sum(axis=1, keepdims=True)  # (20, 64) over the orders of three corners

_TURNS = np.linalg.det(np.eye(3)[_CORNERS % 3]).round().reshape(4, 4, 4)[:3, :3, :3]  # Levi-Civita's symbol


class Curved(NamedTuple):
    """Elements on a surface; of the boundary edges how many are curved, and how many stay straight."""

    elements: Elements
    moved: int
    straight: int


def curve_onto(elements: Elements, surface: TriangleMesh) -> Curved:
    """Move the middles of boundary edges to the nearest points of a surface.

    As long as a tet's Jacobian would not be positive all over, that of its middles which moved farthest goes
    back. Corners stay where they are, so this is for meshes whose corners lie on the surface.

    Args:
        elements: of degree 2, with straight edges.
        surface: in the same units.
    """
    nodes, middles = elements.nodes.copy(), np.unique(elements.faces[:, 3:])
    _, _, nodes[middles] = igl.point_mesh_squared_distance(nodes[middles], surface.vertices, surface.faces)
    cells = elements.cells[np.isin(elements.cells, middles).any(axis=1)]
    least = _LEAST * jacobian_coefficients(elements.nodes[cells]).min(axis=1).clip(min=0)
    straight = np.zeros(len(nodes), dtype=bool)
    while True:
        invalid = cells[jacobian_coefficients(nodes[cells]).min(axis=1) <= least]
        shifts = np.linalg.norm(nodes - elements.nodes, axis=1)[invalid]
        farthest = shifts.argmax(axis=1)
        back = invalid[np.arange(len(invalid)), farthest][shifts.max(axis=1, initial=0) > 0]
        if not len(back):
            break
        nodes[back] = elements.nodes[back]
        straight[back] = True
    count = int(straight.sum())
    return Curved(Elements(nodes, elements.cells, elements.groups), len(middles) - count, count)


def jacobian_coefficients(points: Float[np.ndarray, "T 10 3"]) -> Float[np.ndarray, "T 20"]:
    """Bernstein coefficients of the Jacobian, a cubic polynomial in each tet; six volumes if it is straight.

    The Jacobian lies between the least and the greatest of them (Johnen, Remacle & Geuzaine 2013), and its
    integral over the tet is a sixth of their mean.

    Args:
        points: nodes of tets of degree 2.
    """
    corners = points[:, :4]
    one, other = MIDDLES.T
    control = np.empty((len(points), 4, 4, 3))  # of the Bézier form: corners, and one point for each edge
    control[:, range(4), range(4)] = corners
    control[:, one, other] = 2 * points[:, 4:] - (corners[:, one] + corners[:, other]) / 2
    control[:, other, one] = control[:, one, other]
    slopes = 2 * (control[:, :, 1:] - control[:, :, :1])  # along three edges, linear: a value at each corner
    products = np.einsum("tia,tjb,tkc,abc->tijk", *np.moveaxis(slopes, 2, 0), _TURNS, optimize=True)
    return products.reshape(len(points), 64) @ _MEANS.T
