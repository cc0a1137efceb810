"""Consistent systems of units for files of solvers, which know none."""

from typing import NamedTuple


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
