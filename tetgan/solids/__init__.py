"""Solid tet meshes: their files, certificates and folders of samples."""
