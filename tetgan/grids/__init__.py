"""Tetrahedral grids of the unit cube: lattice, subdivision hierarchy, `.tet` files."""
