"""Surface meshes: sources, built-in shapes, repair, normalisation, surface sampling."""
