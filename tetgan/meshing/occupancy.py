"""From any occupancy to one whose boundary is a manifold, without floating crumbs."""

import numpy as np
from jaxtyping import Bool, Float

from tetgan.grids.grid import TetGrid
from tetgan.meshing.ambient import ambient_space
from tetgan.meshing.components import count_cavities, drop_small_pieces
from tetgan.meshing.manifold import make_manifold
from tetgan.meshing.options import MeshingOptions
from tetgan.meshing.solid import SolidChanges


def valid_occupancy(
    occupancy: Bool[np.ndarray, "T"], cost: Float[np.ndarray, "T"], grid: TetGrid, options: MeshingOptions
) -> tuple[Bool[np.ndarray, "T"], SolidChanges]:
    """Occupancy with a manifold boundary, and what was changed for it.

    First the small pieces go that not even a vertex joins to the rest: mending them would be wasted. Then the
    boundary is made a manifold, and at last the small pieces go that this has cut off.

    Args:
        cost: of changing each tet; see `make_manifold`.
    """
    ambient = ambient_space(grid)
    given = ambient.with_collar(occupancy)
    volume = float(ambient.volumes[given].sum())
    smallest = options.min_component * volume
    apart = drop_small_pieces(given, ambient, smallest, joined_by="vertices")
    never = np.full(len(given) - len(cost), np.inf)
    mended = make_manifold(apart.occupancy, ambient, np.concatenate([cost, never]))
    cut_off = drop_small_pieces(mended, ambient, smallest, joined_by="faces")
    added, removed = mended & ~apart.occupancy, apart.occupancy & ~mended
    dropped = np.concatenate([apart.volumes, cut_off.volumes])
    changes = SolidChanges(
        tets_added=int(added.sum()),
        tets_removed=int(removed.sum()),
        changed=float((added | removed).sum() / max(occupancy.sum(), 1)),
        dropped_components=len(dropped),
        dropped_volume=float(dropped.sum() / volume) if volume else 0.0,
        cavities=count_cavities(cut_off.occupancy, ambient),
    )
    return cut_off.occupancy[: len(occupancy)], changes
