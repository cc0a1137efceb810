"""Eq. 5."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tetgan.fields.field import Field, VertexField, surface_tets
from tetgan.meshing.filtering import filter_occupancy

fixtures_are_constant = settings(
    max_examples=20, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


@given(seed=st.integers(0, 2**32 - 1), share=st.floats(0, 1), gamma=st.floats(0.1, 3))
@fixtures_are_constant
def test_it_agrees_with_a_loop(seed, share, gamma, grid, make_field):
    field, mu = make_field(seed, share), 0.03
    kept = filter_occupancy(field, grid.neighbors, mu, gamma)
    for tet, occupied in enumerate(field.occupancy):
        on_surface = any(other < 0 or not field.occupancy[other] for other in grid.neighbors[tet])
        far = np.linalg.norm(field.displacement[tet].astype(float)) > gamma * mu
        assert kept[tet] == (occupied and not (on_surface and far))


def test_inner_tets_stay_however_far_they_are(grid):
    full = np.ones(len(grid.tets), dtype=bool)
    field = Field(full, np.ones((len(full), 3), dtype=np.float32))
    kept = filter_occupancy(field, grid.neighbors, mu=0.01, gamma=4.0)
    np.testing.assert_array_equal(kept, full & ~surface_tets(full, grid.neighbors))


def test_without_gamma_nothing_is_dropped(grid, make_field):
    field = make_field(0)
    assert (filter_occupancy(field, grid.neighbors, mu=1e-6, gamma=4.0) != field.occupancy).any()
    np.testing.assert_array_equal(
        filter_occupancy(field, grid.neighbors, mu=1e-6, gamma=None), field.occupancy
    )


def test_displacements_at_vertices_have_nothing_to_compare(grid, make_field):
    far = np.ones((len(grid.vertices), 3), dtype=np.float32)
    field = VertexField(make_field(0).occupancy, far)
    np.testing.assert_array_equal(filter_occupancy(field, grid.neighbors, 1e-6, 4.0), field.occupancy)


@pytest.mark.parametrize("share", [0, 1])
def test_nothing_and_everything(grid, make_field, share):
    field = make_field(0, share)
    np.testing.assert_array_equal(filter_occupancy(field, grid.neighbors, mu=1.0, gamma=4.0), field.occupancy)
