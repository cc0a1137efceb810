"""Ground-truth fields in place of a model."""
