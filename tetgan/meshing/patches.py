"""Patches of tets around a vertex that can be pulled back from it."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int, Shaped

from tetgan.geometry.adjacency import EDGES
from tetgan.geometry.tets import tet_shapes
from tetgan.meshing.bridges import cheapest_bridges
from tetgan.meshing.collared_grid import VERTEX_FACES, CollaredGrid
from tetgan.meshing.stars import Pieces

_FLAT = 16.0  # times the cost of a tet of right angles: what a bridge would pay to go through a flat one


# The two local vertices of a tet that are neither of two others.
_OTHERS = np.array([[[k for k in range(4) if k not in {i, j}][:2] for j in range(4)] for i in range(4)])


class Patches(NamedTuple):
    """Tets around a vertex, all occupied or all empty, connected by faces; and their rims.

    The tets around a vertex cut a small sphere into triangles. A patch is a region of it, its rim the sides
    of its triangles that other tets lie across.

    Attributes:
        vertex, occupied: (P,) of each patch.
        patch: (M,) number of a patch, ascending; tets: (M,) its tets; corner: (M,) which of a tet's vertices
            is the patch's.
        rim_patch: (N,) number of a patch, ascending; rim_tets, rim_corner: (N,) of the tet inside of a side
            of its rim; rim_slot: (N,) the side is on the tet's face opposite this local vertex; across: (N,)
            the tet outside.
    """

    vertex: Int[np.ndarray, "P"]
    occupied: Bool[np.ndarray, "P"]
    patch: Int[np.ndarray, "M"]
    tets: Int[np.ndarray, "M"]
    corner: Int[np.ndarray, "M"]
    rim_patch: Int[np.ndarray, "N"]
    rim_tets: Int[np.ndarray, "N"]
    rim_corner: Int[np.ndarray, "N"]
    rim_slot: Int[np.ndarray, "N"]
    across: Int[np.ndarray, "N"]

    def only(self, wanted: Bool[np.ndarray, "P"]) -> "Patches":
        """Some of the patches, numbered anew."""
        number, tets, rim = np.cumsum(wanted) - 1, wanted[self.patch], wanted[self.rim_patch]
        return Patches(
            self.vertex[wanted],
            self.occupied[wanted],
            number[self.patch[tets]],
            self.tets[tets],
            self.corner[tets],
            number[self.rim_patch[rim]],
            self.rim_tets[rim],
            self.rim_corner[rim],
            self.rim_slot[rim],
            self.across[rim],
        )

    def renumbered(self, vertices: Int[np.ndarray, "V"], tets: Int[np.ndarray, "T"]) -> "Patches":
        """The same in another numbering, given the new numbers of all vertices and tets."""
        return self._replace(
            vertex=vertices[self.vertex],
            tets=tets[self.tets],
            rim_tets=tets[self.rim_tets],
            across=tets[self.across],
        )

    def most_of_tets(self, values: Shaped[np.ndarray, "*K M"]) -> Shaped[np.ndarray, "*K P"]:
        """The largest of some numbers, one for each tet."""
        return np.maximum.reduceat(values, np.searchsorted(self.patch, np.arange(len(self.vertex))), axis=-1)

    def most_of_rim(self, values: Shaped[np.ndarray, "*K N"]) -> Shaped[np.ndarray, "*K P"]:
        """The largest of some numbers, one for each side of the rim."""
        return np.maximum.reduceat(
            values, np.searchsorted(self.rim_patch, np.arange(len(self.vertex))), axis=-1
        )

    def rim_ends(self, tets: Int[np.ndarray, "T 4"]) -> Int[np.ndarray, "N 2"]:
        """The two vertices that each side of the rim joins."""
        return np.take_along_axis(tets[self.rim_tets], _OTHERS[self.rim_corner, self.rim_slot], axis=1)

    def inner_rim(self, occupancy: Bool[np.ndarray, "T"]) -> Bool[np.ndarray, "N"]:
        """Sides of the rim with a tet of the patch's own kind across."""
        return occupancy[self.across] == self.occupied[self.rim_patch]

    def sum_of_rim(self, values: Float[np.ndarray, "N"]) -> Float[np.ndarray, "P"]:
        """The sum of some numbers, one for each side of the rim."""
        return np.add.reduceat(values, np.searchsorted(self.rim_patch, np.arange(len(self.vertex))))


