"""What is measured of one set of surfaces: its figures, and what to know when reading them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from tetgan.evaluation.chamfer import SurfaceDistance, SurfaceSample
from tetgan.evaluation.estimates import Estimate, feature_estimates, mean_estimate, repeats_estimate
from tetgan.evaluation.features import cloud_features
from tetgan.evaluation.options import EvaluationOptions
from tetgan.evaluation.seeds import named_rng
from tetgan.evaluation.surfaces import Topology
from tetgan.evaluation.variety import shapes_needed, variety
from tetgan.models.pointnet2 import FEATURES, Classifier


class RealFeatures(NamedTuple):
    """Features of as many real clouds as the options ask for; none where there are fewer."""

    features: Float[np.ndarray, "N F"] | None
    points: int
    available: int


def draw_real(
    array: Float[np.ndarray, "N P 3"], split: str, classifier: Classifier, options: EvaluationOptions
) -> RealFeatures:
    """Features of a split's clouds, drawn without replacement; the draw is the same for every model."""
    if len(array) < options.samples:
        return RealFeatures(None, array.shape[1], len(array))
    chosen = named_rng(options.seed, "clouds", split).choice(len(array), options.samples, replace=False)
    features = cloud_features(array[np.sort(chosen)], classifier.network, f"{split} features")
    return RealFeatures(features, array.shape[1], len(array))


@dataclass
class Section:
    """Metrics by name, how many meshes were expected and found, and remarks in words."""

    options: EvaluationOptions
    metrics: dict[str, Estimate] = field(default_factory=dict)
    counts: dict[str, dict[str, int]] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def add_means(self, columns: Mapping[str, Sequence[float | int] | np.ndarray]) -> None:
        """A mean over items for each column; an empty one is a missing metric."""
        for name, values in columns.items():
            self.metrics[name] = mean_estimate(np.asarray(values, dtype=np.float64), name, self.options)

    def add_distances(self, distances: Sequence[SurfaceDistance]) -> None:
        """Means of every measure of distance."""
        self._add_fields(SurfaceDistance._fields, distances)

    def add_topology(self, topologies: Sequence[Topology]) -> None:
        """Mean shares of edges, and the share of shapes that are closed manifolds."""
        self._add_fields(Topology._fields, topologies)

    def _add_fields(
        self, names: Sequence[str], items: Sequence[SurfaceDistance] | Sequence[Topology]
    ) -> None:
        self.add_means({name: [getattr(item, name) for item in items] for name in names})

    def add_variety(self, samples: Sequence[SurfaceSample], threads: int) -> None:
        """Variety of the surfaces, missing where they are too few."""
        needed = shapes_needed(self.options.variety)
        if len(samples) < needed:
            self.metrics["variety"] = Estimate()
            self.notes.append(f"variety needs {needed} surfaces and has {len(samples)}")
            return
        values = variety(samples, self.options.variety, named_rng(self.options.seed, "variety"), threads)
        self.metrics["variety"] = repeats_estimate(values, len(samples), self.options)

    def add_feature_distances(
        self, found: Float[np.ndarray, "N F"] | None, available: int, holdout: RealFeatures
    ) -> None:
        """FID and KID against the hold-out, missing where either side is too small."""
        needed = self.options.samples
        if found is None or holdout.features is None:
            self.metrics |= {"fid": Estimate(), "kid": Estimate()}
            self.notes.append(
                f"FID and KID need {needed} surfaces on each side and have {available}, {holdout.available}"
            )
            return
        self.metrics |= feature_estimates(found, holdout.features, self.options)
        if needed < 3 * FEATURES:
            self.notes.append(
                f"FID at N = {needed}, below {3 * FEATURES}, is mostly bias: compare it only with the floor, "
                "and read KID first"
            )

    def count(self, kind: str, expected: int, found: int) -> None:
        """How many meshes of a kind there should be, and how many have a surface."""
        self.counts[kind] = {"expected": expected, "found": found}

    def to_json(self) -> dict[str, Any]:
        """Plain values."""
        metrics = {name: estimate.to_json() for name, estimate in self.metrics.items()}
        return {"metrics": metrics, **self.counts, "notes": self.notes}
