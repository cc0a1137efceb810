"""Studies beside the tables: what resolution costs, and what smoothing does."""
