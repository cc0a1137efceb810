"""Pairs of faces that meet, against exact fractions and known surfaces."""

from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
import trimesh

from tetgan.geometry.adjacency import FACES, boundary_faces
from tetgan.geometry.intersections import self_intersections

CORNER = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])


def count_between(one, other):
    """Crossing pairs of two tets that share no vertex."""
    return len(self_intersections(np.concatenate([one, other]), np.concatenate([FACES, FACES + 4])))


def test_tets_apart_or_one_in_the_other_do_not_meet():
    assert count_between(CORNER, CORNER + 2) == 0
    assert count_between(CORNER, 0.2 * CORNER + 0.1) == 0


def test_a_tip_through_a_face_crosses_it_with_three_faces():
    # The tip comes through the face z = 0 from below and ends inside.
    spike = np.array([[0.2, 0.2, -1], [0.3, 0.2, -1], [0.2, 0.3, -1], [0.2, 0.2, 0.1]])
    assert count_between(CORNER, spike) == 3


def test_coincident_vertices_that_are_not_shared_touch():
    # Three faces of each tet have the vertex, (1, 0, 0).
    assert count_between(CORNER, CORNER + np.array([1, 0, 0])) == 9


def test_faces_that_lie_on_each_other_are_found():
    below = np.array([[0.25, 0.25, 0], [0.5, 0.25, 0], [0.25, 0.5, 0], [0.25, 0.25, -1]])
    assert count_between(CORNER, below) == 4  # the face on z = 0, and the three that end on it


def test_shared_vertices_and_edges_are_no_intersections():
    mirrored = np.concatenate([CORNER, -CORNER[1:]])
    tets = np.array([[0, 1, 2, 3], [0, 4, 5, 6]])
    assert len(self_intersections(mirrored, tets[:, FACES].reshape(-1, 3))) == 0


@pytest.mark.parametrize("other", [[0, 1, 3], [1, 0, 3], [3, 0, 1]])
def test_a_face_folded_onto_its_neighbour_is_found_whichever_way_it_turns(other):
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0.2, 0.5, 0]])
    assert self_intersections(vertices, np.array([[0, 1, 2], other])).tolist() == [[0, 1]]
    vertices[3, 1] = -0.5  # unfolded, flat
    assert len(self_intersections(vertices, np.array([[0, 1, 2], other]))) == 0
    vertices[3] = [0.2, 0.5, 1e-300]  # off the plane, by as little as there is
    assert len(self_intersections(vertices, np.array([[0, 1, 2], other]))) == 0


@pytest.mark.parametrize("seed", range(8))
def test_random_pairs_agree_with_exact_fractions(seed):
    """On a lattice of 3 or 4 points a side, where nearly every case is a degenerate one."""
    rng = np.random.default_rng(seed)
    for _ in range(60):
        vertices = rng.integers(0, 3 + seed % 2, (6, 3))
        vertices[:, 2] *= int(rng.random() < 0.8)
        second = [[3, 4, 5], [0, 3, 4], [0, 1, 3]][rng.integers(3)]
        faces = np.array([[0, 1, 2], rng.permutation(second)])
        corners = vertices[faces]
        if not np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).any(axis=1).all():
            continue
        if lie_along(vertices, *faces.tolist()):
            continue
        found = len(self_intersections(vertices.astype(float), faces)) > 0
        assert found == meet(vertices, *faces.tolist()), (vertices, faces)


def lie_along(vertices, one, other):
    """Whether edges of two faces lie along each other from their one common vertex: it is not looked for."""
    shared = set(one) & set(other)
    if len(shared) != 1:
        return False
    origin = vertices[shared.pop()].tolist()
    spokes = [[sub(vertices[i].tolist(), origin) for i in face] for face in (one, other)]
    return any(
        cross(a, b) == (0, 0, 0) and (on_segment(a, (0, 0, 0), b) or on_segment(b, (0, 0, 0), a))
        for a in spokes[0]
        for b in spokes[1]
        if any(a) and any(b)
    )


