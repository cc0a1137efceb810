"""Input files of Abaqus and CalculiX: nodes, elements, named sets and surfaces, and a material."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Int

from tetgan.solids.elements import Elements
from tetgan.solids.units import UnitSystem

_TYPES = {1: "C3D4", 2: "C3D10"}

_SIDES = np.array(
    [3, 4, 2, 1]
)  # S1 = 1-2-3, S2 = 1-4-2, S3 = 2-4-3, S4 = 3-4-1, by the local vertex opposite

ELEMENTS = "_elements"
"""What the name of a group's set of elements ends with."""

_PER_LINE = 10  # numbers of a set; both programs take 16 at most


class Section(NamedTuple):
    """An isotropic elastic material of the whole solid, in the units of the file.

    Attributes:
        young: Young's modulus, a stress.
        poisson: Poisson's ratio.
        density: mass per volume.
    """

    name: str
    young: float
    poisson: float
    density: float


def write_inp(path: Path, elements: Elements, system: UnitSystem, section: Section | None = None) -> None:
    """Write a mesh for `*INCLUDE`, without steps or loads.

    Of a group `floor` there is a node set and a surface `floor`, the nodes on its faces and the faces, and an
    element set `floor_elements` behind them. Were that called `floor` too, CalculiX would take it where the
    surface is meant, and know no faces. `nodes` and `solid` are the whole mesh. Numbers have 13 digits, since
    CalculiX reads no more than 20 characters of each.

    Args:
        system: units, named in a comment.
        section: of all elements; without it the file has none.
    """
    with path.open("w", encoding="ascii") as file:
        file.write(f"** Units: {system.names}\n*NODE, NSET=nodes\n")
        numbered = np.column_stack([1 + np.arange(len(elements.nodes)), elements.nodes])
        np.savetxt(file, numbered, "%d, %.12e, %.12e, %.12e")
        file.write(f"*ELEMENT, TYPE={_TYPES[elements.order]}, ELSET=solid\n")
        rows = np.column_stack([np.arange(len(elements.cells)), elements.cells]) + 1
        np.savetxt(file, rows, "%d", delimiter=", ")
        for name, chosen in elements.groups.items():
            file.write(f"*NSET, NSET={name}\n")
            file.writelines(_lines(elements.nodes_of(name)))
            file.write(f"*ELSET, ELSET={name}{ELEMENTS}\n")
            file.writelines(_lines(elements.cells_of(name)))
            file.write(f"*SURFACE, NAME={name}, TYPE=ELEMENT\n")
            tets, slots = (of_faces[chosen] for of_faces in elements.sides)
            np.savetxt(file, np.column_stack([1 + tets, _SIDES[slots]]), "%d, S%d")
        if section is not None:
            file.write(
                f"*MATERIAL, NAME={section.name}\n*ELASTIC\n{section.young:.9e}, {section.poisson:.9g}\n"
                f"*DENSITY\n{section.density:.9e}\n*SOLID SECTION, ELSET=solid, MATERIAL={section.name}\n"
            )


def _lines(members: Int[np.ndarray, "M"]) -> Iterator[str]:
    """Numbers of a set, counted from one."""
    for start in range(0, len(members), _PER_LINE):
        yield ", ".join(map(str, 1 + members[start : start + _PER_LINE])) + "\n"
