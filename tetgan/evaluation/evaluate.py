"""Stages: measure the samples of a model, and real shapes against real shapes."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import torch
from jaxtyping import Float
from rich.console import Console
from rich.progress import track

from tetgan.errors import UserError
from tetgan.evaluation.chamfer import SurfaceSample, resampled_chamfer
from tetgan.evaluation.metrics import names_of
from tetgan.evaluation.options import EvaluationOptions
from tetgan.evaluation.originals import read_splits, repaired_meshes, training_cloud, training_clouds
from tetgan.evaluation.reconstructions import Reconstruction, draw_truth, measure_reconstruction
from tetgan.evaluation.sections import RealFeatures, RealSet, Section, draw_clouds, draw_real, draw_real_set
from tetgan.evaluation.seeds import choose, named_seed
from tetgan.evaluation.surfaces import Topology, draw_sample, measure_topology
from tetgan.evaluation.variety import pool_size
from tetgan.extractor.features import about_extractor, cloud_features
from tetgan.extractor.network import Classifier, load_classifier
from tetgan.files import whole_file
from tetgan.geometry.triangles import TriangleMesh
from tetgan.shapes.clouds import read_clouds
from tetgan.solids.folder import SampleFolder

SMOOTHINGS = ("none", "wls")
"""Folders of a model's samples: without, and with the weighted Laplacian smoothing of Eq. 4."""


def evaluate_model(
    samples: Path,
    meshes: Sequence[Path],
    clouds: Path,
    extractor: Path,
    *,
    options: EvaluationOptions,
    identity: Mapping[str, Any],
    out: Path,
    catalogue: Path | None = None,
    threads: int = 1,
) -> None:
    """Measure a model's reconstructions against the repaired meshes, and its samples against the hold-out.

    Args:
        samples: folder with `none/`, `wls/` or both (see `SampleFolder`), and perhaps `about.json`.
        meshes: shards of repaired meshes that hold the shapes reconstructed.
        clouds: clouds of the category's surfaces.
        extractor: folder of the trained classifier.
        options: conventions (docs/metrics.md).
        identity: what the row of a table says of the model; `about.json` adds to it.
        out: JSON to write.
        catalogue: tells which of the meshes are training shapes; without it there is no novelty.
        threads: KD-tree queries side by side; torch's own number is left as it is.

    Raises:
        UserError: no samples, or an input that is not what it should be.
    """
    folders = {name: SampleFolder(samples / name) for name in SMOOTHINGS if (samples / name).is_dir()}
    if not folders:
        raise UserError(f"{samples}: no samples; expected a folder 'none' or 'wls' in it")
    classifier = _load_extractor(extractor)
    real = read_clouds(clouds)
    options = options.at_most(len(real.holdout))
    yardstick = _Yardstick(
        options,
        classifier,
        draw_real(real.holdout, "holdout", classifier, options),
        draw_real_set(real.holdout, "holdout", options),
        training_clouds(meshes, read_splits(catalogue), options) if catalogue else None,
        threads,
    )
    reconstructions = _measure_reconstructions(folders, meshes, options)
    sections = {
        name: _measure_smoothing(folder, reconstructions[name], yardstick) for name, folder in folders.items()
    }
    _write_report({**_about(samples), **identity}, classifier, options, sections, out)


