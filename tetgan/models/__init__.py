"""TetGAN, its critics, the baselines, and the PointNet++ classifier."""
