"""The smoke run, made once for all tests."""

import pytest
from smoke_project import TARGETS, Project, planned


@pytest.fixture(scope="session")
def project(tmp_path_factory):
    return Project(tmp_path_factory.mktemp("project"))


@pytest.fixture(scope="session")
def untouched(tmp_path_factory):
    """Another copy, in which the smoke run has not been."""
    return Project(tmp_path_factory.mktemp("untouched"))


@pytest.fixture(scope="session")
def smoked(project):
    """The project after a whole smoke run, with the default run's plan before and after it."""
    before = planned(project.snakemake("-n", "results/tables/chair.csv"))
    result = project.smoke("paper", *TARGETS)
    assert result.returncode == 0, result.stdout + result.stderr
    after = planned(project.snakemake("-n", "results/tables/chair.csv"))
    return project, before, after
