"""Damage found in downloaded meshes, drawn from a random stream of its own: vertices never depend on it."""

import numpy as np

from tetgan.shapes.builtin.draws import between, chance, pick
from tetgan.shapes.builtin.parts import Part

FLAWED_SHARE = 0.45  # of shapes
LARGEST_SHARE = 0.35  # of a part's faces that are flipped or repeated


def damage_parts(rng: np.random.Generator, parts: list[Part]) -> list[Part]:
    """The same parts with some faces flipped or repeated, whole parts inside out, or undersides missing."""
    if not chance(rng, FLAWED_SHARE):
        return parts
    flaw = pick(rng, {_flip_part: 2, _flip_faces: 2, _repeat_faces: 2, _open_underside: 0.6})
    struck = rng.random(len(parts)) < between(rng, 0.1, 0.5)
    struck[rng.integers(len(parts))] = True
    return [flaw(rng, part) if hit else part for part, hit in zip(parts, struck, strict=True)]


def _flip_part(_: np.random.Generator, part: Part) -> Part:
    return Part(part.vertices, part.faces[:, ::-1])


def _flip_faces(rng: np.random.Generator, part: Part) -> Part:
    flipped = _some_faces(rng, part)
    return Part(part.vertices, np.where(flipped[:, None], part.faces[:, ::-1], part.faces))


def _repeat_faces(rng: np.random.Generator, part: Part) -> Part:
    return Part(part.vertices, np.concatenate([part.faces, part.faces[_some_faces(rng, part)]]))


def _open_underside(_: np.random.Generator, part: Part) -> Part:
    """Without the faces that look straight down, where a modeller expects nobody to look."""
    a, b, c = part.vertices[part.faces].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    hidden = normals[:, 1] < -0.99 * np.linalg.norm(normals, axis=1)
    return part if hidden.all() else Part(part.vertices, part.faces[~hidden])


def _some_faces(rng: np.random.Generator, part: Part) -> np.ndarray:
    chosen = rng.random(len(part.faces)) < between(rng, 0.05, LARGEST_SHARE)
    chosen[rng.integers(len(part.faces))] = True
    return chosen
