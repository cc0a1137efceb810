"""Studies beside the tables: resolution, smoothing, the latent space, and how new samples are."""
