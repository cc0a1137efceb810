"""Whole simulations against closed forms: a bar in tension, a body under its weight, a cantilever."""

import numpy as np
import pytest

from tetgan.mechanics.materials import Material
from tetgan.mechanics.options import LoadCase
from tetgan.mechanics.simulation import GRAVITY, simulate

STUFF = Material(young=1e9, poisson=0.3, density=1000)
SIDE = 0.1
AREA = SIDE**2
ROOT, TIP = "0,0,0:0,1,1", "1,0,0:1,1,1"
ORDERS = pytest.mark.parametrize("order", [1, 2])


@ORDERS
def test_a_bar_in_tension_is_exact(bar, order):
    """Sliding supports leave the section free to get thinner: u = (x, -nu y, -nu z) F / (E A)."""
    solid = bar(5, 2)
    fix = [f"{ROOT}/x", "0,0,0:1,0,1/y", "0,0,0:1,1,0/z"]
    case = LoadCase(material=STUFF, fix=fix, load=[f"{TIP}=100,0,0N"], order=order)
    found = simulate(solid, case)
    strain = 100 / (STUFF.young * AREA)
    expected = strain * solid.vertices * np.array([1, -STUFF.poisson, -STUFF.poisson])
    np.testing.assert_allclose(found.displacement, expected, atol=1e-9 * strain)
    np.testing.assert_allclose(found.stress, 100 / AREA, rtol=1e-8)
    assert found.work == pytest.approx(100 * strain)
    assert found.reaction == pytest.approx([-100, 0, 0], abs=1e-6)


def test_a_column_shortens_under_its_own_weight(bar):
    """Without Poisson's effect the top sinks by rho g L^2 / 2E: a quadratic displacement."""
    solid = bar(8, 1)
    upright = solid._replace(vertices=solid.vertices[:, [1, 0, 2]], tets=solid.tets[:, [0, 2, 1, 3]])
    stuff = STUFF.model_copy(update={"poisson": 0.0})
    case = LoadCase(material=stuff, load=["top=0N"], gravity=True, size=2.0, reach=0.001)
    found = simulate(upright, case)
    assert found.mass == pytest.approx(2 * (2 * SIDE) ** 2 * stuff.density)
    assert found.load == pytest.approx([0, -found.mass * GRAVITY, 0])
    assert found.reaction == pytest.approx([0, found.mass * GRAVITY, 0], abs=1e-8)
    top = found.vertices[:, 1] == 1
    expected = stuff.density * GRAVITY * 2.0**2 / (2 * stuff.young)
    assert -found.displacement[top, 1] == pytest.approx(expected, rel=1e-9)


def timoshenko() -> float:
    """Sag of the tip of a cantilever under 1 N: bending and shear (Cowper 1966, square section)."""
    second_moment = SIDE**4 / 12
    shear = STUFF.young / (2 * (1 + STUFF.poisson))
    coefficient = 10 * (1 + STUFF.poisson) / (12 + 11 * STUFF.poisson)
    return 1 / (3 * STUFF.young * second_moment) + 1 / (coefficient * shear * AREA)


def sag(solid, order: int) -> float:
    """Mean of the tip's displacement along the load of 1 N, which is the load's work."""
    case = LoadCase(material=STUFF, fix=[ROOT], load=[f"{TIP}=1N"], order=order)
    return simulate(solid, case).work


def test_a_quadratic_cantilever_bends_as_timoshenko_says(bar):
    sags = np.array([sag(bar(10 * n, n), 2) for n in (1, 2, 4)])
    assert sags[1:] == pytest.approx(timoshenko(), rel=0.02)
    assert (np.diff(sags) > 0).all()  # finer meshes are softer
    order = np.log2((sags[1] - sags[0]) / (sags[2] - sags[1]))
    assert order >= 1.8


def test_linear_elements_lock_in_bending(bar):
    """One layer has a quarter of the sag, four layers not yet nine tenths: what `order` is for."""
    sags = np.array([sag(bar(10 * n, n), 1) for n in (1, 2, 4)]) / timoshenko()
    assert sags[0] < 0.3 and sags[1] < 0.6 and sags[2] < 0.9
    assert (np.diff(sags) > 0).all()
