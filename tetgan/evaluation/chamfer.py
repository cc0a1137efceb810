"""How far apart two surfaces are, by points sampled on them."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import KDTree

# Measured on 10,000 points: against the default of 10 and balanced nodes, builds 4 times faster and answers
# a third faster.
_LEAF = 32


@dataclass(frozen=True, eq=False)
class SurfaceSample:
    """Points drawn on one surface, in random order, and the unit normals there."""

    points: Float[np.ndarray, "P 3"]
    normals: Float[np.ndarray, "P 3"]

    @cached_property
    def tree(self) -> KDTree:
        return KDTree(self.points, leafsize=_LEAF, balanced_tree=False, compact_nodes=False)


class SurfaceDistance(NamedTuple):
    """Measures of two surfaces; lengths in units of the unit cube's side, none of them re-normalised."""

    chamfer: float
    chamfer_l1: float
    fscore: float
    normal_consistency: float


def nearest(
    queries: Float[np.ndarray, "Q 3"], sample: SurfaceSample
) -> tuple[Float[np.ndarray, "Q"], Int[np.ndarray, "Q"]]:
    """Distance from every query to the closest point of the sample, and which one that is."""
    distance, index = sample.tree.query(queries)
    return distance, index


def chamfer(first: SurfaceSample, second: SurfaceSample) -> float:
    """Mean squared distance to the nearest point, each way, summed. Symmetric; 0 for equal points."""
    forth, _ = nearest(first.points, second)
    back, _ = nearest(second.points, first)
    return float((forth**2).mean() + (back**2).mean())


class Estimate(NamedTuple):
    """A Chamfer distance from a part of the points, and its standard error."""

    value: float
    error: float


def estimate_chamfer(first: SurfaceSample, second: SurfaceSample, queries: int) -> Estimate:
    """The distance from the first `queries` points of each to all of the other.

    The order of a sample's points is random, so the first of them are a fair part: there is no bias.
    """
    squares = [
        nearest(source.points[:queries], target)[0] ** 2
        for source, target in ((first, second), (second, first))
    ]
    error = math.sqrt(sum(float(s.var()) / len(s) for s in squares))
    return Estimate(sum(float(s.mean()) for s in squares), error)


def compare_surfaces(found: SurfaceSample, truth: SurfaceSample, threshold: float) -> SurfaceDistance:
    """All measures of one pair.

    chamfer: as `chamfer`. chamfer_l1: mean distance, averaged over both ways. fscore: harmonic mean of the
    shares of points of each surface closer than `threshold` to the other. normal_consistency: mean |cos| of
    the angle to the nearest point's normal, averaged over both ways (Mescheder et al. 2019, supplement 1).
    """
    forth, matched_truth = nearest(found.points, truth)
    back, matched_found = nearest(truth.points, found)
    precision, recall = (forth < threshold).mean(), (back < threshold).mean()
    agreement_forth = np.abs((found.normals * truth.normals[matched_truth]).sum(1)).mean()
    agreement_back = np.abs((truth.normals * found.normals[matched_found]).sum(1)).mean()
    return SurfaceDistance(
        chamfer=float((forth**2).mean() + (back**2).mean()),
        chamfer_l1=float((forth.mean() + back.mean()) / 2),
        fscore=float(2 * precision * recall / max(precision + recall, np.finfo(float).tiny)),
        normal_consistency=float((agreement_forth + agreement_back) / 2),
    )
