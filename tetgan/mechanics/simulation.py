"""A solid on its supports, under its loads: linear elasticity by finite elements on its tets."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import meshio
import numpy as np
import skfem
from jaxtyping import Bool, Float, Int
from scipy import sparse

from tetgan.errors import UserError
from tetgan.files import check_suffix, whole_file
from tetgan.geometry.tets import TetMesh, orientations, tet_volumes
from tetgan.mechanics.assembly import (
    Body,
    face_weights,
    rigid_motions,
    stiffness,
    stresses,
    to_vertices,
    volume_weights,
    von_mises,
)
from tetgan.mechanics.errors import UnfitError
from tetgan.mechanics.options import LoadCase
from tetgan.mechanics.pieces import count_free_motions, label_pieces
from tetgan.mechanics.regions import DOWN, carry_over, choose_faces, parse_load, parse_support
from tetgan.mechanics.solver import DIRECT_BELOW, Solution, solve
from tetgan.solids.regions import BoundaryFaces


def cut_tets(solid: TetMesh, times: int) -> TetMesh:
    """Each tet cut into eight, so many times; the old vertices come first."""
    if times == 0:
        return solid
    mesh = skfem.MeshTet(np.ascontiguousarray(solid.vertices.T), np.ascontiguousarray(solid.tets.T)).refined(
        times
    )
    vertices, tets = np.ascontiguousarray(mesh.p.T), mesh.t.T.astype(np.int64)
    turned = tet_volumes(vertices, tets) < 0
    tets[turned] = tets[turned][:, [0, 2, 1, 3]]
    return TetMesh(vertices, tets)


GRAVITY = 9.81  # m/s^2

BODIES = (".vtu", ".vtk")
"""Formats that hold a mesh and what was found on it."""


class Push(NamedTuple):
    """Faces on which a load acts, and its force in newtons."""

    places: Float[np.ndarray, "P 3"]
    force: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Simulation:
    """A body at rest under its loads.

    Attributes:
        vertices: (V, 3) of the body without loads, in the units of its mesh.
        tets: (T, 4), those of the mesh or the finer ones that `refine` asks for.
        size: metres per unit of these.
        displacement: (V, 3) of the vertices, in metres.
        stress: (T,) von Mises stress in each tet, in Pa: of the mean stress in it.
        load: (3,) sum of all forces on the body, its weight included, in newtons.
        reaction: (3,) sum of the forces by which the supports hold it.
        work: of the forces along the displacement, in joules: the compliance, twice the energy stored.
        pushes: of each load the middles of its faces, in the units of the mesh, and its force.
        feet: (P, 3) nodes that are held, in the units of the mesh.
        mass: in kg.
        unknowns, solution: how large the equations were, and how they were solved.
        left_out: share of the volume of the given mesh that was not simulated; see `largest_piece`.
    """

    vertices: Float[np.ndarray, "V 3"]
    tets: Int[np.ndarray, "T 4"]
    size: float
    displacement: Float[np.ndarray, "V 3"]
    stress: Float[np.ndarray, "T"]
    vertex_stress: Float[np.ndarray, "V"]
    load: Float[np.ndarray, "3"]
    reaction: Float[np.ndarray, "3"]
    work: float
    pushes: Sequence[Push]
    feet: Float[np.ndarray, "P 3"]
    mass: float
    unknowns: int
    solution: Solution
    left_out: float = 0.0

    def record(self) -> dict[str, float | int | str]:
        """Figures of the simulation, by name; lengths in metres, stresses in Pa.

        The highest stress grows without bound as tets get finer where the surface has a sharp inner edge, so
        the 99th percentile over the tets is beside it.
        """
        return {
            "tets": len(self.tets),
            "unknowns": self.unknowns,
            "method": self.solution.method,
            "iterations": self.solution.iterations,
            "residual": self.solution.residual,
            "left_out": self.left_out,
            "mass": self.mass,
            "peak_displacement": float(np.linalg.norm(self.displacement, axis=1).max()),
            "peak_stress": float(self.stress.max()),
            "stress_p99": float(np.percentile(self.stress, 99)),
            "work": self.work,
            "load": float(np.linalg.norm(self.load)),
            "imbalance": float(np.linalg.norm(self.load + self.reaction) / np.linalg.norm(self.load)),
        }


class _Problem(NamedTuple):
    """A body, and at each of its nodes the force, and which components are held.

    `pushes` are as in `Simulation`.
    """

    body: Body
    case: LoadCase
    forces: Float[np.ndarray, "N 3"]
    pushes: Sequence[Push]
    held: Bool[np.ndarray, "N 3"]


class _Regions:
    """Looks regions up on one mesh, for another of the same surface.

    What the floor is depends on the faces, so a finer mesh, or another of the same body, would be held and
    loaded elsewhere if it chose for itself.
    """

    def __init__(self, named: BoundaryFaces, faces: BoundaryFaces, reach: float) -> None:
        self.named, self.faces, self.reach = named, faces, reach

    def __getitem__(self, region: str) -> Bool[np.ndarray, "F"]:
        chosen = choose_faces(region, self.named, self.reach)
        return chosen if self.faces is self.named else carry_over(chosen, self.named, self.faces)


def simulate(
    solid: TetMesh, case: LoadCase, *, surface: TetMesh | None = None, direct_below: int = DIRECT_BELOW
) -> Simulation:
    """Deform a solid.

    Regions are chosen before tets are cut, so that `refine` holds and loads the same part of the surface.

    Args:
        solid: valid tets in any unit.
        case: material, supports, loads, size and degree of the elements.
        surface: another mesh of the same body, whose regions are taken.
        direct_below: unknowns from which multigrid takes over.

    Raises:
        UnfitError: inverted tets, a region without faces, a piece that is not held, or equations that are not
            solved.
        UserError: a region or load that cannot be read, or no force.
    """
    _check_tets(solid)
    finer = cut_tets(solid, case.refine)
    problem = _pose(finer, case, surface or solid)
    _check_held(problem)
    matrix = stiffness(problem.body, case.stuff)
    motions = rigid_motions(problem.body.nodes)
    solution = solve(matrix, problem.forces.ravel(), problem.held.ravel(), motions, direct_below=direct_below)
    return _finish(problem, finer, matrix, solution)


def _pose(solid: TetMesh, case: LoadCase, surface: TetMesh) -> _Problem:
    """Regions looked up on a surface, and forces spread over the nodes."""
    body = Body(solid.vertices * case.size, solid.tets, case.order)
    faces = body.boundary_faces(case.size)
    named = faces if surface is solid else Body(surface.vertices, surface.tets, order=1).boundary_faces(1.0)
    regions = _Regions(named, faces, case.reach)
    held = _held(body, regions, case)
    forces, pushes = _forces(body, regions, case)
    if not forces.any():
        raise UserError("no force acts on the body; give a load other than zero, or gravity")
    return _Problem(body, case, forces, pushes, held)


def _finish(problem: _Problem, solid: TetMesh, matrix: sparse.bsr_array, solution: Solution) -> Simulation:
    """What follows from the displacement of the nodes."""
    body, stuff = problem.body, problem.case.stuff
    moved = solution.displacement.reshape(-1, 3)
    left = (matrix @ solution.displacement).reshape(-1, 3) - problem.forces
    stress = von_mises(stresses(body, stuff, moved))
    return Simulation(
        vertices=solid.vertices,
        tets=solid.tets,
        size=problem.case.size,
        displacement=moved[: len(solid.vertices)],
        stress=stress,
        vertex_stress=to_vertices(body, stress),
        load=problem.forces.sum(axis=0),
        reaction=np.where(problem.held, left, 0.0).sum(axis=0),
        work=float((problem.forces * moved).sum()),
        pushes=problem.pushes,
        feet=body.nodes[problem.held.any(axis=1)] / problem.case.size,
        mass=stuff.density * float(body.volumes.sum()),
        unknowns=moved.size,
        solution=solution,
    )


def _check_tets(solid: TetMesh) -> None:
    """Refuse what has no solution, or one that means nothing."""
    if len(solid.tets) == 0:
        raise UnfitError("no tets", "the mesh has no tets")
    bad = int((orientations(solid.vertices, solid.tets) <= 0).sum())
    if bad:
        raise UnfitError(
            "inverted tets",
            f"{bad} of {len(solid.tets)} tets are inverted or flat; 'tetgan certify' lists what is wrong, and"
            " meshes made with '--mode solid' have none",
        )


def _held(body: Body, regions: _Regions, case: LoadCase) -> Bool[np.ndarray, "N 3"]:
    """Which components of the nodes are held."""
    held = np.zeros((len(body.nodes), 3), dtype=bool)
    for support in map(parse_support, case.fix):
        nodes = body.nodes_of(regions[support.region])
        held[nodes] |= np.array(support.components)
    return held


def _forces(body: Body, regions: _Regions, case: LoadCase) -> tuple[Float[np.ndarray, "N 3"], Sequence[Push]]:
    """Forces on the nodes that do the work of even tractions and of the weight; and where the loads act."""
    forces, pushes = np.zeros((len(body.nodes), 3)), []
    for load in map(parse_load, case.load):
        chosen = regions[load.region]
        pushes.append(Push(regions.faces.middles[chosen], load.force))
        weights = face_weights(body, chosen)
        forces += (weights / weights.sum())[:, None] * np.array(load.force)
    if case.gravity:
        forces += GRAVITY * case.stuff.density * volume_weights(body)[:, None] * np.array(DOWN)
    return forces, pushes


def _check_held(problem: _Problem) -> None:
    """Every piece must be held against every rigid motion, or its equations have no one solution."""
    body, held = problem.body, problem.held
    labels = label_pieces(body.tets)
    nodes_of_tets = body.basis.element_dofs.T
    free = []
    for piece in range(labels.max() + 1):
        nodes = np.unique(nodes_of_tets[labels == piece])
        free.append(count_free_motions(body.nodes[nodes], held[nodes]))
    loose = np.flatnonzero(free)
    where = "', '".join(problem.case.fix)
    if len(loose) and len(free) == 1:
        raise UnfitError(
            "not held",
            f"'{where}' leaves the body free to move in {free[0]} of 6 ways;"
            " hold it in more places or directions",
        )
    if len(loose):
        tets = int(np.isin(labels, loose).sum())
        raise UnfitError(
            "not held",
            f"{len(loose)} of {len(free)} pieces ({tets} of {len(labels)} tets) are not held by '{where}';"
            " simulate the largest piece alone (--largest), or hold the others too",
        )


def write_simulation(path: Path, result: Simulation) -> None:
    """Write the mesh at rest, in metres, with `displacement` and `von_mises` on it, as the suffix says.

    Raises:
        UserError: the suffix is none of `BODIES`.
    """
    check_suffix(path, "a simulated mesh", *BODIES)
    mesh = meshio.Mesh(
        result.vertices * result.size,
        [("tetra", result.tets)],
        point_data={"displacement": result.displacement, "von_mises": result.vertex_stress},
        cell_data={"von_mises": [result.stress]},
    )
    with whole_file(path) as partial:
        meshio.write(partial, mesh, file_format=path.suffix.lower().removeprefix("."))


def readable_record(result: Simulation) -> dict[str, str]:
    """The figures that matter, in words and handy units."""
    record: dict[str, Any] = result.record()
    return {
        "tets": f"{record['tets']:,}",
        "unknowns": f"{record['unknowns']:,}",
        "solver": f"{record['method']}, {record['iterations']} iterations, residual {record['residual']:.0e}",
        "left out": f"{record['left_out']:.3%} of the volume" if record["left_out"] else "nothing",
        "mass": f"{record['mass']:.4g} kg",
        "load": f"{record['load']:.4g} N",
        "sum of load and reaction": f"{record['imbalance']:.0e} of the load",
        "largest displacement": f"{1e3 * record['peak_displacement']:.4g} mm",
        "highest von Mises stress": f"{record['peak_stress'] / 1e6:.4g} MPa",
        "99th percentile of it": f"{record['stress_p99'] / 1e6:.4g} MPa",
        "work of the load": f"{record['work']:.4g} J",
    }
