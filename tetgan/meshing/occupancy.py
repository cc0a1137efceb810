"""Change an occupancy so that its boundary is manifold and no crumb floats."""

import numpy as np
from jaxtyping import Bool, Float

from tetgan.grids.grid import TetGrid
from tetgan.meshing.collared_grid import CollaredGrid, collared_grid
from tetgan.meshing.components import count_cavities, drop_small_pieces
from tetgan.meshing.manifold import boundary_defects, make_manifold, mixed_vertices
from tetgan.meshing.opening import Opened, open_pinches
from tetgan.meshing.options import MeshingOptions
from tetgan.solids.solid import SolidChanges

_TRIES = 3  # to mend by occupancy only what could not be opened; then everything is


# Share of the boundary's vertices at fault beyond which everything is, at once: chairs have up to 0.4, noise
# up to 0.9, whose pinches took up to 22 s to open on 9,216 tets, and more on larger lattices.
_NOISE = 0.45


def valid_solid(
    occupancy: Bool[np.ndarray, "T"], cost: Float[np.ndarray, "T"], grid: TetGrid, options: MeshingOptions
) -> tuple[Opened, SolidChanges]:
    """A solid with a manifold boundary, and what was changed for it.

    First the small pieces go that not even a vertex joins to the rest: mending them would be wasted. Then the
    boundary is made a manifold, and at last the small pieces go that this has cut off.

    Args:
        cost: of changing each tet; see `make_manifold`.
    """
    ambient = collared_grid(grid)
    given = ambient.with_collar(occupancy)
    volume = float(ambient.volumes[given].sum())
    smallest = options.min_component * volume
    apart = drop_small_pieces(given, ambient, smallest, joined_by="vertices")
    never = np.full(len(given) - len(cost), np.inf)
    mended, opened = _mend(apart.occupancy, ambient, np.concatenate([cost, never]), options.min_dihedral)
    cut_off = drop_small_pieces(opened.occupancy, opened.space, smallest, joined_by="faces")
    added, removed = mended & ~apart.occupancy, apart.occupancy & ~mended
    dropped = np.concatenate([apart.volumes, cut_off.volumes])
    changes = SolidChanges(
        tets_added=int(added.sum()),
        tets_removed=int(removed.sum()),
        changed=float((added | removed).sum() / max(occupancy.sum(), 1)),
        gaps=opened.gaps,
        seams=opened.seams,
        dropped=tuple((dropped / volume).tolist()) if volume else (),
        cavities=count_cavities(cut_off.occupancy, opened.space),
    )
    return opened._replace(occupancy=cut_off.occupancy), changes


def _mend(
    occupancy: Bool[np.ndarray, "T"], ambient: CollaredGrid, cost: Float[np.ndarray, "T"], min_dihedral: float
) -> tuple[Bool[np.ndarray, "T"], Opened]:
    """The occupancy of the grid that is left, and the solid opened (`open_pinches`).

    Where that fails the occupancy is changed first, and all is opened anew: so every time there are more
    vertices where it is changed, and at last, it is everywhere.
    """
    faulty = boundary_defects(occupancy, ambient) > 0
    stubborn = np.full(len(faulty), faulty.sum() > _NOISE * len(mixed_vertices(occupancy, ambient)))
    for number in range(_TRIES + 1):
        mended = make_manifold(occupancy, ambient, cost, stubborn)
        faulty = boundary_defects(mended, ambient) > 0
        opened, left = open_pinches(mended, np.flatnonzero(faulty), ambient, min_dihedral)
        if not len(left):
            break
        stubborn[left] = True
        stubborn |= number == _TRIES - 1
    return mended, opened
