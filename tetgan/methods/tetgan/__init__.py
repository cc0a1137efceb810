"""TetGAN (Gao et al., BMVC 2022): a VAE on tetrahedral grids with two critics."""
