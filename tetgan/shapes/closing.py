"""Surfaces that enclose a volume as they are, and repair of the others, in their own units and place."""

from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float, Int

from tetgan.geometry.adjacency import unique_edges
from tetgan.geometry.components import label_components
from tetgan.geometry.intersections import self_intersections
from tetgan.geometry.triangles import TriangleMesh, six_cones
from tetgan.shapes.cleaning import ShapeError, clean_mesh
from tetgan.shapes.isolation import RepairWorker
from tetgan.shapes.options import RepairOptions
from tetgan.shapes.repair import repair_shape

Method = Literal["auto", "none", "manifold", "alpha_wrap"]

_SAME = 1e-8  # of the longest side: vertices nearer than that are one


class Closed(NamedTuple):
    """A surface that encloses a volume.

    Attributes:
        surface: closed, facing outward; the raw one with its vertices joined, or one around it.
        repair: what was done: `none`, `turned`, or a method of `RepairOptions`.
        reason: why a repair was needed; empty where none was.
    """

    surface: TriangleMesh
    repair: str
    reason: str = ""


def close_surface(soup: TriangleMesh, method: Method, repair: RepairOptions) -> Closed:
    """The surface itself where it encloses a volume, else what repair makes of it.

    With `auto` a surface is left alone where every edge has as many faces one way as the other, no two faces
    meet but in what they share, and its pieces can be turned to face outward; all others are wrapped.

    Args:
        repair: how to, but for the method.

    Raises:
        ShapeError: the shape cannot be used, or the method is `none` and it encloses nothing.
    """
    soup = join_vertices(clean_mesh(soup))
    if method in ("auto", "none"):
        turned = turn_outward(soup)
        reason = _problem(turned, crossings=method == "auto")
        if not reason:
            return Closed(turned, "none" if np.array_equal(turned.faces, soup.faces) else "turned")
        if method == "none":
            raise ShapeError(f"{reason}; it needs a repair")
        method = "alpha_wrap"
    else:
        reason = "asked for"
    options = repair.model_copy(update={"method": method})
    low, high = soup.vertices.min(axis=0), soup.vertices.max(axis=0)
    with RepairWorker(options) as worker:
        solid = repair_shape(soup, worker, options).solid
    # Repair has put the longest side to 1 and the middle to ½.
    own = (low + high) / 2 + (solid.vertices - 0.5) * (high - low).max()
    return Closed(TriangleMesh(own, solid.faces), method, reason)


def join_vertices(soup: TriangleMesh) -> TriangleMesh:
    """Vertices in one place made one: files may give every face its own."""
    low, size = soup.vertices.min(axis=0), np.ptp(soup.vertices, axis=0).max()
    places = np.round((soup.vertices - low) / (size * _SAME)).astype(np.int64)
    _, first, place = np.unique(places, axis=0, return_index=True, return_inverse=True)
    faces = place.reshape(-1)[soup.faces]
    one, two, three = faces.T
    faces = faces[(one != two) & (two != three) & (three != one)]
    return TriangleMesh(soup.vertices[first], faces)


def turn_outward(surface: TriangleMesh) -> TriangleMesh:
    """Pieces turned to be consistent within and to face outward, where they can be.

    Pieces within others keep their turn towards the outermost one around them: they bound a void, or are
    there twice. Where faces of one piece disagreed, nobody knows, and what lies within is a void.
    """
    import igl  # noqa: PLC0415

    faces = np.ascontiguousarray(surface.faces, np.int64)
    disagreed = bool(_unbalanced(faces))
    if disagreed:
        faces = np.asarray(igl.bfs_orient(faces)[0], dtype=np.int64)
        if _unbalanced(faces):
            return surface
    piece = _pieces(faces)
    volumes = np.bincount(piece, six_cones(surface.vertices[faces], surface.vertices.mean(axis=0)))
    around = [_around(surface.vertices, faces, piece, number) for number in range(len(volumes))]
    turned = volumes < 0
    for number, others in enumerate(around):
        outer = [other for other in others if not len(around[other])]
        if disagreed:
            turned[number] ^= len(others) % 2 == 1
        elif outer:
            turned[number] = volumes[outer[0]] < 0
    faces = np.where(turned[piece][:, None], faces[:, ::-1], faces)
    return TriangleMesh(surface.vertices, np.ascontiguousarray(faces))


def count_pieces(surface: TriangleMesh) -> int:
    """Pieces of a closed surface, joined by edges, that enclose a positive volume."""
    piece = _pieces(surface.faces)
    return int((np.bincount(piece, six_cones(surface.triangles, surface.vertices.mean(axis=0))) > 0).sum())


def _around(
    vertices: Float[np.ndarray, "V 3"],
    faces: Int[np.ndarray, "F 3"],
    piece: Int[np.ndarray, "F"],
    number: int,
) -> list[int]:
    """Pieces that a piece lies within, judged by one point of it."""
    import igl  # noqa: PLC0415

    point = vertices[faces[np.argmax(piece == number)]].mean(axis=0, keepdims=True)
    found = []
    for other in range(int(piece.max()) + 1):
        own = np.ascontiguousarray(faces[piece == other])
        corners = vertices[own]
        if (
            other == number
            or (point < corners.min(axis=(0, 1))).any()
            or (point > corners.max(axis=(0, 1))).any()
        ):
            continue
        if abs(igl.winding_number(vertices, own, point)[0]) > 0.5:
            found.append(other)
    return found


def _pieces(faces: Int[np.ndarray, "F 3"]) -> Int[np.ndarray, "F"]:
    """The piece that each face belongs to; faces that share an edge are of one."""
    _, edge = unique_edges(faces)
    order = np.argsort(edge.ravel(), kind="stable")
    same = np.flatnonzero(np.diff(edge.ravel()[order]) == 0)
    return label_components(order[same] // 3, order[same + 1] // 3, len(faces))


def _unbalanced(faces: Int[np.ndarray, "F 3"]) -> int:
    """Edges that do not have as many faces one way as the other."""
    _, edge = unique_edges(faces)
    along = np.where(faces[:, [0, 0, 1]] < faces[:, [1, 2, 2]], 1, -1) * [1, -1, 1]
    return int((np.bincount(edge.ravel(), along.ravel()) != 0).sum())


def _problem(surface: TriangleMesh, *, crossings: bool) -> str:
    """Why a surface encloses no volume by itself; empty where it does."""
    if unbalanced := _unbalanced(surface.faces):
        return f"not closed: {unbalanced} open or misoriented edges"
    if not surface.volume > 1e-9 * np.ptp(surface.vertices, axis=0).max() ** 3:
        return "encloses no volume"
    if crossings and (found := len(self_intersections(surface.vertices, surface.faces))):
        return f"meets itself: {found} pairs of faces"
    return ""
