"""Layers on tetrahedral grids: convolution, pooling, upsampling, normalisation."""
