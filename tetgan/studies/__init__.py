"""Studies of trained models: what their latent space holds, and how new their samples are."""
