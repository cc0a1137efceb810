"""Two folders of meshes, from any system, measured against each other."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from tetgan import __version__
from tetgan.errors import UserError
from tetgan.evaluation.chamfer import SurfaceSample, resampled_chamfer
from tetgan.evaluation.meshfolder import MeshFolder, bounding_box, frame_notes
from tetgan.evaluation.options import EvaluationOptions
from tetgan.evaluation.reconstructions import Reconstruction, draw_truth, measure_reconstruction
from tetgan.evaluation.sections import RealFeatures, Section, draw_real_set
from tetgan.evaluation.seeds import choose, named_seed
from tetgan.evaluation.surfaces import Topology, draw_sample, measure_topology
from tetgan.evaluation.variety import pool_size
from tetgan.extractor.features import about_extractor, cloud_features
from tetgan.extractor.network import Classifier, load_classifier
from tetgan.nn.device import pick_device

CLOUD_POINTS = 2048
"""Points a shape: features take the farthest of them, JSD counts them all. The workflow has as many."""


def measure_folders(
    samples: Path,
    reference: Path,
    *,
    options: EvaluationOptions,
    extractor: Path | None = None,
    reconstructions: Path | None = None,
    training: Path | None = None,
    fit: bool = False,
    threads: int = 1,
) -> dict[str, Any]:
    """Measure generated meshes against real ones, and one half of the real ones against the other.

    Args:
        samples, reference: folders of meshes (see `MeshFolder`).
        options: conventions; no more shapes are compared than the smaller folder has.
        extractor: folder of a trained classifier; without it there are no feature metrics.
        reconstructions: meshes named as those of the reference that they should be.
        training: what the generator learned from, for novelty.
        fit: move and scale every mesh into the unit cube; else they are measured as they are stored.
        threads: KD-tree queries side by side; torch's own number is left as it is.

    Raises:
        UserError: a folder with fewer than two usable meshes, or an input that is not what it should be.
    """
    classifier = load_classifier(extractor, pick_device("auto")) if extractor else None
    given = {
        "samples": samples,
        "reference": reference,
        "reconstructions": reconstructions,
        "training": training,
    }
    folders = {name: MeshFolder(path, fit) for name, path in given.items() if path}
    found, real = (_read_shapes(folders[name], name, options) for name in ("samples", "reference"))
    known = _read_training(folders["training"], options) if training else None
    pairs, missing = _measure_pairs(folders.get("reconstructions"), folders["reference"], options)
    limited = options.at_most(min(len(found.clouds), len(real.clouds)))
    generated = _side(found, limited.samples, classifier)
    halves = _side(real, 2 * max(options.samples, options.sets.shapes), classifier)
    section = _compare(generated, halves, found, training=known, options=limited, threads=threads)
    section.add_reconstructions([pair.found for pair in pairs], missing)
    section.notes += frame_notes(np.array(found.boxes), np.array(real.boxes))
    return {
        **{name: str(path) if path else None for name, path in given.items()},
        "fitted": fit,
        "cloud_points": CLOUD_POINTS,
        "version": __version__,
        "extractor": about_extractor(classifier) if classifier else None,
        "options": limited.model_dump(mode="json"),
        "meshes": {name: folder.count() for name, folder in folders.items()},
        "found": section.to_json(),
        "floor": _floor(halves, real, pairs, training=known, options=options, threads=threads),
        "problems": {path: why for folder in folders.values() for path, why in folder.problems.items()},
    }


@dataclass
class _Shapes:
    """Clouds and measures from one pass over a folder's meshes, in random order."""

    files: int
    clouds: list[Float[np.ndarray, "P 3"]] = field(default_factory=list)
    samples: list[SurfaceSample] = field(default_factory=list)
    faces: list[int] = field(default_factory=list)
    topology: list[Topology] = field(default_factory=list)
    boxes: list[Float[np.ndarray, "2 3"]] = field(default_factory=list)


class _Side(NamedTuple):
    """Clouds of a set, and features of as many as may be compared; none without an extractor."""

    clouds: Float[np.ndarray, "N P 3"]
    features: Float[np.ndarray, "M F"] | None

    def part(self, start: int, stop: int) -> "_Side":
        features = None if self.features is None else self.features[start:stop]
        return _Side(self.clouds[start:stop], features)


