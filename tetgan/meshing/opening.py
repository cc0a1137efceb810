"""Open the pinches of a boundary, or close them by a seam, without a change of occupancy."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import sparse

from tetgan.geometry.tets import tet_shapes
from tetgan.meshing.collared_grid import CollaredGrid
from tetgan.meshing.components import label_by_faces
from tetgan.meshing.joining import components_after, least_joins, part_a_component
from tetgan.meshing.patches import Patches, patches_at
from tetgan.meshing.pulling import made_tets, places_to_pull_to

_LEAST_VOLUME = 1e-3  # of the smallest tet of the grid: what every tet keeps


class Opened(NamedTuple):
    """A solid in a space of its own: that of the grid, with vertices doubled where it was opened.

    Attributes:
        space: tets of the grid first, in their order, then those made, then the collar.
        occupancy: (T,) of its tets; component: (T,) number of the piece, joined by faces, of an occupied tet;
            -1 for an empty one.
        blend: (V, G) each vertex as a mean of those of the grid and its collar, as they were.
        gaps, seams: pulls of occupied patches, and of empty ones.
    """

    space: CollaredGrid
    occupancy: Bool[np.ndarray, "T"]
    component: Int[np.ndarray, "T"]
    blend: sparse.csr_array
    gaps: int = 0
    seams: int = 0


class _Pulls(NamedTuple):
    """Patches and where to pull them: `place` (P, 3), and the volume (P,) of what is made there."""

    patches: Patches
    place: Float[np.ndarray, "P 3"]
    volume: Float[np.ndarray, "P"]

    def only(self, wanted: Bool[np.ndarray, "P"]) -> "_Pulls":
        return _Pulls(self.patches.only(wanted), self.place[wanted], self.volume[wanted])


def open_pinches(
    occupancy: Bool[np.ndarray, "T"], faulty: Int[np.ndarray, "N"], ambient: CollaredGrid, min_dihedral: float
) -> tuple[Opened, Int[np.ndarray, "M"]]:
    """Pull tets back from vertices at fault, until the boundary is a manifold or nothing more can be done.

    To pull a patch P of tets back from a vertex v is to give it a copy of v of its own, a little way into P,
    and to make a tet of the other kind on each side of its rim, between v and the copy. That is a split of v:
    space stays filled without overlap. An occupied piece pulled back leaves a gap. An empty one, or an empty
    row of tets between two occupied pieces, leaves a seam that joins what lies around. Pieces that hang
    together at v alone are joined, at the fewest places that will do, and only what is connected elsewhere
    too is parted. Each pull lowers the sum of the defects, so this ends.

    Args:
        faulty: the vertices that have a defect (`boundary_defects`).

    Returns:
        The solid; and the faulty vertices that are left. No copy is among them.
    """
    component = np.full(len(occupancy), -1)
    component[occupancy] = label_by_faces(np.flatnonzero(occupancy), ambient)
    opened = Opened(ambient, occupancy, component, sparse.eye_array(len(ambient.vertices), format="csr"))
    least_volume = 6 * _LEAST_VOLUME * ambient.volumes[: ambient.grid_tets].min()
    pulled = True
    while pulled and len(faulty):
        opened, faulty, pulled = _pull_once(opened, faulty, min_dihedral, least_volume)
    return opened, faulty


def _pull_once(
    opened: Opened, faulty: Int[np.ndarray, "N"], min_dihedral: float, least_volume: float
) -> tuple[Opened, Int[np.ndarray, "M"], bool]:
    """Pull all that can be at once; the vertices that were at fault before; whether there was any."""
    rows, used, nearby = _surroundings(opened.space, faulty)
    occupancy, component = opened.occupancy[rows], opened.component[rows]
    vertices = np.searchsorted(used, faulty)
    pieces = nearby.around_vertices.pieces(vertices, None, occupancy)
    at_fault = pieces.defects(len(vertices)) > 0
    patches = patches_at(vertices, pieces, occupancy, nearby)
    patches = patches.only(~part_a_component(patches, vertices, pieces, component))
    place, found = places_to_pull_to(patches, nearby, min_dihedral, least_volume)
    volume = patches.sum_of_rim(tet_shapes(made_tets(patches, place[None], nearby)).volume[0])
    pulls = _Pulls(patches, place, volume).only(found)
    joins = least_joins(pulls.patches, pulls.volume, component)
    if joins.any():
        pulls = pulls.only(joins)
    if len(pulls.volume):
        pulls = pulls.only(_independent(pulls, occupancy, nearby.tets))
        opened = _pull(opened, pulls._replace(patches=pulls.patches.renumbered(used, rows)))
    return opened, faulty[at_fault], len(pulls.volume) > 0


def _surroundings(
    space: CollaredGrid, vertices: Int[np.ndarray, "N"]
) -> tuple[Int[np.ndarray, "T"], Int[np.ndarray, "V"], CollaredGrid]:
    """The tets within two rings of some vertices: their rows, their vertices, and as a space of their own."""
    near = np.zeros(len(space.vertices), dtype=bool)
    near[vertices] = True
    for _ in range(2):
        rows = np.flatnonzero(near[space.tets].any(axis=1))
        near[space.tets[rows]] = True
    used, tets = np.unique(space.tets[rows], return_inverse=True)
    inside = int(np.searchsorted(rows, space.grid_tets))
    return (
        rows,
        used,
        CollaredGrid(
            space.vertices[used], tets.reshape(-1, 4), inside, space.pinned[used], space.guarded[rows]
        ),
    )


def _independent(
    pulls: _Pulls, occupancy: Bool[np.ndarray, "T"], tets: Int[np.ndarray, "T 4"]
) -> Bool[np.ndarray, "P"]:
    """The smallest pulls, and all others that are out of their way.

    Two are in each other's way at one vertex and at neighbouring ones; and where both make tets at one end of
    a side of a rim that runs between tets of one kind: each by itself does no harm, but both might.
    """
    patches, count = pulls.patches, len(pulls.volume)
    inner = patches.inner_rim(occupancy)
    pull_of_end = np.repeat(patches.rim_patch[inner], 2)
    ends = patches.rim_ends(tets)[inner].ravel()
    rank = np.argsort(np.argsort(pulls.volume, kind="stable")).astype(np.float64)
    chosen = np.zeros(count, dtype=bool)
    while np.isfinite(rank).any():
        of_vertex, of_end = np.full((2, tets.max() + 1), np.inf)
        np.minimum.at(of_vertex, patches.vertex, rank)
        np.minimum.at(of_vertex, tets, of_vertex[tets].min(axis=1)[:, None])
        np.minimum.at(of_end, ends, rank[pull_of_end])
        first = np.isfinite(rank) & (rank == of_vertex[patches.vertex])
        first[pull_of_end[of_end[ends] < rank[pull_of_end]]] = False
        chosen |= first
        taken = np.isin(np.arange(len(of_vertex)), patches.vertex[first])
        taken[tets[taken[tets].any(axis=1)]] = True
        rank[taken[patches.vertex]] = np.inf
        rank[pull_of_end[np.isin(ends, ends[first[pull_of_end]])]] = np.inf
    return chosen


def _pull(opened: Opened, pulls: _Pulls) -> Opened:
    """The solid after some pulls."""
    space, patches = opened.space, pulls.patches
    copies = len(space.vertices) + np.arange(len(pulls.place))
    made = space.tets[patches.rim_tets]
    made[np.arange(len(made)), patches.rim_slot] = copies[patches.rim_patch]
    tets = space.tets.copy()
    tets[patches.tets, patches.corner] = copies[patches.patch]
    solid, here = ~patches.occupied[patches.rim_patch], space.grid_tets
    component, of_made = components_after(patches, opened.component)
    return Opened(
        CollaredGrid(
            np.concatenate([space.vertices, pulls.place]),
            _insert(tets, here, made),
            here + len(made),
            np.concatenate([space.pinned, np.zeros(len(copies), dtype=bool)]),
            _insert(space.guarded, here, np.ones(len(made), dtype=bool)),
        ),
        _insert(opened.occupancy, here, solid),
        _insert(component, here, of_made),
        sparse.vstack([opened.blend, _blend(pulls, space) @ opened.blend], format="csr"),
        opened.gaps + int(patches.occupied.sum()),
        opened.seams + int((~patches.occupied).sum()),
    )


def _blend(pulls: _Pulls, space: CollaredGrid) -> sparse.csr_array:
    """(P, V): each place as a mean of the corners of the tet that it lies in."""
    patches, places = pulls.patches, len(pulls.place)
    corners = np.concatenate([space.corners(patches.tets), np.ones((4, 1, len(patches.tets)))], axis=1)
    point = np.concatenate([pulls.place, np.ones((places, 1))], axis=1)[patches.patch, :, None]
    shares = np.linalg.solve(np.transpose(corners, (2, 1, 0)), point)[..., 0]
    order = np.lexsort([-shares.min(axis=1), patches.patch])
    within = order[np.searchsorted(patches.patch, np.arange(places))]
    ends = np.repeat(np.arange(places), 4), space.tets[patches.tets[within]].ravel()
    return sparse.csr_array((shares[within].ravel(), ends), shape=(places, len(space.vertices)))


def _insert(array: np.ndarray, here: int, more: np.ndarray) -> np.ndarray:
    return np.concatenate([array[:here], more, array[here:]])
