"""Small surfaces built in code."""

import numpy as np

from tetgan.geometry.triangles import TriangleMesh

_BOX_FACES = np.array(
    [
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ]
)  # fmt: skip


def box(
    size: tuple[float, float, float] = (1, 1, 1), centre: tuple[float, float, float] = (0, 0, 0)
) -> TriangleMesh:
    """Closed box of 12 faces, oriented outward; corner 4x + 2y + z has its sides by the bits."""
    corners = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij"), axis=-1).reshape(-1, 3) - 0.5
    return TriangleMesh(corners * np.array(size, dtype=float) + np.array(centre, dtype=float), _BOX_FACES)


def join(*soups: TriangleMesh) -> TriangleMesh:
    """All triangles in one soup."""
    starts = np.cumsum([0, *(len(soup.vertices) for soup in soups)])
    return TriangleMesh(
        np.concatenate([soup.vertices for soup in soups]),
        np.concatenate([soup.faces + start for soup, start in zip(soups, starts, strict=False)]),
    )


def without_side(soup: TriangleMesh, axis: int, side: int) -> TriangleMesh:
    """A box missing the two faces of one side (0 low, 1 high)."""
    level = (soup.vertices.min(axis=0), soup.vertices.max(axis=0))[side][axis]
    return TriangleMesh(soup.vertices, soup.faces[(soup.triangles[:, :, axis] != level).any(axis=1)])


def lathe(profile: list[tuple[float, float]], sections: int = 32) -> TriangleMesh:
    """Profile of (radius, height) turned about the y axis, as strips; zero radii make slivers, not caps."""
    radius, height = np.array(profile).T
    angle = np.linspace(0, 2 * np.pi, sections, endpoint=False)
    vertices = np.stack(
        [np.outer(radius, np.cos(angle)), np.tile(height, (sections, 1)).T, np.outer(radius, np.sin(angle))],
        axis=-1,
    ).reshape(-1, 3)
    ring, turn = np.meshgrid(np.arange(len(profile) - 1), np.arange(sections), indexing="ij")
    a, b = ring * sections + turn, ring * sections + (turn + 1) % sections
    quads = np.stack([a, a + sections, b + sections, b], axis=-1).reshape(-1, 4)
    return TriangleMesh(vertices, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]))


def write_off(soup: TriangleMesh) -> bytes:
    """The soup as an OFF file."""
    lines = ["OFF", f"{len(soup.vertices)} {len(soup.faces)} 0"]
    lines += [" ".join(map(repr, map(float, vertex))) for vertex in soup.vertices]
    lines += [" ".join(map(str, (3, *face))) for face in soup.faces]
    return ("\n".join(lines) + "\n").encode()
