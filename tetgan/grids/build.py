"""From options to grids."""

from tetgan.errors import UserError
from tetgan.grids.hierarchy import GridHierarchy, build_hierarchy, subdivide_hierarchy
from tetgan.grids.options import GridOptions
from tetgan.grids.tetfile import read_tet


def grid_from_options(options: GridOptions) -> GridHierarchy:
    """The hierarchy that `options` describe.

    Raises:
        UserError: the `.tet` file is missing, malformed or reaches outside the unit cube.
    """
    if options.cells is not None:
        return build_hierarchy(options.cells, options.depth)
    assert options.file is not None  # the options hold exactly one of the two
    try:
        return subdivide_hierarchy(read_tet(options.file), options.depth)
    except ValueError as error:
        raise UserError(f"{options.file}: {error}; scale it to fit") from None
