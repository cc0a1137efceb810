"""Certificates of meshes made by hand, each with one thing wrong, and of random parts of a lattice."""

from dataclasses import asdict
from itertools import combinations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tetgan.geometry.adjacency import boundary_faces
from tetgan.geometry.boundary import Boundary
from tetgan.grids.lattice import cube_lattice
from tetgan.solids.certificate import Certificate, certify

CORNER = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
REGULAR = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
TET = np.array([[0, 1, 2, 3]])


def cube_without(centres, grid):
    """The tets of a grid but those whose centroid lies within 0.2 of a centre, in the largest direction."""
    far = np.abs(grid.centroids[:, None] - np.asarray(centres)).max(axis=2).min(axis=1) > 0.2
    return certify(grid.vertices, grid.tets[far])


def side_by_side(one, other):
    """A mesh of two tets without a common vertex."""
    return np.concatenate([one, other]), np.array([[0, 1, 2, 3], [4, 5, 6, 7]])


def test_one_tet():
    found = certify(CORNER, TET)
    slanted = np.degrees(np.arccos(1 / np.sqrt(3)))
    ratio = 3 / (3 + np.sqrt(3)) / (np.sqrt(3) / 2)
    bins = [0] * 10
    bins[int(10 * ratio)] = 1
    assert asdict(found) == asdict(Certificate()) | {
        "tets": 1,
        "faces": 4,
        "min_dihedral": pytest.approx(slanted),
        "p1_dihedral": pytest.approx(slanted),
        "min_radius_ratio": pytest.approx(ratio),
        "radius_ratios": tuple(bins),
        "volume": pytest.approx(1 / 6),
        "components": 1,
        "manifold_edges": 1.0,
    }
    assert found.valid and found.reasons == []


def test_a_regular_tet_falls_into_the_last_bin():
    found = certify(
        REGULAR * 0.1 + 7, TET[:, [1, 0, 2, 3]] if np.linalg.det(REGULAR[1:] - REGULAR[0]) < 0 else TET
    )
    assert found.valid
    assert found.radius_ratios == (0,) * 9 + (1,)
    assert found.min_dihedral == pytest.approx(np.degrees(np.arccos(1 / 3)))


def test_a_cube_of_tets_is_valid(grid):
    found = certify(grid.vertices, grid.tets)
    assert found.valid
    assert found.volume == pytest.approx(1)
    assert (found.components, found.cavities, found.floating) == (1, 0, 0.0)
    assert sum(found.radius_ratios) == found.tets == len(grid.tets)


@pytest.mark.parametrize("flat", [False, True])
def test_an_inverted_or_flat_tet(flat):
    vertices = CORNER * ([1, 1, 0] if flat else [1, 1, -1])
    found = certify(vertices, TET)
    assert found.inverted_tets == 1
    assert "1 inverted tets" in found.reasons and not found.valid


def test_orientation_is_not_left_to_rounding():
    # Volume 0 to the last bit in floating point, though the last vertex lies above the plane of the others.
    vertices = CORNER + 0.5
    vertices[:3, 2] = 0
    vertices[3] = [12, 12, 5e-324]
    assert certify(vertices, TET).inverted_tets == 0
    vertices[3, 2] = -5e-324
    assert certify(vertices, TET).inverted_tets == 1


def test_two_tets_on_one_edge():
    vertices = np.array([[0.0, 0, 0], [0, 0, 1], [1, 0, 0], [1, 1, 0], [-1, 0, 0], [-1, -1, 0]])
    found = certify(vertices, np.array([[0, 1, 3, 2], [0, 1, 5, 4]])[:, [0, 1, 3, 2]])
    assert found.inverted_tets == 0
    # The edge has four faces, and at both of its ends there are two open fans.
    assert (found.nonmanifold_edges, found.nonmanifold_vertices) == (1, 2)
    assert found.manifold_edges == pytest.approx(10 / 11)
    assert (found.components, found.self_intersections, found.cavities) == (2, 0, 0)
    assert found.overlapping_shells is None
    assert found.reasons == ["1 non-manifold edges", "2 non-manifold vertices"]


def test_two_tets_on_one_vertex():
    vertices = np.concatenate([CORNER, -CORNER[1:]])
    found = certify(vertices, np.array([[0, 1, 2, 3], [0, 5, 4, 6]]))
    assert found.inverted_tets == 0
    assert found.reasons == ["1 non-manifold vertices"]
    assert found.manifold_edges == 1.0


