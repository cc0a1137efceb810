"""Metrics of one reconstruction against its original."""

from math import nan
from typing import NamedTuple

import numpy as np

from tetgan.evaluation.chamfer import SurfaceDistance, SurfaceSample, compare_surfaces
from tetgan.evaluation.options import EvaluationOptions
from tetgan.evaluation.seeds import named_seed
from tetgan.evaluation.surfaces import Topology, draw_sample, measure_topology
from tetgan.geometry.inside import is_inside
from tetgan.geometry.triangles import TriangleMesh


def volume_iou(first: TriangleMesh, second: TriangleMesh, points: int, seed: int) -> float:
    """Volume inside both surfaces over volume inside either; nan where neither has an inside.

    Estimated from points uniform in the smallest box that holds both. Outside of it there is nothing of
    either, so this is what points in the whole cube give, with fewer of them wasted. Mescheder et al. (2019),
    supplement 1, ask the same of 100,000 points.
    """
    corners = np.concatenate([first.vertices, second.vertices])
    low, high = corners.min(0), corners.max(0)
    queries = low + (high - low) * np.random.default_rng(seed).random((points, 3))
    # Samples may face inward, or have gaps.
    in_first, in_second = (
        is_inside(queries, surface.vertices, surface.faces, either_way=True) for surface in (first, second)
    )
    either = np.count_nonzero(in_first | in_second)
    return np.count_nonzero(in_first & in_second) / either if either else nan


class Reconstruction(NamedTuple):
    """Distance of a surface from the truth, volume IoU, faces and topology."""

    distance: SurfaceDistance
    volume_iou: float
    faces: int
    topology: Topology


def draw_truth(original: TriangleMesh, shape_id: str, options: EvaluationOptions) -> SurfaceSample:
    """Points of an original, to be drawn once for all its reconstructions."""
    return draw_sample(original, options.points, named_seed(options.seed, "truth", shape_id))


def measure_reconstruction(
    surface: TriangleMesh,
    original: TriangleMesh,
    truth: SurfaceSample,
    shape_id: str,
    options: EvaluationOptions,
) -> Reconstruction:
    """Measure a surface against its original; `truth` as `draw_truth` gives it.

    The original measured against itself gives the floor: its points are drawn twice.
    """
    found = draw_sample(surface, options.points, named_seed(options.seed, "reconstructed", shape_id))
    volume_seed = named_seed(options.seed, "volume", shape_id)
    return Reconstruction(
        compare_surfaces(found, truth, options.fscore_threshold),
        volume_iou(surface, original, options.volume_points, volume_seed),
        len(surface.faces),
        measure_topology(surface.faces),
    )
