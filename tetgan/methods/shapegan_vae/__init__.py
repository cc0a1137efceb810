"""ShapeGAN (Kleineberg et al. 2020), the voxel VAE."""
