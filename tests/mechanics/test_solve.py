"""The two solvers: the same answer, the same each time."""

import numpy as np
import pytest

from tetgan.geometry.tets import TetMesh
from tetgan.mechanics.assembly import Body, rigid_motions, stiffness
from tetgan.mechanics.errors import UnfitError
from tetgan.mechanics.materials import MATERIALS
from tetgan.mechanics.options import LoadCase
from tetgan.mechanics.simulation import simulate
from tetgan.mechanics.solver import solve


@pytest.fixture(scope="module")
def by_both(crooked):
    return [simulate(crooked, LoadCase(), direct_below=limit) for limit in (10**9, 1)]


def test_direct_and_multigrid_agree(by_both):
    direct, multigrid = by_both
    assert (direct.solution.method, multigrid.solution.method) == ("direct", "multigrid")
    assert direct.solution.iterations == 0 < multigrid.solution.iterations < 60
    peak = np.abs(direct.displacement).max()
    # The residual is 1e-8 of the load, and the condition number below 1e3 here.
    np.testing.assert_allclose(multigrid.displacement, direct.displacement, atol=1e-6 * peak)
    assert max(found.record()["imbalance"] for found in by_both) < 1e-7


def test_the_same_bytes_again_and_the_global_generator_left_alone(crooked, by_both):
    np.random.seed(7)  # noqa: NPY002
    state = np.random.get_state()[1].copy()  # noqa: NPY002
    again = simulate(crooked, LoadCase(), direct_below=1)
    assert np.array_equal(again.displacement, by_both[1].displacement)
    assert np.array_equal(np.random.get_state()[1], state)  # noqa: NPY002


def test_the_order_of_vertices_and_tets_does_not_matter(crooked, by_both):
    generator = np.random.default_rng(1)
    place = generator.permutation(len(crooked.vertices))
    tets = np.argsort(place)[crooked.tets][generator.permutation(len(crooked.tets))]
    found = simulate(TetMesh(crooked.vertices[place], tets[:, [1, 2, 0, 3]]), LoadCase())
    peak = np.abs(found.displacement).max()
    np.testing.assert_allclose(found.displacement, by_both[0].displacement[place], atol=1e-9 * peak)


def test_equations_without_a_solution_are_refused(crooked):
    body = Body(*crooked, 1)
    matrix, push = stiffness(body, MATERIALS["steel"]), np.ones(3 * len(body.nodes))
    with pytest.raises(UnfitError, match="not solved"):
        solve(matrix, push, np.zeros(len(push), dtype=bool), rigid_motions(body.nodes), direct_below=1)
