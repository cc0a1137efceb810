"""Systems that TetGAN is compared with."""
