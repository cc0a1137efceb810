"""Metrics of one set of surfaces, with the warnings that belong to them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from tetgan.evaluation.chamfer import SurfaceDistance, SurfaceSample, chamfer_between, chamfer_within
from tetgan.evaluation.coverage import two_sets
from tetgan.evaluation.estimates import (
    Estimate,
    feature_estimates,
    jsd_estimate,
    mean_estimate,
    repeats_estimate,
    set_estimates,
)
from tetgan.evaluation.metrics import names_of, titles_of
from tetgan.evaluation.novelty import nearest_training
from tetgan.evaluation.options import EvaluationOptions
from tetgan.evaluation.reconstructions import Reconstruction
from tetgan.evaluation.seeds import named_rng
from tetgan.evaluation.surfaces import Topology
from tetgan.evaluation.variety import shapes_needed, variety
from tetgan.extractor.features import cloud_features
from tetgan.extractor.network import FEATURES, Classifier


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


class RealSet(NamedTuple):
    """As many real clouds as sets are compared by, and the Chamfer distances within; none where fewer."""

    clouds: Float[np.ndarray, "N P 3"] | None
    within: Float[np.ndarray, "N N"] | None
    available: int


def draw_real_set(array: Float[np.ndarray, "N P 3"], split: str, options: EvaluationOptions) -> RealSet:
    """A split's clouds as a set; the draw is the same for every model."""
    if len(array) < options.sets.shapes:
        return RealSet(None, None, len(array))
    clouds = draw_clouds(array, split, options)
    return RealSet(clouds, chamfer_within(_part(clouds, options), f"{split} pairs"), len(array))


def draw_clouds(
    array: Float[np.ndarray, "N P 3"], split: str, options: EvaluationOptions
) -> Float[np.ndarray, "M P 3"]:
    """At most as many of a split's clouds as sets are compared by, drawn without replacement."""
    order = named_rng(options.seed, "sets", split).permutation(len(array))
    return array[np.sort(order[: options.sets.shapes])]


def _part(clouds: Float[np.ndarray, "N P 3"], options: EvaluationOptions) -> Float[np.ndarray, "N Q 3"]:
    """As many points of each cloud as sets are compared by; their order is random, so the first are fair."""
    return clouds[:, : options.sets.points]


@dataclass
class Section:
    """Metrics by name, how many meshes were expected and found, and remarks in words."""

    options: EvaluationOptions
    metrics: dict[str, Estimate] = field(default_factory=dict)
    counts: dict[str, dict[str, int]] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def add_means(self, columns: Mapping[str, Sequence[float | int] | np.ndarray]) -> None:
        """A mean over the items for each column; nan is no item, an empty column a missing metric."""
        for name, values in columns.items():
            known = np.asarray(values, dtype=np.float64)
            self.metrics[name] = mean_estimate(known[~np.isnan(known)], name, self.options)

    def add_reconstructions(self, items: Sequence[Reconstruction], missing: int = 0) -> None:
        """Means of every measure of distance, and of the overlap.

        Args:
            items: reconstructions that have a surface.
            missing: how many have none. They are no item of distances, and 0 in overlap and F-score.
        """
        columns = {name: [getattr(item.distance, name) for item in items] for name in SurfaceDistance._fields}
        columns["volume_iou"] = [item.volume_iou for item in items]
        columns["empty_reconstructions"] = [0.0] * len(items)
        for name, value in (("fscore", 0.0), ("volume_iou", 0.0), ("empty_reconstructions", 1.0)):
            columns[name] += [value] * missing
        self.add_means(columns)
        if missing:
            of_others = titles_of(("chamfer", "chamfer_l1", "normal_consistency", "faces"))
            self.notes.append(
                f"{missing} of {len(items) + missing} reconstructions have no surface: {of_others} are of "
                f"the others, {titles_of(('fscore', 'volume_iou'))} count them as 0"
            )

    def add_topology(self, items: Sequence[Topology]) -> None:
        """Mean shares of edges, and the share of shapes that are closed manifolds."""
        self.add_means({name: [getattr(item, name) for item in items] for name in Topology._fields})

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
        """FID and its kin against the hold-out, missing where either side is too small."""
        needed = self.options.samples
        if found is None or holdout.features is None:
            self._leave_out("features", needed, available, holdout.available)
            return
        self.metrics |= feature_estimates(found, holdout.features, self.options)
        if needed < 3 * FEATURES:
            self.notes.append(
                f"FID at N = {needed}, below {3 * FEATURES}, is mostly bias: compare it only with the floor, "
                "and read KID first"
            )

    def add_set_distances(self, found: Float[np.ndarray, "N P 3"], reference: RealSet) -> None:
        """MMD, COV, 1-NNA and JSD of the first clouds, missing where either side is too small."""
        needed = self.options.sets.shapes
        if len(found) < needed or reference.clouds is None or reference.within is None:
            self._leave_out("sets", needed, len(found), reference.available)
            return
        found = found[:needed]
        own, real = _part(found, self.options), _part(reference.clouds, self.options)
        sets = two_sets(
            chamfer_within(own, "generated pairs"), reference.within, chamfer_between(own, real, "pairs")
        )
        self.metrics |= set_estimates(sets, self.options)
        self.metrics["jsd"] = jsd_estimate(found, reference.clouds, self.options)

    def add_novelty(
        self, found: Float[np.ndarray, "N P 3"], training: Float[np.ndarray, "M Q 3"] | None
    ) -> None:
        """Mean distance of the first clouds from the nearest training shape, missing without such shapes."""
        found = _part(found[: self.options.sets.shapes], self.options)
        if training is None or not len(training) or not len(found):
            self.metrics["novelty"] = Estimate()
            return
        self.add_means({"novelty": nearest_training(found, training).distance})

    def _leave_out(self, group: str, needed: int, found: int, real: int) -> None:
        names = names_of(group)
        self.metrics |= dict.fromkeys(names, Estimate())
        self.notes.append(f"{titles_of(names)} need {needed} surfaces on each side and have {found}, {real}")

    def note_resampled(self, distances: Sequence[float]) -> None:
        """Say what shapes score against themselves with the points that sets are compared by."""
        if distances:
            self.notes.append(
                f"Chamfer distance of a shape sampled twice, {self.options.sets.points} points each: "
                f"{np.mean(distances):.3g}. MMD and novelty of perfect copies are no lower"
            )

    def count(self, kind: str, expected: int, found: int) -> None:
        """Note how many meshes of a kind there should be, and how many have a surface."""
        self.counts[kind] = {"expected": expected, "found": found}

    def count_samples(self, expected: int, found: int) -> None:
        """The same of generated shapes, and the share without a surface."""
        self.count("generated", expected, found)
        missing = expected - found
        self.add_means({"empty_samples": [0.0] * found + [1.0] * missing})
        if missing:
            of_others = [name for name in names_of("features", "sets", "samples") if name != "empty_samples"]
            self.notes.append(
                f"{missing} of {expected} generated shapes have no surface: {titles_of(of_others)} are of "
                "the others"
            )

    def to_json(self) -> dict[str, Any]:
        """Plain values."""
        metrics = {name: estimate.to_json() for name, estimate in self.metrics.items()}
        return {"metrics": metrics, **self.counts, "notes": self.notes}
