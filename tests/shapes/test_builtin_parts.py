"""Parts that built-in shapes are made of."""

import numpy as np
import pytest
import trimesh

from tetgan.geometry.triangles import join_meshes
from tetgan.shapes.builtin import parts

ARC = np.linspace(0, 1, 9)
GRID = np.stack([*np.meshgrid(ARC, ARC, indexing="ij"), np.zeros((9, 9))], axis=-1)

CLOSED = {
    "box": parts.box((1, 2, 3), (0, 1, 0)),
    "rounded_box": parts.rounded_box((1, 2, 3), (0, 0, 0), 0.3, bulge=(0, 0.2, 0)),
    "slab": parts.slab(parts.outline(1, 2, exponent=4, taper=0.8), 0, 0.1, edge=0.02),
    "bar": parts.bar((0, 0, 0), (0, 1, 0.2), 0.1, taper=0.5),
    "tube": parts.tube(np.stack([ARC, ARC**2, 0 * ARC], axis=1), 0.1),
    "lathe": parts.lathe([[0.3, 0], [0.5, 0.5], [0.4, 1], [0.3, 1], [0.4, 0.5], [0.2, 0.1]]),
    "panel": parts.panel(GRID, 0.1),
}


def as_mesh(part: parts.Part) -> trimesh.Trimesh:
    return trimesh.Trimesh(part.vertices, part.faces, process=False)


@pytest.mark.parametrize("name", CLOSED)
def test_parts_are_closed_and_wound_outwards(name):
    mesh = as_mesh(CLOSED[name])
    assert mesh.is_watertight and mesh.is_winding_consistent and mesh.volume > 0


@pytest.mark.parametrize("name", CLOSED)
def test_reflecting_and_turning_keep_the_volume(name):
    part = CLOSED[name]
    assert as_mesh(part.mirrored()).volume == pytest.approx(as_mesh(part).volume)
    assert as_mesh(part.rotated("x", 33, (1, 2, 3))).volume == pytest.approx(as_mesh(part).volume)


@pytest.mark.parametrize(
    ("part", "volume"),
    [
        (parts.box((1, 2, 3), (4, 5, 6)), 6.0),
        (parts.slab(parts.outline(2, 3), 0, 0.5), 3.0),
        (parts.bar((0, 0, 0), (0, 2, 0), (0.2, 0.3), square=True), 0.12),
        (parts.panel(GRID, 0.1), 0.1),
        # Prism over a regular polygon of n corners, radius r: n/2 r^2 sin(2 pi / n) times the height.
        (parts.lathe([[0.5, 0], [0.5, 2]], section=parts.ellipse(6)), 3 * 0.25 * np.sin(np.pi / 3) * 2),
    ],
)
def test_volumes_known_by_hand(part, volume):
    assert as_mesh(part).volume == pytest.approx(volume)


def test_rotation_is_counterclockwise():
    tip = parts.Part(np.array([[1.0, 0.0, 0.0]]), np.zeros((0, 3), dtype=np.int64)).rotated("y", 90)
    np.testing.assert_allclose(tip.vertices, [[0, 0, -1]], atol=1e-12)


def test_twisting_turns_with_height():
    column = parts.Part(np.array([[1.0, 0, 0], [1.0, 1, 0], [1.0, 2, 0]]), np.array([[0, 1, 2]])).twisted(90)
    np.testing.assert_allclose(column.vertices, [[1, 0, 0], [0, 1, -1], [-1, 2, 0]], atol=1e-12)


def test_a_sheet_is_open():
    assert not as_mesh(parts.sheet(GRID)).is_watertight


def test_joined_parts_keep_their_own_vertices():
    joined = join_meshes([CLOSED["box"], CLOSED["bar"]])
    assert len(joined.vertices) == len(CLOSED["box"].vertices) + len(CLOSED["bar"].vertices)
    assert as_mesh(joined).body_count == 2
