"""Stages: measure the samples of a model, and real shapes against real shapes."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import torch
from jaxtyping import Float
from rich.console import Console
from rich.progress import track

from tetgan.errors import UserError
from tetgan.evaluation.chamfer import SurfaceDistance, SurfaceSample, compare_surfaces
from tetgan.evaluation.features import cloud_features
from tetgan.evaluation.options import EvaluationOptions
from tetgan.evaluation.samples import SOLID_METRICS, SampleFolder
from tetgan.evaluation.sections import RealFeatures, Section, draw_real
from tetgan.evaluation.seeds import named_rng, named_seed
from tetgan.evaluation.surfaces import Surface, Topology, draw_sample, measure_topology
from tetgan.files import whole_file
from tetgan.models.pointnet2 import Classifier, load_classifier
from tetgan.shapes.archive import read_meshes
from tetgan.shapes.catalogue import read_catalogue
from tetgan.shapes.clouds import read_clouds

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
        threads: KD-tree queries side by side; torch's own number is left as it is.

    Raises:
        UserError: no samples, or an input that is not what it should be.
    """
    folders = {name: SampleFolder(samples / name) for name in SMOOTHINGS if (samples / name).is_dir()}
    if not folders:
        raise UserError(f"{samples}: no samples; expected a folder 'none' or 'wls' in it")
    classifier = _load_extractor(extractor)
    real = read_clouds(clouds)
    options = _within_holdout(options, len(real.holdout))
    holdout = draw_real(real.holdout, "holdout", classifier, options)
    yardstick = _Yardstick(options, classifier, holdout, threads)
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

    FID and KID compare training clouds with hold-out clouds; Chamfer and its kin each validation mesh with
    itself, sampled twice; variety is that of training meshes; faces and manifold edges those of all repaired
    meshes.

    Args:
        meshes, catalogue: shards of repaired meshes, and the catalogue that splits them.
        category: its name, for the table.
        clouds, extractor, options, out, threads: as `evaluate_model`.

    Raises:
        UserError: an input that is not what it should be.
    """
    classifier = _load_extractor(extractor)
    real = read_clouds(clouds)
    options = _within_holdout(options, len(real.holdout))
    repaired = _measure_repaired(meshes, _splits(catalogue), options)
    section = Section(options)
    section.add_distances(repaired.floor)
    section.add_means({"faces": repaired.faces})
    section.add_topology(repaired.topology)
    section.add_variety(repaired.samples, threads)
    holdout = draw_real(real.holdout, "holdout", classifier, options)
    train = draw_real(real.train, "train", classifier, options)
    section.add_feature_distances(train.features, train.available, holdout)
    section.count("generated", len(repaired.faces), len(repaired.faces))
    identity = {"category": category, "model": "real"}
    _write_report(identity, classifier, options, {"none": section}, out)


def _within_holdout(options: EvaluationOptions, held_out: int) -> EvaluationOptions:
    """Options that ask for no more surfaces than are held out, so that every row has the same N."""
    return options.model_copy(update={"samples": max(2, min(options.samples, held_out))})


class _Yardstick(NamedTuple):
    """What every smoothing of a model is measured with."""

    options: EvaluationOptions
    classifier: Classifier
    holdout: RealFeatures
    threads: int


class _Reconstruction(NamedTuple):
    """How far from the truth, and what it is made of."""

    distance: SurfaceDistance
    faces: int
    topology: Topology


@dataclass
class _Repaired:
    """What the repaired meshes of a category say."""

    floor: list[SurfaceDistance] = field(default_factory=list)
    faces: list[int] = field(default_factory=list)
    topology: list[Topology] = field(default_factory=list)
    samples: list[SurfaceSample] = field(default_factory=list)


def _load_extractor(folder: Path) -> Classifier:
    return load_classifier(folder, "cuda" if torch.cuda.is_available() else "cpu")


def _about(samples: Path) -> dict[str, Any]:
    path = samples / "about.json"
    return json.loads(path.read_text()) if path.is_file() else {}


def _measure_smoothing(
    folder: SampleFolder, reconstructions: Sequence[_Reconstruction], yardstick: _Yardstick
) -> Section:
    """Faces are those of reconstructions, edges, tets and solids those of generated shapes; where a model has
    only the one kind, all are of that kind."""
    options = yardstick.options
    generated = _read_generated(folder)
    section = Section(options)
    section.add_distances([item.distance for item in reconstructions])
    topology = [measure_topology(surface.faces) for surface in generated.values()]
    section.add_topology(topology or [item.topology for item in reconstructions])
    inverted = folder.inverted_shares("generated")
    section.add_means(
        {
            "faces": [item.faces for item in reconstructions] or [len(s.faces) for s in generated.values()],
            "iou": folder.certified("reconstructed", "iou"),
            "inverted_tets": inverted if len(inverted) else folder.inverted_shares("reconstructed"),
        }
    )
    for column in SOLID_METRICS:
        made = folder.of_solids("generated", column)
        section.add_means({column: made if len(made) else folder.of_solids("reconstructed", column)})
    section.add_variety(_samples_for_variety(generated, options), yardstick.threads)
    section.add_feature_distances(
        _generated_features(generated, yardstick), len(generated), yardstick.holdout
    )
    section.count("generated", len(folder.ids("generated")), len(generated))
    section.count("reconstructed", len(folder.ids("reconstructed")), len(reconstructions))
    return section


def _read_generated(folder: SampleFolder) -> dict[str, Surface]:
    """Generated shapes that have a surface, by id."""
    ids = track(folder.ids("generated"), "generated meshes", console=Console(stderr=True), transient=True)
    surfaces = ((shape_id, folder.surface("generated", shape_id)) for shape_id in ids)
    return {shape_id: surface for shape_id, surface in surfaces if surface is not None}


def _samples_for_variety(generated: Mapping[str, Surface], options: EvaluationOptions) -> list[SurfaceSample]:
    return [
        draw_sample(generated[shape_id], options.points, named_seed(options.seed, "generated", shape_id))
        for shape_id in _choose(generated, _variety_pool(options), "variety", options)
    ]


def _generated_features(
    generated: Mapping[str, Surface], yardstick: _Yardstick
) -> Float[np.ndarray, "N F"] | None:
    """Features of as many generated surfaces as there are hold-out clouds, sampled as finely as those."""
    options = yardstick.options
    if yardstick.holdout.features is None or len(generated) < options.samples:
        return None
    clouds = [
        draw_sample(generated[i], yardstick.holdout.points, named_seed(options.seed, "cloud", i)).points
        for i in _choose(generated, options.samples, "features", options)
    ]
    return cloud_features(
        np.stack(clouds).astype(np.float32), yardstick.classifier.network, "generated features"
    )


def _measure_reconstructions(
    folders: Mapping[str, SampleFolder], meshes: Sequence[Path], options: EvaluationOptions
) -> dict[str, list[_Reconstruction]]:
    """Every reconstruction against its original, which is sampled once for all smoothings."""
    wanted = {shape_id for folder in folders.values() for shape_id in folder.ids("reconstructed")}
    measured: dict[str, list[_Reconstruction]] = {name: [] for name in folders}
    for shape_id, original in _repaired_meshes(meshes):
        if shape_id not in wanted:
            continue
        truth = draw_sample(original, options.points, named_seed(options.seed, "truth", shape_id))
        for name, folder in folders.items():
            surface = folder.surface("reconstructed", shape_id)
            if surface is not None:
                distance = _distance(surface, truth, shape_id, options)
                topology = measure_topology(surface.faces)
                measured[name].append(_Reconstruction(distance, len(surface.faces), topology))
    return measured


def _measure_repaired(
    meshes: Sequence[Path], splits: Mapping[str, str], options: EvaluationOptions
) -> _Repaired:
    training = [shape_id for shape_id, split in splits.items() if split == "train"]
    pool = set(_choose(training, _variety_pool(options), "variety", options))
    repaired = _Repaired()
    for shape_id, surface in _repaired_meshes(meshes):
        repaired.faces.append(len(surface.faces))
        repaired.topology.append(measure_topology(surface.faces))
        if splits.get(shape_id) == "validation":
            truth = draw_sample(surface, options.points, named_seed(options.seed, "truth", shape_id))
            repaired.floor.append(_distance(surface, truth, shape_id, options))
        elif shape_id in pool:
            seed = named_seed(options.seed, "generated", shape_id)
            repaired.samples.append(draw_sample(surface, options.points, seed))
    return repaired


def _distance(
    surface: Surface, truth: SurfaceSample, shape_id: str, options: EvaluationOptions
) -> SurfaceDistance:
    found = draw_sample(surface, options.points, named_seed(options.seed, "reconstructed", shape_id))
    return compare_surfaces(found, truth, options.fscore_threshold)


def _repaired_meshes(meshes: Sequence[Path]) -> Iterator[tuple[str, Surface]]:
    for path in track(meshes, "repaired meshes", console=Console(stderr=True), transient=True):
        for shape_id, vertices, faces in read_meshes(path):
            yield shape_id, Surface(vertices, faces)


def _splits(catalogue: Path) -> dict[str, str]:
    """Split of every shape that has a repaired mesh."""
    table = read_catalogue(catalogue)
    table = table[table["status"].isin(["ok", "filled"])]
    return dict(zip(table["id"], table["split"], strict=True))


def _variety_pool(options: EvaluationOptions) -> int:
    """Shapes that variety draws from at most: enough for every pair of a draw to have its own two."""
    return 2 * options.variety.pairs


def _choose(
    ids: Sequence[str] | Mapping[str, Any], most: int, purpose: str, options: EvaluationOptions
) -> list[str]:
    """At most so many of the ids, without replacement; the order in which they come plays no part."""
    order = named_rng(options.seed, "choose", purpose).permutation(sorted(ids))
    return [str(shape_id) for shape_id in order[:most]]


def _write_report(
    identity: Mapping[str, Any],
    classifier: Classifier,
    options: EvaluationOptions,
    sections: Mapping[str, Section],
    out: Path,
) -> None:
    extractor = {
        "digest": classifier.digest,
        "accuracy": classifier.accuracy,
        "categories": list(classifier.categories),
    }
    report = {
        **identity,
        "extractor": extractor,
        "options": options.model_dump(mode="json"),
        "smoothings": {name: section.to_json() for name, section in sections.items()},
    }
    with whole_file(out) as partial:
        partial.write_text(json.dumps(report, indent=1) + "\n")