def evaluate_real(
    meshes: Sequence[Path],
    catalogue: Path,
    clouds: Path,
    extractor: Path,
    *,
    options: EvaluationOptions,
    category: str,
    out: Path,
    threads: int = 1,
) -> None:
    """Measure real shapes as if they had been generated: the floor, or ceiling, of every metric.

    Features and sets compare training clouds with hold-out clouds; Chamfer and its kin each validation mesh
    with itself, sampled twice; novelty is that of hold-out clouds beside the training meshes; variety that of
    training meshes; faces and manifold edges those of all repaired meshes.

    Args:
        meshes, catalogue: shards of repaired meshes, and the catalogue that splits them.
        category: its name, for the table.
        clouds, extractor, options, out, threads: as `evaluate_model`.

    Raises:
        UserError: an input that is not what it should be.
    """
    classifier = _load_extractor(extractor)
    real = read_clouds(clouds)
    options = options.at_most(len(real.holdout))
    repaired = _measure_repaired(meshes, read_splits(catalogue), options)
    section = Section(options)
    section.add_reconstructions(repaired.floor)
    section.add_means({"faces": repaired.faces})
    section.add_topology(repaired.topology)
    section.add_variety(repaired.samples, threads)
    holdout = draw_real(real.holdout, "holdout", classifier, options)
    train = draw_real(real.train, "train", classifier, options)
    section.add_feature_distances(train.features, train.available, holdout)
    training = np.array(repaired.training).reshape(-1, options.sets.points, 3)
    section.add_set_distances(
        draw_clouds(real.train, "train", options), draw_real_set(real.holdout, "holdout", options)
    )
    section.add_novelty(draw_clouds(real.holdout, "holdout", options), training)
    section.note_resampled(repaired.resampled)
    section.count_samples(len(repaired.faces), len(repaired.faces))
    identity = {"category": category, "model": "real", "method": "real"}
    _write_report(identity, classifier, options, {"none": section}, out)


class _Yardstick(NamedTuple):
    """Reference sets and options shared by all smoothings of a model."""

    options: EvaluationOptions
    classifier: Classifier
    holdout: RealFeatures
    reference: RealSet
    training: Float[np.ndarray, "N P 3"] | None
    threads: int


@dataclass
class _Reconstructions:
    """Those of one smoothing that have a surface, and how many have none."""

    found: list[Reconstruction] = field(default_factory=list)
    missing: int = 0


@dataclass
class _Repaired:
    """Measures of a category's repaired meshes; `resampled` is the floor with the points of sets."""

    floor: list[Reconstruction] = field(default_factory=list)
    resampled: list[float] = field(default_factory=list)
    faces: list[int] = field(default_factory=list)
    topology: list[Topology] = field(default_factory=list)
    samples: list[SurfaceSample] = field(default_factory=list)
    training: list[Float[np.ndarray, "P 3"]] = field(default_factory=list)


def _load_extractor(folder: Path) -> Classifier:
    return load_classifier(folder, "cuda" if torch.cuda.is_available() else "cpu")


def _about(samples: Path) -> dict[str, Any]:
    path = samples / "about.json"
    return json.loads(path.read_text()) if path.is_file() else {}


def _measure_smoothing(
    folder: SampleFolder, reconstructions: _Reconstructions, yardstick: _Yardstick
) -> Section:
    """Faces are those of reconstructions, edges, tets and solids those of generated shapes; where a model has
    only the one kind, all are of that kind."""
    options = yardstick.options
    generated = _read_generated(folder)
    section = Section(options)
    section.add_reconstructions(reconstructions.found, reconstructions.missing)
    topology = [measure_topology(surface.faces) for surface in generated.values()]
    section.add_topology(topology or [item.topology for item in reconstructions.found])
    inverted = folder.inverted_shares("generated")
    section.add_means(
        {
            "faces": [item.faces for item in reconstructions.found]
            or [len(s.faces) for s in generated.values()],
            "iou": folder.certified("reconstructed", "iou"),
            "inverted_tets": inverted if len(inverted) else folder.inverted_shares("reconstructed"),
        }
    )
    for column in (*names_of("solids"), "valid"):
        made = folder.of_solids("generated", column)
        section.add_means({column: made if len(made) else folder.of_solids("reconstructed", column)})
    section.add_variety(_samples_for_variety(generated, options), yardstick.threads)
    clouds = _generated_clouds(generated, yardstick.holdout.points, options)
    section.add_feature_distances(_generated_features(clouds, yardstick), len(generated), yardstick.holdout)
    section.add_set_distances(clouds, yardstick.reference)
    section.add_novelty(clouds, yardstick.training)
    section.count_samples(len(folder.ids("generated")), len(generated))
    section.count("reconstructed", len(folder.ids("reconstructed")), len(reconstructions.found))
    return section


