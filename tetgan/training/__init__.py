"""Training of every model: one loop, its data, checkpoints, log and learners."""
