"""The figures of each variant of a shape, held against its repaired mesh."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import igl
import numpy as np
from jaxtyping import Float

from tetgan.evaluation.chamfer import SurfaceSample, chamfer
from tetgan.evaluation.options import EvaluationOptions
from tetgan.evaluation.seeds import named_seed
from tetgan.evaluation.surfaces import Surface, draw_sample
from tetgan.grids.grid import tet_volumes
from tetgan.meshing.boundary import Boundary
from tetgan.meshing.orientation import orientations
from tetgan.meshing.solid import SolidMesh
from tetgan.studies.options import SmoothingOptions
from tetgan.studies.sharpness import Bends, measure_bends
from tetgan.studies.smoothers import Variant
from tetgan.studies.smoothing_files import REPAIRED


@dataclass(frozen=True, eq=False)
class Truth:
    """A repaired shape, and what surfaces are held against."""

    shape_id: str
    surface: Surface
    study: SmoothingOptions
    evaluation: EvaluationOptions

    @cached_property
    def sample(self) -> SurfaceSample:
        return draw_sample(self.surface, self.evaluation.points, self._seed("truth"))

    @cached_property
    def volume(self) -> float:
        return enclosed_volume(self.surface)

    @cached_property
    def bends(self) -> Bends:
        return measure_bends(*self.surface)

    @cached_property
    def creases(self) -> Float[np.ndarray, "P 3"]:
        """Points on its sharp edges."""
        return self.bends.draw(self.study.crease, self.study.crease_points, self._seed("crease"))

    def figures(self, surface: Surface) -> dict[str, float]:
        """What a surface alone tells: distance and sharpness."""
        drawn = draw_sample(surface, self.evaluation.points, self._seed("reconstructed"))
        bends = measure_bends(*surface)
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
    """The repaired shape held against itself, which is the floor, then a row a variant.

    A row has no figures where nothing is left of the shape.
    """
    yield {"id": truth.shape_id, "smoothing": REPAIRED} | truth.figures(truth.surface)
    for variant, solid in solids.items():
        row = {"id": truth.shape_id, "displaced": variant.displaced, "smoothing": variant.smoothing}
        if len(solid.faces):
            row |= truth.figures(Surface(solid.vertices, solid.faces))
            row |= _solid_figures(solid, solids[Variant(variant.displaced, "none")], truth.volume)
        yield row


def enclosed_volume(surface: Surface) -> float:
    """Signed volume of a closed surface, positive when it faces outward."""
    apex = np.full(len(surface.faces), len(surface.vertices))
    tets = np.column_stack([apex, surface.faces])
    return float(tet_volumes(np.vstack([surface.vertices, np.zeros(3)]), tets).sum())


def _solid_figures(solid: SolidMesh, unsmoothed: SolidMesh, volume: float) -> dict[str, float]:
    own = tet_volumes(solid.vertices, solid.tets).sum()
    return {
        "volume_ratio": own / tet_volumes(unsmoothed.vertices, unsmoothed.tets).sum(),
        "volume_to_repaired": own / volume,
        "manifold_edges": Boundary(solid.faces).manifold_edges,
        "inverted_tets": float((orientations(solid.vertices, solid.tets) <= 0).mean()),
    }


def _mean_distance(points: Float[np.ndarray, "P 3"], surface: Surface) -> float:
    """Of points to a surface; nan without points."""
    if not len(points):
        return np.nan
    squared, _, _ = igl.point_mesh_squared_distance(points, *surface)
    return float(np.sqrt(squared.clip(min=0)).mean())
