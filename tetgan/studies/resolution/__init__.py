"""The resolution that tetrahedra and voxels need for one torus."""
