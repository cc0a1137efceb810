"""Fixtures of these tests."""

from clouds import clouds, extractor  # noqa: F401
