"""One reconstruction beside its original."""

from typing import NamedTuple

from tetgan.evaluation.chamfer import SurfaceDistance, SurfaceSample, compare_surfaces
from tetgan.evaluation.options import EvaluationOptions
from tetgan.evaluation.seeds import named_seed
from tetgan.evaluation.surfaces import Surface, Topology, draw_sample, measure_topology
from tetgan.evaluation.volume import volume_iou


class Reconstruction(NamedTuple):
    """How far a surface is from the truth, how much their insides overlap, and what it is made of."""

    distance: SurfaceDistance
    volume_iou: float
    faces: int
    topology: Topology


def draw_truth(original: Surface, shape_id: str, options: EvaluationOptions) -> SurfaceSample:
    """Points of an original, to be drawn once for all its reconstructions."""
    return draw_sample(original, options.points, named_seed(options.seed, "truth", shape_id))


def measure_reconstruction(
    surface: Surface, original: Surface, truth: SurfaceSample, shape_id: str, options: EvaluationOptions
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
