"""DefTet's surface network (Gao et al. 2020) on the boundary of a TetGAN's occupancy."""
