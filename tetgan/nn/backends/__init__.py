"""Kernels of the tetrahedral convolution, one module for each kind of machine."""
