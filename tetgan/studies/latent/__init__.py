"""The latent space: interpolation, arithmetic, nearest training shapes."""
