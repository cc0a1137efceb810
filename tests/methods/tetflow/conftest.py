"""Fixtures of these tests."""

from boxes import store  # noqa: F401
