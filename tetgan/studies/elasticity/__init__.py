"""Linear elasticity on tet meshes: materials, regions, assembly, solver, and what comes of it."""
