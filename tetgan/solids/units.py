"""Consistent systems of units for files of solvers, which know none, and lengths with a unit."""

import math
import re
from typing import NamedTuple

from tetgan.errors import UserError


class UnitSystem(NamedTuple):
    """Units of length and force; those of mass and stress follow from them and the second.

    Attributes:
        length: metres in one unit.
        force: newtons in one unit.
        names: the units in words: length, force, mass, time, stress.
    """

    length: float
    force: float
    names: str

    def stress(self, pascal: float) -> float:
        """A stress or modulus in force per squared length."""
        return pascal * self.length**2 / self.force

    def density(self, value: float) -> float:
        """A density, from kg/m^3, in the unit of mass per cubed length."""
        return value * self.length**4 / self.force


UNITS = {
    "m": UnitSystem(1.0, 1.0, "m, N, kg, s, Pa"),
    "cm": UnitSystem(1e-2, 1.0, "cm, N, 100 kg, s, N/cm2"),
    "mm": UnitSystem(1e-3, 1.0, "mm, N, tonne, s, MPa"),
    "in": UnitSystem(0.0254, 4.4482216152605, "in, lbf, lbf s2/in, s, psi"),
}
"""By the unit of length."""


def parse_length(text: str, units: str | None, name: str) -> float:
    """A length such as `0.02` or `5mm`, in the unit of a mesh.

    Args:
        units: of the mesh, one of `UNITS`; None where nobody knows it, and a number has to do.
        name: of the argument, for the error.

    Raises:
        UserError: no length, or one with a unit where that of the mesh is not known.
    """
    found = re.fullmatch(r"\s*([-+.\deE]+?)\s*(mm|cm|m|in)?\s*", text)
    try:
        value = float(found[1]) if found else math.nan
    except ValueError:
        value = math.nan
    if not (found and 0 < value < math.inf):
        raise UserError(f"{name}: '{text}' is no length; give a number, or one with {', '.join(UNITS)}")
    if found[2] is None:
        return value
    if units not in UNITS:
        raise UserError(
            f"{name}: '{text}' has a unit; say by --units what the mesh is in: {', '.join(UNITS)}"
        )
    return value * UNITS[found[2]].length / UNITS[units].length
