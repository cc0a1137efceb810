"""Study: effect of displacement and smoothing on the surfaces of one model."""

import json
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import torch
from jaxtyping import Float
from rich.console import Console
from rich.progress import track
from scipy import sparse

from tetgan.errors import UserError
from tetgan.evaluation.options import EvaluationOptions
from tetgan.evaluation.sections import RealFeatures, Section, draw_real
from tetgan.evaluation.seeds import named_seed
from tetgan.evaluation.surfaces import draw_sample
from tetgan.extractor.features import cloud_features
from tetgan.extractor.network import Classifier, load_classifier
from tetgan.fields.field import Field, VertexField, vertex_operator
from tetgan.fields.store import FieldStore
from tetgan.files import whole_folder
from tetgan.geometry.triangles import TriangleMesh
from tetgan.meshing.options import MeshingOptions
from tetgan.models.files import load_generator
from tetgan.models.generator import FieldGenerator
from tetgan.models.sampling import generate_fields, reconstruct_fields
from tetgan.shapes.archive import read_meshes, write_meshes
from tetgan.shapes.clouds import read_clouds
from tetgan.solids.solid import SolidMesh
from tetgan.studies.options import SmoothingOptions
from tetgan.studies.smoothing.files import EXAMPLE, REPAIRED, REPORT, SHAPES, VARIANTS, Variant
from tetgan.studies.smoothing.rows import Truth, shape_rows
from tetgan.studies.smoothing.smoothers import build_variants

_SPARE = 1.25  # fields drawn for each surface wanted: some may come out empty


def measure_smoothing(
    model: Path,
    index: Path,
    folder: Path,
    *,
    meshes: Sequence[Path],
    clouds: Path,
    extractor: Path,
    study: SmoothingOptions,
    meshing: MeshingOptions,
    evaluation: EvaluationOptions,
    identity: Mapping[str, Any],
) -> None:
    """Measure every variant on a model's reconstructions, and its FID and KID on what the model generates.

    A `representation` reconstructs validation shapes by their own fields, and generates the fields of
    training shapes.

    Args:
        model, index: folder of a trained model, and the fields it was trained on.
        folder: receives `shapes.csv`, `report.json` and `example.zip`.
        meshes: shards of repaired meshes that hold the validation shapes.
        clouds, extractor: hold-out clouds and the trained classifier, for FID and KID.
        identity: what the rows of the table say of the model.

    Raises:
        UserError: an input is not what it should be, or no validation shape has a repaired mesh.
    """
    subject = _Subject.open(model, index, meshing)
    rows, example = _measure_reconstructions(subject, meshes, study, evaluation)
    classifier = load_classifier(extractor, "cuda" if torch.cuda.is_available() else "cpu")
    features = _measure_features(subject, read_clouds(clouds).holdout, classifier, evaluation)
    report = {
        **identity,
        "tets": len(subject.store.hierarchy.finest.tets),
        "extractor": classifier.digest,
        "study": study.model_dump(),
        "meshing": meshing.model_dump(),
        "evaluation": evaluation.model_dump(),
        **features,
    }
    with whole_folder(folder, REPORT) as partial:
        pd.DataFrame(rows).to_csv(partial / SHAPES, index=False)
        (partial / REPORT).write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
        write_meshes(
            partial / EXAMPLE, ((name, mesh.vertices, mesh.faces) for name, mesh in example.items()), []
        )


class _Subject(NamedTuple):
    """A model, the fields it knows, and how they become surfaces."""

    generator: FieldGenerator
    store: FieldStore
    operator: sparse.csr_array
    meshing: MeshingOptions

    @classmethod
    def open(cls, model: Path, index: Path, meshing: MeshingOptions) -> "_Subject":
        store = FieldStore.open(index)
        generator = load_generator(model, store.hierarchy)
        return cls(generator, store, vertex_operator(store.hierarchy.finest), meshing)

    def variants(self, field: Field | VertexField) -> Mapping[Variant, SolidMesh]:
        if not isinstance(field, Field):
            raise UserError(
                "studies.smoothing.models: a model that moves vertices by itself cannot be studied"
            )
        return build_variants(field, self.store.hierarchy.finest, self.operator, self.store.mu, self.meshing)

    def generated(self, count: int, seed: int) -> Iterator[Mapping[Variant, SolidMesh]]:
        """Variants of at most `count` generated fields, those that have a surface."""
        drawn = generate_fields(self.generator, self.store, round(_SPARE * count), seed)
        full = (solids for solids in map(self.variants, drawn) if len(solids[VARIANTS[0]].faces))
        return islice(full, count)


