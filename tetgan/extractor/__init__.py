"""The PointNet++ classifier whose features FID and KID compare."""
