"""Triangle and tet meshes: adjacency, components, volume, inside, rays."""
