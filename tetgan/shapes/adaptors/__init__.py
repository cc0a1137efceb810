"""Layouts of public collections: each module finds the meshes of a category below a root folder.

`list_places(source, category)` yields (wished name, path below the root, split or None), in any order.
"""