def test_two_tets_that_cross():
    found = certify(*side_by_side(CORNER, CORNER + 0.1))
    assert found.self_intersections > 0
    assert found.reasons == [f"{found.self_intersections} self-intersections"]


def test_a_tet_within_another_is_not_seen_by_intersections():
    found = certify(*side_by_side(CORNER, 0.2 * CORNER + 0.1))
    assert found.self_intersections == 0
    assert found.overlapping_shells == 1
    assert not found.valid
    assert certify(*side_by_side(CORNER, CORNER + 2)).valid


def test_a_tet_folded_back_over_its_neighbour():
    # Both are positive, share a face, and lie on the same side of it.
    vertices = np.concatenate([CORNER, [[0.2, 0.2, 0.2]]])
    found = certify(vertices, np.array([[0, 1, 2, 3], [0, 1, 2, 4]]))
    assert (found.inverted_tets, found.folded_faces) == (0, 1)
    assert not found.valid


def test_a_tet_listed_twice_has_no_boundary():
    found = certify(CORNER, np.repeat(TET, 2, axis=0))
    assert (found.faces, found.folded_faces, found.components) == (0, 4, 1)
    assert found.reasons == ["4 inner faces with both tets on one side"]


def test_three_tets_on_one_face():
    vertices = np.concatenate([CORNER, [[0.2, 0.2, -1]], [[0.2, 0.2, 2]]])
    found = certify(vertices, np.array([[0, 1, 2, 3], [0, 2, 1, 4], [0, 1, 2, 5]]))
    assert found.crowded_faces == 1
    assert found.components == 1
    assert not found.valid


def test_vertices_in_the_same_place_do_not_join_tets():
    """What a writer that forgets to share vertices leaves: tets that touch in whole faces."""
    found = certify(*side_by_side(CORNER, (CORNER * [1, 1, -1])[[1, 0, 2, 3]]))
    assert found.inverted_tets == 0
    assert found.components == 2
    assert found.self_intersections > 0 and not found.valid


@pytest.mark.parametrize(("centres", "cavities"), [([[0.5] * 3], 1), ([[0.25] * 3, [0.75] * 3], 2)])
def test_a_cavity_is_counted_and_allowed(fine_grid, centres, cavities):
    found = cube_without(centres, fine_grid)
    assert found.cavities == cavities
    assert found.components == 1
    assert found.valid, found.reasons


def test_a_hole_through_the_cube_is_no_cavity(fine_grid):
    inside = np.abs(fine_grid.centroids[:, :2] - 0.5).max(axis=1) < 0.2
    found = certify(fine_grid.vertices, fine_grid.tets[~inside])
    assert (found.cavities, found.valid) == (0, True)


def test_a_piece_in_a_cavity_belongs_there(fine_grid):
    depth = np.abs(fine_grid.centroids - 0.5).max(axis=1)
    found = certify(fine_grid.vertices, fine_grid.tets[(depth > 0.3) | (depth < 0.15)])
    assert (found.components, found.cavities, found.overlapping_shells) == (2, 1, 0)
    assert found.valid


def test_voids_that_touch_in_an_edge_are_told_apart():
    """Two tets taken out of a lattice that share an edge only, and two that share a vertex."""
    grid = cube_lattice(3).grid
    inner = np.flatnonzero((np.abs(grid.vertices[grid.tets] - 0.5) < 0.49).all(axis=(1, 2)))
    seen = set()
    for one, other in combinations(inner, 2):
        shared = len(np.intersect1d(grid.tets[one], grid.tets[other]))
        if shared in (1, 2) and shared not in seen:
            seen.add(shared)
            found = certify(grid.vertices, np.delete(grid.tets, [one, other], axis=0))
            assert found.cavities == 2
            assert found.nonmanifold_edges == (1 if shared == 2 else 0)
            assert not found.valid
    assert seen == {1, 2}


def test_a_band_with_a_half_twist_cannot_be_oriented():
    """Five triangles in a ring: whichever way they turn, two neighbours disagree."""
    faces = np.array([[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 0], [4, 0, 1]])
    boundary = Boundary(faces)
    assert boundary.misoriented_edges == 1
    # Every edge of the rim has one face, and no fan around its five vertices closes.
    assert (boundary.nonmanifold_edges, boundary.nonmanifold_vertices) == (5, 5)