def patches_at(
    vertices: Int[np.ndarray, "N"], pieces: Pieces, occupancy: Bool[np.ndarray, "T"], space: CollaredGrid
) -> Patches:
    """Patches whose pull removes a fault at a vertex and makes none elsewhere.

    That are the pieces around a vertex, and rows of empty tets between two occupied ones: the shortest, and
    the one through the best tets. They must be disks, for only those can be pulled; what that does to the
    pieces around the vertex itself is what a change of their occupancy would do.

    Args:
        vertices: which `pieces` lie around, in this order.
    """
    inside = np.arange(len(space.tets)) < space.grid_tets
    flat = tet_shapes(space.corners(np.arange(len(space.tets)))).cosine ** 4
    count, numbers, rows = len(pieces.piece_place), [pieces.label], [np.arange(len(pieces.label))]
    for cost in (np.where(inside, 1.0, np.inf), np.where(inside, 1 + _FLAT * flat, np.inf)):
        number, row = cheapest_bridges(pieces, True, cost)
        numbers, rows, count = [*numbers, number + count], [*rows, row], count + number.max(initial=-1) + 1
    found = _patches(np.concatenate(numbers), np.concatenate(rows), vertices, pieces, space.tets)
    found = found.only(_is_disk(found, space.tets))
    found = found.only(found.most_of_tets(~inside[found.tets]) == 0)
    found = found.only(_mends(found, vertices, pieces, occupancy, space))
    return found.only(_is_harmless(found, occupancy, space))


def _patches(
    numbers: Int[np.ndarray, "M"],
    rows: Int[np.ndarray, "M"],
    vertices: Int[np.ndarray, "N"],
    pieces: Pieces,
    tets: Int[np.ndarray, "T 4"],
) -> Patches:
    """Patches from their rows among the tets of pieces."""
    order = np.argsort(numbers, kind="stable")
    numbers, rows = numbers[order], rows[order]
    corner = (tets[pieces.tets] == vertices[pieces.place][:, None]).argmax(axis=1)
    base, beside = len(pieces.tets), pieces.beside[rows]
    inside, side = np.nonzero(~np.isin(numbers[:, None] * base + beside, numbers * base + rows))
    _, first, patch = np.unique(numbers, return_index=True, return_inverse=True)
    rim = rows[inside]
    return Patches(
        vertex=vertices[pieces.place[rows[first]]],
        occupied=pieces.occupied[rows[first]],
        patch=patch,
        tets=pieces.tets[rows],
        corner=corner[rows],
        rim_patch=patch[inside],
        rim_tets=pieces.tets[rim],
        rim_corner=corner[rim],
        rim_slot=VERTEX_FACES[corner[rim], side],
        across=pieces.tets[beside[inside, side]],
    )


def _is_disk(patches: Patches, tets: Int[np.ndarray, "T 4"]) -> Bool[np.ndarray, "P"]:
    """Whether each patch is a disk whose rim is one simple closed line.

    With F triangles and b sides of the rim it has (3F + b) / 2 sides, so is of Euler characteristic
    V - (F + b) / 2. That is 1 for a disk, and less for any other part of a sphere and wherever it touches
    itself.
    """
    count, base = len(patches.vertex), len(tets) * 4
    corners = np.unique(patches.patch[:, None] * base + tets[patches.tets]) // base
    vertices = np.bincount(corners, minlength=count) - 1
    triangles, rim = (np.bincount(each, minlength=count) for each in (patches.patch, patches.rim_patch))
    return (rim > 0) & (2 * vertices == 2 + triangles + rim)


def _mends(
    patches: Patches,
    vertices: Int[np.ndarray, "N"],
    pieces: Pieces,
    occupancy: Bool[np.ndarray, "T"],
    space: CollaredGrid,
) -> Bool[np.ndarray, "P"]:
    """Whether there would be fewer pieces around the vertex of each patch."""
    corners, place = space.around_vertices.corners(patches.vertex)
    tets, base = corners // 4, len(occupancy)
    changes = np.isin(place * base + tets, patches.patch * base + patches.tets)
    after = space.around_vertices.pieces(patches.vertex, occupancy[tets] ^ changes, occupancy)
    before = np.zeros(len(space.vertices), dtype=np.int64)
    before[vertices] = pieces.defects(len(vertices))
    return after.defects(len(patches.vertex)) < before[patches.vertex]


def _is_harmless(
    patches: Patches, occupancy: Bool[np.ndarray, "T"], space: CollaredGrid
) -> Bool[np.ndarray, "P"]:
    """Whether what is made at the rims of empty patches meets occupied tets at faces, and their sides, only.

    Where the rim runs between empty tets, the edge across from the vertex must have no occupied tet, and an
    end that no other side of the rim joins to an occupied one must touch none.
    """
    ends, inner = patches.rim_ends(space.tets), patches.inner_rim(occupancy)
    solid, base = space.tets[occupancy], len(space.vertices)
    crowded = inner & np.isin(_edge_keys(ends, base), _edge_keys(solid[:, EDGES].reshape(-1, 2), base))
    touched = np.zeros(base, dtype=bool)
    touched[solid] = True
    keys = patches.rim_patch[:, None] * base + ends
    alone = touched[ends] & ~np.isin(keys, keys[~inner])
    return np.bincount(patches.rim_patch, crowded | alone.any(axis=1), minlength=len(patches.vertex)) == 0


def _edge_keys(ends: Int[np.ndarray, "E 2"], base: int) -> Int[np.ndarray, "E"]:
    return ends.min(axis=1) * base + ends.max(axis=1)
