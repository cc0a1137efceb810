"""Studies beside the tables: resolution, smoothing, latent space."""
