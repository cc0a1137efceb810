"""Figures of each variant of a shape beside its repaired mesh."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import igl
import numpy as np
from jaxtyping import Float, Int
from scipy.stats import wasserstein_distance

from tetgan.evaluation.chamfer import SurfaceSample, chamfer
from tetgan.evaluation.options import EvaluationOptions
from tetgan.evaluation.seeds import named_seed
from tetgan.evaluation.surfaces import draw_sample
from tetgan.geometry.adjacency import unique_edges
from tetgan.geometry.boundary import Boundary
from tetgan.geometry.tets import orientations, tet_volumes
from tetgan.geometry.triangles import TriangleMesh, area_normals
from tetgan.solids.solid import SolidMesh
from tetgan.studies.options import SmoothingOptions
from tetgan.studies.smoothing.files import REPAIRED, Variant


@dataclass(frozen=True, eq=False)
class Bends:
    """Edges with exactly two faces.

    Attributes:
        angles: degrees between the outward normals of the two faces: 0 where flat, 90 at the edges of a
            cube; 0 also where a face has no area.
        lengths: of the edges.
        ends: their end points.
    """

    angles: Float[np.ndarray, "E"]
    lengths: Float[np.ndarray, "E"]
    ends: Float[np.ndarray, "E 2 3"]

    def percentile(self, percent: float | int) -> float:
        """Angle below which that many per cent of the edges' length bend; nan without edges."""
        if not len(self.angles):
            return np.nan
        order = np.argsort(self.angles)
        cumulative = np.cumsum(self.lengths[order])
        place = np.searchsorted(cumulative, percent / 100 * cumulative[-1])
        return float(self.angles[order][min(place, len(order) - 1)])

    def share_above(self, degrees: float | int) -> float:
        """Share of the edges' length that bends by more; nan without edges."""
        total = self.lengths.sum()
        return float(self.lengths[self.angles > degrees].sum() / total) if total > 0 else np.nan

    def histogram(self, step: int) -> dict[str, float]:
        """Share of the edges' length in each range of `step` degrees from 0 to 180, by its name."""
        starts = range(0, 180, step)
        lengths, _ = np.histogram(self.angles, [*starts, 180], weights=self.lengths)
        shares = lengths / max(self.lengths.sum(), np.finfo(float).tiny)
        return {f"bend_{low}_{low + step}": float(share) for low, share in zip(starts, shares, strict=True)}

    def distance(self, other: "Bends") -> float:
        """Wasserstein-1 distance in degrees between the distributions of angle over length."""
        return float(wasserstein_distance(self.angles, other.angles, self.lengths, other.lengths))

    def draw(self, degrees: float | int, count: int, seed: int) -> Float[np.ndarray, "P 3"]:
        """Points uniform by length on the edges that bend by more; none where there is no such edge."""
        sharp = self.angles > degrees
        ends, total = self.ends[sharp], np.cumsum(self.lengths[sharp])
        if not len(total) or not total[-1] > 0:
            return np.empty((0, 3))
        along, place = np.random.default_rng(seed).random((2, count))
        chosen = np.searchsorted(total, place * total[-1], side="right")
        return ends[chosen, 0] + along[:, None] * (ends[chosen, 1] - ends[chosen, 0])


def measure_bends(vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"]) -> Bends:
    """The bend at each edge of a surface whose faces are turned alike."""
    normals = area_normals(vertices[faces])
    edges, edge_of_side = unique_edges(faces)
    sides = edge_of_side.ravel()
    manifold = np.bincount(sides, minlength=len(edges)) == 2
    order = np.argsort(sides, kind="stable")
    pairs = order[manifold[sides[order]]].reshape(-1, 2) // 3  # sides of one edge are adjacent
    one, other = normals[pairs[:, 0]], normals[pairs[:, 1]]
    sine = np.linalg.norm(np.cross(one, other), axis=1)
    angles = np.degrees(np.arctan2(sine, np.einsum("ec,ec->e", one, other)))
    ends = vertices[edges[manifold]]
    return Bends(angles, np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1), ends)


@dataclass(frozen=True, eq=False)
class Truth:
    """A repaired shape, with the measures that surfaces are compared with."""

    shape_id: str
    surface: TriangleMesh
    study: SmoothingOptions
    evaluation: EvaluationOptions

    @cached_property
    def sample(self) -> SurfaceSample:
        return draw_sample(self.surface, self.evaluation.points, self._seed("truth"))

    @cached_property
    def volume(self) -> float:
        return self.surface.volume

    @cached_property
    def bends(self) -> Bends:
        return measure_bends(self.surface.vertices, self.surface.faces)

    @cached_property
    def creases(self) -> Float[np.ndarray, "P 3"]:
        """Points on its sharp edges."""
        return self.bends.draw(self.study.crease, self.study.crease_points, self._seed("crease"))

    def figures(self, surface: TriangleMesh) -> dict[str, float]:
        """Distance and sharpness of a surface."""
        drawn = draw_sample(surface, self.evaluation.points, self._seed("reconstructed"))
        bends = measure_bends(surface.vertices, surface.faces)
        return {
            "chamfer": chamfer(drawn, self.sample),
            "bend_p95": bends.percentile(95),
            "bend_sharp": bends.share_above(self.study.crease),
            "bend_w1": bends.distance(self.bends),
            "crease_distance": _mean_distance(self.creases, surface),
        }

    def _seed(self, purpose: str) -> int:
        """The evaluation's own seeds, so that equal surfaces have equal figures in every table."""
        return named_seed(self.evaluation.seed, purpose, self.shape_id)


def shape_rows(truth: Truth, solids: Mapping[Variant, SolidMesh]) -> Iterator[dict[str, Any]]:
    """The repaired shape compared with itself, which is the floor, then one row per variant.

    A row has no figures where nothing is left of the shape.
    """
    yield {"id": truth.shape_id, "smoothing": REPAIRED} | truth.figures(truth.surface)
    for variant, solid in solids.items():
        row = {"id": truth.shape_id, "displaced": variant.displaced, "smoothing": variant.smoothing}
        if len(solid.faces):
            row |= truth.figures(solid.surface)
            row |= _solid_figures(solid, solids[Variant(variant.displaced, "none")], truth.volume)
        yield row


def _solid_figures(solid: SolidMesh, unsmoothed: SolidMesh, volume: float) -> dict[str, float]:
    own = tet_volumes(solid.vertices, solid.tets).sum()
    return {
        "volume_ratio": own / tet_volumes(unsmoothed.vertices, unsmoothed.tets).sum(),
        "volume_to_repaired": own / volume,
        "manifold_edges": Boundary(solid.faces).manifold_edges,
        "inverted_tets": float((orientations(solid.vertices, solid.tets) <= 0).mean()),
    }


def _mean_distance(points: Float[np.ndarray, "P 3"], surface: TriangleMesh) -> float:
    """Of points to a surface; nan without points."""
    if not len(points):
        return np.nan
    squared, _, _ = igl.point_mesh_squared_distance(points, surface.vertices, surface.faces)
    return float(np.sqrt(squared.clip(min=0)).mean())
