"""Certificate of a tet mesh: validity as a solid, and quality of its tets."""

from dataclasses import asdict, dataclass
from typing import Any

import igl
import numpy as np
from jaxtyping import Float, Int

from tetgan.geometry.boundary import Boundary, shell_volumes
from tetgan.geometry.components import connect_tets
from tetgan.geometry.intersections import self_intersections
from tetgan.geometry.tets import dihedral_angles, orientations, radius_ratios, tet_volumes

BINS = 10
"""Of the histogram of radius ratios, over [0, 1]."""


@dataclass(frozen=True)
class Certificate:
    """Counts of a mesh's defects, and quality of its tets. All is 0 for a mesh without tets.

    Attributes:
        tets, faces: of the mesh, and of its boundary.
        inverted_tets: of no or negative volume, decided exactly.
        min_dihedral: smallest dihedral angle in degrees; it does not see whether a tet is inverted.
        p1_dihedral: 1st percentile over the tets of their smallest dihedral angle.
        min_radius_ratio: smallest of three times the inner radius over the outer, 1 for a regular tet.
        radius_ratios: tets by radius ratio, `BINS` bins over [0, 1].
        volume: signed, in cubed units of the vertices.
        components: pieces of tets joined by faces.
        floating: share of the tets outside of the largest piece.
        crowded_faces: faces of more than two tets.
        folded_faces: inner faces with both tets on one side.
        manifold_edges: share of the boundary's edges that have exactly two faces.
        nonmanifold_edges: the number of the others.
        nonmanifold_vertices: boundary vertices whose faces are not exactly one fan.
        misoriented_edges: edges whose two faces do not turn the same way.
        self_intersections: pairs of boundary faces that meet anywhere but in vertices they share.
        cavities: voids that the outside does not reach: shells of the boundary that enclose negative volume.
        overlapping_shells: shells of the boundary that lie in tets of another part of the mesh. Counted for a
            boundary that is manifold and free of self-intersections only; None otherwise.
    """

    tets: int = 0
    faces: int = 0
    inverted_tets: int = 0
    min_dihedral: float = 0.0
    p1_dihedral: float = 0.0
    min_radius_ratio: float = 0.0
    radius_ratios: tuple[int, ...] = (0,) * BINS
    volume: float = 0.0
    components: int = 0
    floating: float = 0.0
    crowded_faces: int = 0
    folded_faces: int = 0
    manifold_edges: float = 0.0
    nonmanifold_edges: int = 0
    nonmanifold_vertices: int = 0
    misoriented_edges: int = 0
    self_intersections: int = 0
    cavities: int = 0
    overlapping_shells: int | None = 0

    @property
    def valid(self) -> bool:
        """Whether nothing keeps the mesh from being a solid; `certify` says what would."""
        return not self.reasons

    @property
    def reasons(self) -> list[str]:
        """Reasons for which the mesh is not valid, in words."""
        if not self.tets:
            return ["no tets"]
        found = {
            "inverted tets": self.inverted_tets,
            "faces of more than two tets": self.crowded_faces,
            "inner faces with both tets on one side": self.folded_faces,
            "non-manifold edges": self.nonmanifold_edges,
            "non-manifold vertices": self.nonmanifold_vertices,
            "misoriented edges": self.misoriented_edges,
            "self-intersections": self.self_intersections,
            "shells inside of other tets": self.overlapping_shells,
        }
        return [f"{count} {what}" for what, count in found.items() if count]

    def row(self) -> dict[str, Any]:
        """Columns of a table: the attributes, bins of the histogram joined by blanks, then the verdict."""
        bins = " ".join(map(str, self.radius_ratios))
        verdict = {"valid": self.valid, "reasons": "; ".join(self.reasons)}
        return asdict(self) | {"radius_ratios": bins} | verdict

    def to_json(self) -> dict[str, Any]:
        """The same as plain values, with lists as lists."""
        verdict = {"valid": self.valid, "reasons": self.reasons}
        return verdict | asdict(self) | {"radius_ratios": list(self.radius_ratios)}


def certify(vertices: Float[np.ndarray, "V 3"], tets: Int[np.ndarray, "T 4"]) -> Certificate:
    """Examine a tet mesh of any origin.

    A mesh is valid where every tet is positive, no face has more than two tets or both on one side, every
    boundary edge has two faces and every boundary vertex one fan, no two boundary faces meet but in what they
    share, and no part lies within another. Then the tets fill space without overlap: the boundary tells how
    often each point is covered, and covers it once.

    Args:
        vertices: finite, in any unit; vertices that no tet uses play no part.

    Raises:
        ValueError: a coordinate is not finite, or there are more than two million vertices.
    """
    if len(tets) == 0:
        return Certificate()
    used, compact = np.unique(tets, return_inverse=True)
    vertices, tets = np.asarray(vertices, dtype=np.float64)[used], compact.reshape(-1, 4)
    if not np.isfinite(vertices).all():
        raise ValueError("a coordinate is not finite")
    connected = connect_tets(tets)
    boundary = Boundary(connected.faces)
    crossings = len(self_intersections(vertices, connected.faces))
    shell = boundary.shells(vertices)
    enclosed = shell_volumes(vertices, connected.faces, shell)
    embedded = not (crossings or boundary.nonmanifold_edges or boundary.nonmanifold_vertices)
    return Certificate(
        tets=len(tets),
        faces=len(connected.faces),
        inverted_tets=int((orientations(vertices, tets) <= 0).sum()),
        **_shape_figures(vertices, tets),
        volume=float(tet_volumes(vertices, tets).sum()),
        components=int(connected.component.max() + 1),
        floating=float(1 - np.bincount(connected.component).max() / len(tets)),
        crowded_faces=connected.crowded_faces,
        folded_faces=connected.folded_faces,
        manifold_edges=boundary.manifold_edges,
        nonmanifold_edges=boundary.nonmanifold_edges,
        nonmanifold_vertices=boundary.nonmanifold_vertices,
        misoriented_edges=boundary.misoriented_edges,
        self_intersections=crossings,
        cavities=int((enclosed < 0).sum()),
        overlapping_shells=_misplaced(vertices, connected.faces, shell, enclosed) if embedded else None,
    )


def _shape_figures(vertices: Float[np.ndarray, "V 3"], tets: Int[np.ndarray, "T 4"]) -> dict[str, Any]:
    angles = dihedral_angles(vertices, tets).min(axis=1)
    ratios = radius_ratios(vertices, tets)
    bins, _ = np.histogram(ratios.clip(0, 1), bins=BINS, range=(0, 1))
    return {
        "min_dihedral": float(angles.min()),
        "p1_dihedral": float(np.percentile(angles, 1)),
        "min_radius_ratio": float(ratios.min()),
        "radius_ratios": tuple(bins.tolist()),
    }


def _misplaced(
    vertices: Float[np.ndarray, "V 3"],
    faces: Int[np.ndarray, "F 3"],
    shell: Int[np.ndarray, "F"],
    enclosed: Float[np.ndarray, "S"],
) -> int:
    """Shells of disjoint surfaces that are not where they belong: a void within tets, all others outside.

    How often the other shells wind around a shell tells in how many parts of the solid it lies.
    """
    if len(enclosed) < 2:
        return 0
    count = 0
    for number, volume in enumerate(enclosed):
        own = shell == number
        point = vertices[faces[own][0, :1]]
        turns = igl.winding_number(vertices, faces[~own], point).round()
        count += int(turns[0] != (1 if volume < 0 else 0))
    return count
