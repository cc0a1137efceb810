"""How the systems that TetGAN is compared with are trained."""