def test_pairs_that_turn_differently_are_misoriented():
    # The second tet is listed inverted, so the faces at the edges that they share turn the other way.
    vertices = np.concatenate([CORNER, [[0.2, 0.2, -1]]])
    found = certify(vertices, np.array([[0, 1, 2, 3], [0, 1, 2, 4]]))
    assert (found.inverted_tets, found.folded_faces, found.misoriented_edges) == (1, 1, 3)


def test_an_empty_mesh():
    found = certify(np.empty((0, 3)), np.empty((0, 4), dtype=np.int64))
    assert found == Certificate()
    assert found.reasons == ["no tets"] and not found.valid


def test_vertices_without_tets_do_not_count():
    assert certify(np.concatenate([CORNER, [[np.nan] * 3]]), TET) == certify(CORNER, TET)
    with pytest.raises(ValueError, match="finite"):
        certify(np.array([[np.inf] * 3, *CORNER[1:]]), TET)


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=10, deadline=None)
def test_numbering_place_and_size_play_no_part(seed):
    rng = np.random.default_rng(seed)
    lattice = cube_lattice(1).grid
    tets = lattice.tets[rng.random(len(lattice.tets)) < 0.6]
    if len(tets) == 0:
        return
    order = rng.permutation(len(lattice.vertices))
    even = np.array([[0, 1, 2, 3], [1, 2, 0, 3], [3, 1, 0, 2], [2, 3, 0, 1]])
    turned = np.take_along_axis(order[tets], even[rng.integers(4, size=len(tets))], axis=1)
    vertices = np.empty_like(lattice.vertices)
    vertices[order] = 4 * lattice.vertices + 2  # exact in binary
    one, other = certify(lattice.vertices, tets).row(), certify(vertices, rng.permutation(turned)).row()
    assert other.pop("volume") == pytest.approx(64 * one.pop("volume"))
    assert other == pytest.approx(one)


@given(seed=st.integers(0, 2**32 - 1), share=st.floats(0.01, 0.99))
@settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_counts_agree_with_naive_ones(seed, share, grid):
    chosen = np.flatnonzero(np.random.default_rng(seed).random(len(grid.tets)) < share)
    if len(chosen) == 0:
        return
    tets = grid.tets[chosen]
    found, faces = certify(grid.vertices, tets), boundary_faces(tets)
    edges = naive_edges(faces.tolist())
    assert found.nonmanifold_edges == sum(len(on) != 2 for on in edges.values())
    assert found.manifold_edges == pytest.approx(np.mean([len(on) == 2 for on in edges.values()]))
    assert found.nonmanifold_vertices == naive_pinched(faces.tolist(), edges)
    sizes = flood_sizes(set(chosen.tolist()), grid.neighbors)
    assert (found.components, found.floating) == (len(sizes), pytest.approx(1 - max(sizes) / len(chosen)))
    empty = flood_sizes(set(range(len(grid.tets))) - set(chosen.tolist()), grid.neighbors, outside=True)
    assert found.cavities == len(empty)
    assert (found.inverted_tets, found.folded_faces, found.misoriented_edges) == (0, 0, 0)
    assert found.self_intersections == 0  # in a lattice nothing crosses


def naive_edges(faces):
    """Faces of every edge."""
    found = {}
    for number, face in enumerate(faces):
        for pair in combinations(sorted(face), 2):
            found.setdefault(pair, []).append(number)
    return found


def naive_pinched(faces, edges):
    """Vertices whose faces are not one ring joined by edges of two faces."""
    pinched = 0
    for vertex in {v for face in faces for v in face}:
        around = {number for number, face in enumerate(faces) if vertex in face}
        joints = [on for edge, on in edges.items() if vertex in edge]
        parts = {number: number for number in around}
        for one, other in (on for on in joints if len(on) == 2):
            old, new = parts[one], parts[other]
            parts = {number: new if part == old else part for number, part in parts.items()}
        pinched += len(set(parts.values())) > 1 or any(len(on) != 2 for on in joints)
    return pinched


def flood_sizes(tets, neighbors, outside=False):
    """Tets of each connected part; with `outside` only of those that do not reach the wall."""
    sizes = []
    while tets:
        before, front, reaches_wall = len(tets), [tets.pop()], False
        while front:
            around = neighbors[front.pop()].tolist()
            reaches_wall |= -1 in around
            for other in around:
                if other in tets:
                    tets.remove(other)
                    front.append(other)
        if not (outside and reaches_wall):
            sizes.append(before - len(tets))
    return sizes
