"""Off-screen pictures of surfaces and solids by ray casting; no display or graphics driver is needed."""
