"""Metrics on surfaces and point clouds, their intervals, and the tables made of them."""