class _Pair(NamedTuple):
    """A reconstruction, and its original beside itself."""

    found: Reconstruction
    floor: Reconstruction


def _read_shapes(folder: MeshFolder, purpose: str, options: EvaluationOptions) -> _Shapes:
    """The order is random, so that the first shapes are always a fair draw."""
    names = choose(folder.files, len(folder.files), options.seed, purpose)
    pool = set(choose(folder.files, pool_size(options.variety), options.seed, "variety"))
    shapes = _Shapes(len(folder.files))
    for name, surface in folder.surfaces(names):
        seed = named_seed(options.seed, purpose, name)
        shapes.clouds.append(draw_sample(surface, CLOUD_POINTS, seed).points.astype(np.float32))
        shapes.faces.append(len(surface.faces))
        shapes.topology.append(measure_topology(surface.faces))
        shapes.boxes.append(bounding_box(surface.vertices))
        if name in pool:
            shapes.samples.append(draw_sample(surface, options.points, seed))
    if len(shapes.clouds) < 2:
        raise UserError(
            f"{folder.root}: {len(shapes.clouds)} of {len(folder.files)} meshes can be used, and it takes two"
            f"{folder.first_problem()}"
        )
    return shapes


def _read_training(folder: MeshFolder, options: EvaluationOptions) -> Float[np.ndarray, "N P 3"]:
    clouds = [
        draw_sample(surface, options.sets.points, named_seed(options.seed, "training", name)).points
        for name, surface in folder.surfaces(sorted(folder.files))
    ]
    if not clouds:
        raise UserError(f"{folder.root}: no mesh can be used{folder.first_problem()}")
    return np.array(clouds)


def _measure_pairs(
    found: MeshFolder | None, reference: MeshFolder, options: EvaluationOptions
) -> tuple[list[_Pair], int]:
    """Every reconstruction that has an original of its name, and how many of those have no surface."""
    pairs: list[_Pair] = []
    if found is None:
        return pairs, 0
    for name, surface in found.surfaces(sorted(found.files)):
        if name not in reference.files:
            found.problems[str(found.files[name])] = f"no '{name}' in {reference.root}"
            continue
        original = reference.surface(name)
        if original is not None:
            truth = draw_truth(original, name, options)
            measured = (
                measure_reconstruction(each, original, truth, name, options) for each in (surface, original)
            )
            pairs.append(_Pair(*measured))
    missing = [name for name in found.unusable() if name in set(reference.files) - reference.unusable()]
    return pairs, len(missing)


def _side(shapes: _Shapes, most: int, classifier: Classifier | None) -> _Side:
    clouds = np.array(shapes.clouds)
    return _Side(clouds, cloud_features(clouds[:most], classifier.network) if classifier else None)


def _compare(
    found: _Side,
    real: _Side,
    shapes: _Shapes,
    *,
    training: Float[np.ndarray, "N P 3"] | None,
    options: EvaluationOptions,
    threads: int,
) -> Section:
    """One set beside another; `shapes` are those whose meshes and variety are measured."""
    section = Section(options)
    section.count_samples(shapes.files, len(shapes.faces))
    section.add_means({"faces": shapes.faces})
    section.add_topology(shapes.topology)
    section.add_variety(shapes.samples, threads)
    section.add_set_distances(found.clouds, draw_real_set(real.clouds, "reference", options))
    section.add_novelty(found.clouds, training)
    if found.features is not None and real.features is not None:
        features = RealFeatures(real.features[: options.samples], CLOUD_POINTS, len(real.clouds))
        section.add_feature_distances(found.features[: options.samples], len(found.clouds), features)
    return section


def _floor(
    real: _Side,
    shapes: _Shapes,
    pairs: list[_Pair],
    *,
    training: Float[np.ndarray, "N P 3"] | None,
    options: EvaluationOptions,
    threads: int,
) -> dict[str, Any] | None:
    """One half of the reference beside the other; None where a half would be a single mesh."""
    half = min(len(real.clouds) // 2, max(options.samples, options.sets.shapes))
    if half < 2:
        return None
    limited = options.at_most(half)
    first, second = real.part(0, half), real.part(half, 2 * half)
    section = _compare(first, second, shapes, training=training, options=limited, threads=threads)
    section.add_reconstructions([pair.floor for pair in pairs])
    section.note_resampled([resampled_chamfer(cloud, options.sets.points) for cloud in real.clouds])
    return section.to_json()
