"""Metrics on surfaces and point clouds, with their intervals."""
