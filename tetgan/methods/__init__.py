"""Generative methods, one folder each: options, network, training."""
