"""OccNet without an input (Mescheder et al. 2019)."""
