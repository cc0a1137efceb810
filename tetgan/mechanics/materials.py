"""Linearly elastic materials, and presets of them."""

from pydantic import Field

from tetgan.errors import UserError
from tetgan.options import Options
from tetgan.solids.abaqus import Section
from tetgan.solids.units import UnitSystem


class Material(Options):
    """An isotropic, linearly elastic material."""

    young: float = Field(gt=0, description="Young's modulus, Pa")
    poisson: float = Field(gt=-1, lt=0.5, description="Poisson's ratio; elements of this kind lock near 0.5")
    density: float = Field(gt=0, description="density, kg/m^3, for gravity and the mass")

    @property
    def lame(self) -> tuple[float, float]:
        """Lamé's constants, lambda and mu, in Pa."""
        shear = self.young / (2 * (1 + self.poisson))
        return 2 * shear * self.poisson / (1 - 2 * self.poisson), shear


MATERIALS = {
    "pinewood": Material(young=11.2e9, poisson=0.33, density=515),
    "steel": Material(young=210e9, poisson=0.3, density=7850),
    "rubber": Material(young=1.5e6, poisson=0.49, density=950),
}
"""Presets.

pinewood: red pine at 12 % moisture along the grain, taken as isotropic. Forest Products Laboratory, Wood
Handbook (FPL-GTR-190, 2010): modulus of elasticity 11.2 GPa and specific gravity 0.46, table 5-3a (the
modulus from bending, so a tenth below that along the grain by its footnote; the gravity of the oven-dry
mass, so 1.12 times that with its water); Poisson's ratio the mean of LR (0.347) and LT (0.315), table 5-2.
Across the grain it has 0.044 and 0.088 of that modulus, table 5-1, which is neglected.
steel: structural steel, EN 1993-1-1:2005, 3.2.6; unit weight 77.0 kN/m^3 by EN 1991-1-1:2002, table A.4.
rubber: vulcanised natural rubber at small strain, MatWeb's datasheet of that name: shear modulus 0.5 MPa, a
third of Young's, and 950 kg/m^3. It keeps its volume, so its ratio is all but 0.5; taken as 0.49.
"""


def section_of(name: str, material: Material, system: UnitSystem) -> Section:
    """The material in the units of a solver's file."""
    return Section(name, system.stress(material.young), material.poisson, system.density(material.density))


def read_material(text: str) -> str:
    """A preset's name.

    Raises:
        UserError: there is none of that name.
    """
    if text not in MATERIALS:
        raise UserError(
            f"--material: no preset '{text}'; known are {', '.join(MATERIALS)}, "
            "or give numbers: '{young: 1e10, poisson: 0.3, density: 500}'"
        )
    return text
