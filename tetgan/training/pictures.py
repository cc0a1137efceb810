"""A picture of what the model decodes at the moment."""

from collections.abc import Iterator
from itertools import chain, islice
from pathlib import Path

import numpy as np

from tetgan.fields.field import Field, VertexField
from tetgan.fields.store import FieldStore
from tetgan.fields.vertices import vertex_operator
from tetgan.meshing.build import build_solid
from tetgan.meshing.options import MeshingOptions
from tetgan.models.generator import FieldGenerator
from tetgan.models.sampling import generate_fields, reconstruct_fields
from tetgan.rendering.raycast import render_mesh
from tetgan.rendering.sheet import contact_sheet, save_image

SHAPES = 8
SIZE = (220, 220)


def draw_decoded(path: Path, generator: FieldGenerator, store: FieldStore, device: str) -> None:
    """Validation shapes, their reconstructions, and samples of seed 0: three rows of eight."""
    ids = store.ids("validation")[:SHAPES]
    originals = (store.read(shape_id) for shape_id in ids)
    reconstructions = (field for _, field, _ in reconstruct_fields(generator, store, ids, device=device))
    samples = generate_fields(generator, store, SHAPES, seed=0, device=device)
    rows = {"original": originals, "decoded": reconstructions, "sampled": samples}
    images = list(chain.from_iterable(_row(fields, store) for fields in rows.values()))
    save_image(path, contact_sheet(images, SHAPES, row_titles=list(rows)))


def _row(fields: Iterator[Field | VertexField], store: FieldStore) -> Iterator[np.ndarray]:
    """Pictures of the fields, then white up to the length of a row."""
    blank = np.full((SIZE[1], SIZE[0], 3), 255, dtype=np.uint8)
    grid = store.hierarchy.finest
    operator, options = vertex_operator(grid), MeshingOptions.parse({})
    solids = (build_solid(field, grid, operator, store.mu, options, smoothing=True) for field in fields)
    pictures = (render_mesh(solid.vertices, solid.faces, size=SIZE) for solid in solids)
    return islice(chain(pictures, (blank for _ in range(SHAPES))), SHAPES)
