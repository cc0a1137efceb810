"""Any surface to a certified solid, in the surface's own units and place."""

from dataclasses import asdict, dataclass
from pathlib import Path
from time import perf_counter
from typing import Any, Literal, NamedTuple

import igl
import numpy as np
from jaxtyping import Float
from pydantic import Field as Described

from tetgan.geometry.triangles import TriangleMesh, area_normals
from tetgan.grids.options import Interior
from tetgan.meshing.isosurface import Fit, drop_small_pieces
from tetgan.meshing.mesh_surface import REACH, Triangles, cut_surface
from tetgan.meshing.options import MeshingOptions
from tetgan.options import Options
from tetgan.shapes.cleaning import ShapeError
from tetgan.shapes.closing import Method, close_surface, count_pieces
from tetgan.shapes.loading import MESH_SUFFIXES, parse_mesh, read_file
from tetgan.shapes.options import RepairOptions
from tetgan.shapes.sampling import sample_surface
from tetgan.solids.certificate import Certificate, certify
from tetgan.solids.export import write_mesh
from tetgan.solids.solid import SolidMesh
from tetgan.solids.units import UNITS, parse_length

_FEWEST = 3  # cells along the cube of the coarsest lattice

_MOST_TETS = 2e7  # about 20 GiB

_POINTS = 20_000  # of each surface, for the distance between two


class SolidifyOptions(Options):
    """How finely a surface is filled, and what is done to it before."""

    edge: float | None = Described(
        None,
        gt=0,
        description="side of the lattice's cells, the longest edge near the surface, in mesh units",
    )
    cells: int = Described(48, ge=4, description="cells along the longest side, where no edge is given")
    units: Literal["m", "cm", "mm", "in"] | None = Described(
        None, description="unit of the mesh's coordinates; None where nobody knows it"
    )
    repair: Method = Described(
        "auto", description="auto: alpha_wrap where the surface encloses no volume by itself"
    )
    alpha: float = Described(
        0.02, gt=0, le=0.5, description="alpha_wrap: gaps up to twice this share of the longest side close"
    )
    interior: Interior = Described(
        "graded", description="tets inside: coarser the further from the surface, or all of one size"
    )
    min_dihedral: float = Described(15.0, ge=0, le=25, description="least dihedral angle, in degrees")
    min_component: float = Described(
        0.002, ge=0, le=1, description="pieces below this share of the volume are dropped"
    )
    timeout_seconds: float = Described(
        600.0, gt=0, description="processor time after which a mesh is given up"
    )


@dataclass(frozen=True)
class SolidifyReport:
    """What was made of a surface; lengths and volumes are in its own units.

    Attributes:
        seconds: from file or arrays to the certificate.
        repair: `none`, `turned` where faces pointed inward, or the method of repair.
        reason: why there was a repair.
        edge: side of the lattice's cells.
        tets: of the solid.
        volume_in, volume_out: of the surface after repair, and of the solid.
        hausdorff, mean_distance: between these two surfaces, from 20,000 points of each, uniform by area, to
            the other: the largest distance either way, and the mean of the two means. The true largest
            distance may be a little more.
        min_dihedral: least angle, in degrees.
        pieces_in, pieces_out: closed pieces of the surface after repair, and pieces of the solid.
        held: vertices of the boundary that bounds on angles keep off the surface.
        dropped, dropped_volume: small pieces left out, and their share of the volume.
    """

    seconds: float
    repair: str
    reason: str
    edge: float
    tets: int
    volume_in: float
    volume_out: float
    hausdorff: float
    mean_distance: float
    min_dihedral: float
    pieces_in: int
    pieces_out: int
    held: int
    dropped: int
    dropped_volume: float

    def row(self) -> dict[str, Any]:
        return asdict(self)


class Solidified(NamedTuple):
    """A solid in the units and place of the surface it was made of."""

    solid: SolidMesh
    certificate: Certificate
    report: SolidifyReport


Surface = str | Path | TriangleMesh | tuple[np.ndarray, np.ndarray]


def solidify(mesh: Surface, edge: float | str | None = None, **options: Any) -> Solidified:
    """Any surface to a certified solid: repair if need be, field, cut, certify.

    Args:
        mesh: a file (.obj .off .ply .stl .glb), a mesh, or its vertices (V, 3) and faces (F, 3).
        edge: side of the lattice's cells, in units of the mesh; by default a 48th of its longest side. A text
            may have a unit, `5mm`, where the option `units` tells that of the mesh.
        options: of `SolidifyOptions`.

    Raises:
        ShapeError: no solid can be made of it; the message says why.
        UserError: an unknown option or a bad value.
    """
    if isinstance(edge, str):
        edge = parse_length(edge, options.get("units"), "edge")
    return solidify_surface(_read(mesh), SolidifyOptions.parse({"edge": edge, **options}, "solidify"))


def solidify_file(path: Path, out: Path, options: SolidifyOptions) -> SolidifyReport:
    """The same from file to file, in the format of the suffix; nothing is written that is not valid.

    Raises:
        ShapeError: no solid can be made of it.
        UserError: it cannot be written so.
    """
    found = solidify_surface(_read(path), options)
    if not found.certificate.valid:
        raise ShapeError(f"not valid: {', '.join(found.certificate.reasons)}")
    write_mesh(out, found.solid, system=UNITS[options.units or "m"])
    return found.report


