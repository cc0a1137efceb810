"""Named parts of a boundary, for the supports and loads of a solver."""

import logging
import re
from collections.abc import Mapping, Sequence

import numpy as np

from tetgan.errors import UserError
from tetgan.geometry.adjacency import FACES, boundary_sides
from tetgan.geometry.tets import TetMesh
from tetgan.solids.abaqus import ELEMENTS
from tetgan.solids.elements import Groups
from tetgan.solids.regions import REACH, SURFACE, BoundaryFaces, emptiness, faces_of_tets, find_faces

log = logging.getLogger(__name__)

DEFAULT = ("floor", "top", SURFACE)
"""Regions that are groups by themselves."""

RESERVED = ("nodes", "solid")
"""Names that `.inp` and `.msh` have for the whole mesh."""

_NAME = re.compile(r"[A-Za-z]\w{0,39}", re.ASCII)


def parse_groups(texts: Sequence[str]) -> dict[str, str]:
    """Regions by name, from `name=region`; see `find_faces` for what a region may be.

    Raises:
        UserError: another form, a name that solvers do not take, or the same name twice.
    """
    groups: dict[str, str] = {}
    for text in texts:
        name, _, region = text.partition("=")
        if not region:
            raise UserError(f"--group: '{text}' is not of the form name=region, such as 'seat=y=0.4'")
        if not _NAME.fullmatch(name):
            raise UserError(f"--group: '{name}' is no name; use a letter, then up to 39 letters, digits, '_'")
        if name.casefold().endswith(ELEMENTS):
            raise UserError(f"--group: '{name}' ends with '{ELEMENTS}', as sets of elements do; shorten it")
        if name.casefold() in (*RESERVED, *map(str.casefold, groups)):
            raise UserError(f"--group: the name '{name}' is taken, in capitals or not; choose another one")
        groups[name] = region
    return groups


def choose_groups(mesh: TetMesh, named: Mapping[str, str], reach: float = REACH) -> Groups:
    """Faces of the groups in `DEFAULT`, and of others; one of the same name takes a default's place.

    Returns:
        of each name which of the faces of `boundary_sides` it has. A default without faces is left out.

    Raises:
        UserError: no such region, or nothing in it.
    """
    faces = _boundary(mesh)
    taken = set(map(str.casefold, named))
    groups = {}
    for name, region in {**{name: name for name in DEFAULT if name not in taken}, **named}.items():
        try:
            chosen = find_faces(region, faces, reach)
        except UserError as error:
            raise UserError(f"--group: {error}") from None
        if chosen.any():
            groups[name] = chosen
        elif name in named:
            raise UserError(f"--group: {emptiness(region, faces)}")
        else:
            log.warning("no group '%s': no face of the mesh looks there", name)
    return groups


def _boundary(mesh: TetMesh) -> BoundaryFaces:
    rows, slots = boundary_sides(mesh.tets)
    tets = mesh.tets[rows]
    corners = np.take_along_axis(tets, FACES[slots], axis=1)
    return faces_of_tets(mesh.vertices[corners], mesh.vertices[tets])
