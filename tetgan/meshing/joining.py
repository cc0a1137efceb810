"""Components of a solid, and the seams of least volume that join them."""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import sparse
from scipy.sparse.csgraph import minimum_spanning_tree

from tetgan.geometry.components import label_components
from tetgan.meshing.patches import Patches
from tetgan.meshing.stars import Pieces


def part_a_component(
    patches: Patches, vertices: Int[np.ndarray, "N"], pieces: Pieces, component: Int[np.ndarray, "T"]
) -> Bool[np.ndarray, "P"]:
    """Whether pulling a patch back would leave no other piece of its component at the vertex.

    Then the vertex might be all that holds the component to the others there. It is never so of empty ones.

    Args:
        vertices: which `pieces` lie around, in this order.
        component: number of the component, joined by faces, that a tet belongs to; -1 for an empty one.
    """
    base = component.max(initial=-1) + 1
    of_piece = np.full(len(pieces.piece_place), -1)
    of_piece[pieces.label] = component[pieces.tets]
    keys = np.sort((vertices[pieces.piece_place] * base + of_piece)[pieces.piece_occupied])
    own = patches.vertex * base + patches.most_of_tets(component[patches.tets])
    alone = np.searchsorted(keys, own, side="right") - np.searchsorted(keys, own) < 2
    return patches.occupied & alone


def least_joins(
    patches: Patches, volume: Float[np.ndarray, "P"], component: Int[np.ndarray, "T"]
) -> Bool[np.ndarray, "P"]:
    """Seams that join components: of the least volume, and no more than are needed (a spanning forest).

    Args:
        volume: of the seam at the rim of each patch.
    """
    across, most = component[patches.across], component.max(initial=0)
    high = patches.most_of_rim(across)
    low = most - patches.most_of_rim(np.where(across < 0, 0, most - across))
    joining = np.flatnonzero(~patches.occupied & (low < high))
    order = joining[np.argsort(volume[joining], kind="stable")]
    pairs, first = np.unique(np.stack([low[order], high[order]]), axis=1, return_index=True)
    links = sparse.coo_array((first + 1.0, tuple(pairs)), shape=(most + 1,) * 2)
    joins = np.zeros(len(volume), dtype=bool)
    joins[order[minimum_spanning_tree(links).data.astype(np.int64) - 1]] = True
    return joins


def components_after(
    patches: Patches, component: Int[np.ndarray, "T"]
) -> tuple[Int[np.ndarray, "T"], Int[np.ndarray, "R"]]:
    """Components where the seams of all patches have joined some; and of the tets made at their rims."""
    across, seam = component[patches.across], ~patches.occupied[patches.rim_patch]
    one = patches.most_of_rim(np.where(seam, across, -1))[patches.rim_patch]
    joined = seam & (across >= 0)
    labels = label_components(one[joined], across[joined], int(component.max(initial=0)) + 1)
    number = np.append(labels, -1)  # the -1 of empty tets reads the last
    return number[component], number[one]
