"""What displacement and each smoothing do to surfaces."""