def solidify_surface(soup: TriangleMesh, options: SolidifyOptions) -> Solidified:
    """The same, of triangles."""
    start = perf_counter()
    how = RepairOptions(alpha=options.alpha, timeout_seconds=options.timeout_seconds)
    surface, repair, reason = close_surface(soup, options.repair, how)
    solid, edge = make_solid(surface, options)
    certificate = certify(solid.vertices, solid.tets)
    hausdorff, mean_distance = surface_distance(surface, solid.surface)
    report = SolidifyReport(
        seconds=perf_counter() - start,
        repair=repair,
        reason=reason,
        edge=edge,
        tets=len(solid.tets),
        volume_in=surface.volume,
        volume_out=certificate.volume,
        hausdorff=hausdorff,
        mean_distance=mean_distance,
        min_dihedral=certificate.min_dihedral,
        pieces_in=count_pieces(surface),
        pieces_out=certificate.components,
        held=solid.changes.held,
        dropped=len(solid.changes.dropped),
        dropped_volume=float(sum(solid.changes.dropped)),
    )
    return Solidified(solid, certificate, report)


def make_solid(surface: TriangleMesh, options: SolidifyOptions) -> tuple[SolidMesh, float]:
    """The solid within a closed surface, and the side of the lattice's cells.

    Raises:
        ShapeError: it would take too many tets, or none is left.
    """
    frame = Frame.around(surface, options)
    placed = Triangles(frame.enter(surface.vertices), surface.faces)
    _check_size(placed, frame)
    solid = _cut(placed, frame, options)
    if not len(solid.tets):
        raise ShapeError("nothing is left at this edge; make it shorter")
    return SolidMesh(frame.leave(solid.vertices), solid.tets, solid.faces, solid.changes), frame.edge


class Frame(NamedTuple):
    """A cube around a surface that a lattice of so many cells of one length fills.

    Attributes:
        centre: of surface and cube.
        edge: side of the finest cells.
        base: cells along the cube of the coarsest lattice; `depth` subdivisions make the finest.
    """

    centre: Float[np.ndarray, "3"]
    edge: float
    base: int
    depth: int

    @classmethod
    def around(cls, surface: TriangleMesh, options: SolidifyOptions) -> "Frame":
        low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
        longest = float((high - low).max())
        edge = options.edge or longest / options.cells
        cells = longest / edge
        if not cells < 2**16:
            raise ShapeError(f"edges of {edge:g} are too short for a mesh {longest:g} long")
        depth = max(0, int(np.log2(max(cells, 1) / _FEWEST)))
        return cls((low + high) / 2, edge, max(1, int(np.ceil(cells / 2**depth - 1e-9))), depth)

    @property
    def cell(self) -> float:
        """Side of the finest cells in the unit cube."""
        return 1 / (self.base << self.depth)

    def enter(self, points: Float[np.ndarray, "V 3"]) -> Float[np.ndarray, "V 3"]:
        """To the unit cube."""
        return 0.5 + (points - self.centre) * (self.cell / self.edge)

    def leave(self, points: Float[np.ndarray, "V 3"]) -> Float[np.ndarray, "V 3"]:
        """To units and place of the surface."""
        return self.centre + (points - 0.5) * (self.edge / self.cell)


def surface_distance(one: TriangleMesh, other: TriangleMesh) -> tuple[float, float]:
    """Largest and mean distance between two surfaces, both ways, of points uniform by area."""
    ways = []
    for start, end in ((one, other), (other, one)):
        points, _ = sample_surface(start.vertices, start.faces, _POINTS, seed=0)
        squared, _, _ = igl.point_mesh_squared_distance(points, end.vertices, end.faces)
        ways.append(np.sqrt(squared))
    return float(max(way.max() for way in ways)), float(np.mean([way.mean() for way in ways]))


def _read(mesh: Surface) -> TriangleMesh:
    if isinstance(mesh, TriangleMesh):
        return mesh
    if isinstance(mesh, str | Path):
        path = Path(mesh)
        suffix = path.suffix.lower()
        if suffix not in MESH_SUFFIXES:
            raise ShapeError(f"no surface format '{suffix}'; use one of {' '.join(sorted(MESH_SUFFIXES))}")
        return parse_mesh(read_file(path), suffix)
    vertices, faces = (np.asarray(each) for each in mesh)
    if vertices.ndim != 2 or vertices.shape[1] != 3 or faces.ndim != 2 or faces.shape[1] != 3:
        raise ShapeError(f"expected vertices (V, 3) and faces (F, 3), got {vertices.shape}, {faces.shape}")
    return TriangleMesh(vertices.astype(np.float64), faces.astype(np.int64))


def _check_size(placed: TriangleMesh, frame: Frame) -> None:
    """Refuse what would take hours; the tets near the surface are the most."""
    area = np.linalg.norm(area_normals(placed.triangles), axis=1).sum() / 2
    tets = 12 * 2 * (REACH + 1) * area / frame.cell**2
    if tets > _MOST_TETS:
        raise ShapeError(f"edges of {frame.edge:g} would take about {tets:.1g} tets; make them longer")


def _cut(placed: Triangles, frame: Frame, options: SolidifyOptions) -> SolidMesh:
    """The solid in the unit cube."""
    fit = Fit(options.min_dihedral, MeshingOptions().rounds)
    solid = cut_surface(placed, frame.base, frame.depth, fit, options.interior)
    return drop_small_pieces(solid, options.min_component)
