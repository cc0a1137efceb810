"""Fixtures of the methods' tests."""

from balls import coarse_voxels, indexes, points, voxels  # noqa: F401
from chairs import index, tiny_index  # noqa: F401
