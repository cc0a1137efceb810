"""Built-in shapes by category, index and seed."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from tetgan.errors import UserError
from tetgan.shapes.builtin.bench import make_bench
from tetgan.shapes.builtin.car import make_car
from tetgan.shapes.builtin.chair import make_chair
from tetgan.shapes.builtin.flaws import damage_parts
from tetgan.shapes.builtin.parts import Part, join_parts
from tetgan.shapes.builtin.sofa import make_sofa
from tetgan.shapes.builtin.table import make_table
from tetgan.shapes.builtin.vase import make_vase

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
class BuiltinShape:
    """A triangle soup, vertices (V, 3) and faces (F, 3), and its structural kind, as slatted/sled/no-arms."""

    vertices: Float[np.ndarray, "V 3"]
    faces: Int[np.ndarray, "F 3"]
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
    soup = join_parts(damage_parts(flaws, parts))
    return BuiltinShape(soup.vertices, soup.faces, structure)
