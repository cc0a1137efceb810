"""Losses, schedules, and the loops that train every model."""