def _read_generated(folder: SampleFolder) -> dict[str, TriangleMesh]:
    """Generated shapes that have a surface, by id."""
    ids = track(folder.ids("generated"), "generated meshes", console=Console(stderr=True), transient=True)
    surfaces = ((shape_id, folder.surface("generated", shape_id)) for shape_id in ids)
    return {shape_id: surface for shape_id, surface in surfaces if surface is not None}


def _samples_for_variety(
    generated: Mapping[str, TriangleMesh], options: EvaluationOptions
) -> list[SurfaceSample]:
    return [
        draw_sample(generated[shape_id], options.points, named_seed(options.seed, "generated", shape_id))
        for shape_id in choose(generated, pool_size(options.variety), options.seed, "variety")
    ]


def _generated_clouds(
    generated: Mapping[str, TriangleMesh], points: int, options: EvaluationOptions
) -> Float[np.ndarray, "N P 3"]:
    """Points on as many generated surfaces, drawn at random, as features or sets need."""
    wanted = max(options.samples, options.sets.shapes)
    clouds = [
        draw_sample(generated[i], points, named_seed(options.seed, "cloud", i)).points
        for i in choose(generated, wanted, options.seed, "features")
    ]
    return np.array(clouds, dtype=np.float32).reshape(-1, points, 3)


def _generated_features(
    clouds: Float[np.ndarray, "M P 3"], yardstick: _Yardstick
) -> Float[np.ndarray, "N F"] | None:
    """Features of as many generated surfaces as there are hold-out clouds, sampled as finely as those."""
    needed = yardstick.options.samples
    if yardstick.holdout.features is None or len(clouds) < needed:
        return None
    return cloud_features(clouds[:needed], yardstick.classifier.network, "generated features")


def _measure_reconstructions(
    folders: Mapping[str, SampleFolder], meshes: Sequence[Path], options: EvaluationOptions
) -> dict[str, _Reconstructions]:
    """Every reconstruction against its original, which is sampled once for all smoothings."""
    wanted = {shape_id for folder in folders.values() for shape_id in folder.ids("reconstructed")}
    measured = {name: _Reconstructions() for name in folders}
    for shape_id, original in repaired_meshes(meshes):
        if shape_id not in wanted:
            continue
        truth = draw_truth(original, shape_id, options)
        for name, folder in folders.items():
            surface = folder.surface("reconstructed", shape_id)
            if surface is None:
                measured[name].missing += 1
                continue
            found = measure_reconstruction(surface, original, truth, shape_id, options)
            measured[name].found.append(found)
    return measured


def _measure_repaired(
    meshes: Sequence[Path], splits: Mapping[str, str], options: EvaluationOptions
) -> _Repaired:
    training = [shape_id for shape_id, split in splits.items() if split == "train"]
    pool = set(choose(training, pool_size(options.variety), options.seed, "variety"))
    repaired = _Repaired()
    for shape_id, surface in repaired_meshes(meshes):
        repaired.faces.append(len(surface.faces))
        repaired.topology.append(measure_topology(surface.faces))
        if splits.get(shape_id) == "validation":
            truth = draw_truth(surface, shape_id, options)
            repaired.floor.append(measure_reconstruction(surface, surface, truth, shape_id, options))
            repaired.resampled.append(resampled_chamfer(truth.points, options.sets.points))
        if splits.get(shape_id) == "train":
            repaired.training.append(training_cloud(shape_id, surface, options))
        if shape_id in pool:
            seed = named_seed(options.seed, "generated", shape_id)
            repaired.samples.append(draw_sample(surface, options.points, seed))
    return repaired


def _write_report(
    identity: Mapping[str, Any],
    classifier: Classifier,
    options: EvaluationOptions,
    sections: Mapping[str, Section],
    out: Path,
) -> None:
    report = {
        **identity,
        "extractor": about_extractor(classifier),
        "options": options.model_dump(mode="json"),
        "smoothings": {name: section.to_json() for name, section in sections.items()},
    }
    with whole_file(out) as partial:
        partial.write_text(json.dumps(report, indent=1) + "\n")
