"""Principal components of the fields."""
