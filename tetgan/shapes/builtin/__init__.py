"""Parametric shapes of six categories, any number of them: y up, front towards +z, about a metre in size.

`generate.generate_shape` is the only door. A category's module draws a shape and returns its closed parts
and open sheets; `flaws` then damages some of them the way downloaded meshes are damaged.
"""
