"""Built-in shapes by category, index and seed."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tetgan.errors import UserError
from tetgan.geometry.triangles import TriangleMesh, area_normals, join_meshes
from tetgan.shapes.builtin.bench import make_bench
from tetgan.shapes.builtin.car import make_car
from tetgan.shapes.builtin.chair import make_chair
from tetgan.shapes.builtin.draws import between, chance, pick
from tetgan.shapes.builtin.parts import Part
from tetgan.shapes.builtin.sofa import make_sofa
from tetgan.shapes.builtin.table import make_table
from tetgan.shapes.builtin.vase import make_vase

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
    normals = area_normals(part.triangles)
    hidden = normals[:, 1] < -0.99 * np.linalg.norm(normals, axis=1)
    return part if hidden.all() else Part(part.vertices, part.faces[~hidden])


def _some_faces(rng: np.random.Generator, part: Part) -> np.ndarray:
    chosen = rng.random(len(part.faces)) < between(rng, 0.05, LARGEST_SHARE)
    chosen[rng.integers(len(part.faces))] = True
    return chosen


Maker = Callable[[np.random.Generator], tuple[list[Part], str]]

MAKERS: dict[str, Maker] = {
    "chair": make_chair,
    "sofa": make_sofa,
    "bench": make_bench,
    "table": make_table,
    "car": make_car,
    "vase": make_vase,
}

CATEGORIES = tuple(MAKERS)


@dataclass(frozen=True, eq=False)
class BuiltinShape(TriangleMesh):
    """A triangle soup and its structural kind, as slatted/sled/no-arms."""

    structure: str


def generate_shape(category: str, index: int, seed: int) -> BuiltinShape:
    """Shape number `index` of a category: y up, front towards +z, in metres, not normalised.

    A shape depends on these three arguments only, never on how many are made.

    Raises:
        UserError: an unknown category.
    """
    if category not in MAKERS:
        raise UserError(
            f"category '{category}' has no built-in shapes; choose one of {', '.join(CATEGORIES)}"
        )
    # The name, not its place in the list: a new category must not change the others.
    key = [int.from_bytes(category.encode()), seed, index]
    geometry, flaws = (np.random.default_rng([*key, stream]) for stream in range(2))
    parts, structure = MAKERS[category](geometry)
    soup = join_meshes(damage_parts(flaws, parts))
    return BuiltinShape(soup.vertices, soup.faces, structure)