def test_round_and_flat_surfaces_are_clean(grid):
    sphere, box = trimesh.creation.icosphere(3), trimesh.creation.box().subdivide().subdivide()
    for mesh in (sphere, box):
        assert len(self_intersections(np.array(mesh.vertices), np.array(mesh.faces, dtype=np.int64))) == 0
    # Random tets of a lattice: full of coplanar faces, of edges of four faces and of pinched vertices.
    tets = grid.tets[np.random.default_rng(0).random(len(grid.tets)) < 0.5]
    assert len(self_intersections(grid.vertices, boundary_faces(tets))) == 0


def test_two_spheres_cross_where_a_denser_test_says_so():
    one = trimesh.creation.icosphere(2)
    other = one.copy().apply_translation([0.5, 0.1, 0.05])
    both = trimesh.util.concatenate([one, other])
    pairs = self_intersections(np.array(both.vertices), np.array(both.faces, dtype=np.int64))
    # Faces with corners inside of and outside the other sphere cross it.
    for own, theirs, column in ((one, other, 0), (other, one, 1)):
        inside = theirs.contains(own.vertices)[own.faces]
        crossing = np.flatnonzero(inside.any(axis=1) & ~inside.all(axis=1)) + column * len(one.faces)
        assert set(crossing) <= set(pairs.ravel().tolist())
    assert (pairs[:, 0] < len(one.faces)).all() and (pairs[:, 1] >= len(one.faces)).all()


def test_no_faces_do_not_meet():
    assert self_intersections(np.empty((0, 3)), np.empty((0, 3), dtype=np.int64)).shape == (0, 2)


def meet(vertices, one, other):
    """Whether two faces meet anywhere but in the vertices, or the edge, that they share.

    What two triangles share is convex, and its corners are corners of one in the other, or points where an
    edge of one meets the other.
    """
    corners = [[tuple(int(x) for x in vertices[i]) for i in face] for face in (one, other)]
    shared = [tuple(int(x) for x in vertices[i]) for i in set(one) & set(other)]
    points = []
    for triangle, second in (corners, corners[::-1]):
        points += [p for p in triangle if in_triangle(p, second)]
        for edge in combinations(triangle, 2):
            points += edge_points(edge, second)
    if len(shared) == 3:
        return True
    if len(shared) == 2:
        return any(not on_segment(p, *shared) for p in points)
    return any(p != shared[0] for p in points) if shared else bool(points)


def edge_points(edge, triangle):
    """Ends of what an edge and a triangle share, those inside of the edge at least."""
    normal = cross(sub(triangle[1], triangle[0]), sub(triangle[2], triangle[0]))
    above, below = (dot(normal, sub(end, triangle[0])) for end in edge)
    if above == below == 0:
        sides = combinations(triangle, 2)
        return [p for side in sides if (p := segment_crossing(edge, side)) is not None]
    if above * below > 0:
        return []
    point = along(edge, Fraction(above, above - below))
    return [point] if in_triangle(point, triangle) else []


def segment_crossing(one, other):
    """Where two segments of a plane that are not parallel cross."""
    d, f, w = sub(one[1], one[0]), sub(other[1], other[0]), sub(other[0], one[0])
    normal = cross(d, f)
    if normal == (0, 0, 0):
        return None
    s, r = (Fraction(dot(cross(w, v), normal), dot(normal, normal)) for v in (f, d))
    return along(one, s) if 0 <= s <= 1 and 0 <= r <= 1 else None


def in_triangle(p, t):
    normal = cross(sub(t[1], t[0]), sub(t[2], t[0]))
    if dot(normal, sub(p, t[0])):
        return False
    return all(dot(normal, cross(sub(t[(i + 1) % 3], t[i]), sub(p, t[i]))) >= 0 for i in range(3))


def on_segment(p, start, end):
    d, w = sub(end, start), sub(p, start)
    return cross(d, w) == (0, 0, 0) and 0 <= dot(w, d) <= dot(d, d)


def along(segment, share):
    return tuple(a + share * (b - a) for a, b in zip(*segment, strict=True))


def sub(a, b):
    return tuple(x - y for x, y in zip(a, b, strict=True))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))
