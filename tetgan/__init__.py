"""Learned tetrahedral mesh generation: TetGAN (Gao et al., BMVC 2022) as a library and a workflow."""

from importlib.metadata import version

__version__ = version("tetgan")
