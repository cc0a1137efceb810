"""Linear elasticity of solids: assembly, solver, regions, and the study of samples."""