def _measure_reconstructions(
    subject: _Subject, meshes: Sequence[Path], study: SmoothingOptions, evaluation: EvaluationOptions
) -> tuple[list[dict[str, Any]], dict[str, TriangleMesh]]:
    """One row per validation shape and variant; and every surface of the first shape, by name."""
    wanted = subject.store.ids("validation")[: study.shapes]
    repaired = _read_repaired(meshes, wanted)
    ids = [shape_id for shape_id in wanted if shape_id in repaired]
    if not ids:
        raise UserError(f"{', '.join(map(str, meshes))}: no validation shape among these meshes")
    rows: list[dict[str, Any]] = []
    example: dict[str, TriangleMesh] = {}
    fields = reconstruct_fields(subject.generator, subject.store, ids)
    for shape_id, field, _ in track(fields, "smoothing", total=len(ids), console=Console(stderr=True)):
        truth, solids = Truth(shape_id, repaired[shape_id], study, evaluation), subject.variants(field)
        rows += shape_rows(truth, solids)
        if not example:
            example = {REPAIRED: truth.surface}
            example |= {variant.name: solid.surface for variant, solid in solids.items()}
    return rows, example


def _measure_features(
    subject: _Subject,
    holdout: Float[np.ndarray, "N P 3"],
    classifier: Classifier,
    evaluation: EvaluationOptions,
) -> dict[str, Any]:
    """`samples` on each side; `features`, FID and KID by name of the variant; `notes`.

    Never more samples than training shapes, so that a representation gives none of them twice and all
    models are measured at the same N.
    """
    most = min(evaluation.samples, len(holdout), len(subject.store.ids("train")))
    options = evaluation.model_copy(update={"samples": max(2, most)})
    real = draw_real(holdout, "holdout", classifier, options)
    clouds = _draw_clouds(subject, real.points, options)
    estimates: dict[str, Any] = {}
    notes: dict[str, Any] = {}
    for variant, found in clouds.items():
        section = Section(options)
        section.add_feature_distances(_features(found, variant, classifier, real, options), len(found), real)
        estimates[variant.name] = section.to_json()["metrics"]
        notes |= dict.fromkeys(section.notes)
    return {"samples": options.samples, "features": estimates, "notes": list(notes)}


def _draw_clouds(
    subject: _Subject, points: int, options: EvaluationOptions
) -> dict[Variant, list[Float[np.ndarray, "P 3"]]]:
    """Points on every variant of each generated field; the same random numbers for all its variants."""
    clouds: dict[Variant, list[np.ndarray]] = {variant: [] for variant in VARIANTS}
    generated = subject.generated(options.samples, options.seed)
    progress = track(generated, "generating", total=options.samples, console=Console(stderr=True))
    for number, solids in enumerate(progress):
        seed = named_seed(options.seed, "cloud", f"{number:04d}")
        for variant, solid in solids.items():
            drawn = draw_sample(solid.surface, points, seed)
            clouds[variant].append(drawn.points.astype(np.float32))
    return clouds


def _features(
    clouds: Sequence[Float[np.ndarray, "P 3"]],
    variant: Variant,
    classifier: Classifier,
    real: RealFeatures,
    options: EvaluationOptions,
) -> Float[np.ndarray, "N F"] | None:
    """Features of a variant, none where there are too few surfaces on either side."""
    if len(clouds) < options.samples or real.features is None:
        return None
    return cloud_features(np.stack(clouds), classifier.network, variant.name)


def _read_repaired(meshes: Sequence[Path], wanted: Sequence[str]) -> dict[str, TriangleMesh]:
    ids = set(wanted)
    return {
        shape_id: TriangleMesh(vertices, faces)
        for path in meshes
        for shape_id, vertices, faces in read_meshes(path)
        if shape_id in ids
    }
