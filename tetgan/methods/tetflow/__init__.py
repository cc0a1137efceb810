"""TetFlow: an autoencoder on active sets of tets, and a flow that draws its codes."""
