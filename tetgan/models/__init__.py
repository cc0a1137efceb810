"""Contracts of generative methods: generator, registry, load, save, sample, pack."""
