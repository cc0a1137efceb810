"""Occupancy and displacement on a grid, and the Zarr store that holds them."""
