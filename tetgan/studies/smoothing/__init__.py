"""Effect of displacement and smoothing on surfaces."""
