"""ShapeGAN (Kleineberg et al. 2020), the GAN."""
