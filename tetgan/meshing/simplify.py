"""Stage: the samples of a model again, with fewer faces."""

import logging
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from rich.console import Console
from rich.progress import track

from tetgan.errors import UserError
from tetgan.geometry.triangles import TriangleMesh
from tetgan.shapes.cleaning import ShapeError
from tetgan.shapes.isolation import SimplifyWorker
from tetgan.shapes.options import SimplifyOptions
from tetgan.solids.export import write_surface
from tetgan.solids.folder import CERTIFICATE, CERTIFICATES, read_certificates, write_certificates
from tetgan.solids.record import surface_record

log = logging.getLogger(__name__)


def simplify_samples(samples: Path, folder: Path, options: SimplifyOptions) -> None:
    """Simplify every surface of a folder of samples by quadric edge collapse.

    Args:
        samples: holds `{smoothing}/{generated,reconstructed}/{id}.ply` with a `certificate.csv` each.
        folder: receives the same with fewer faces, no solids, and `about.json` as it is. A surface that was
            missing, or that cannot be simplified, gets a row of zeros and no file; `reason` says why.

    Raises:
        UserError: there are no samples.
    """
    parts = sorted(path.parent for path in samples.glob(CERTIFICATES))
    if not parts:
        raise UserError(f"{samples}: no samples; expected a folder 'none' or 'wls' with {CERTIFICATE} in it")
    with SimplifyWorker(options) as worker:
        for part in parts:
            _simplify_part(part, folder / part.name, worker)
    if (samples / "about.json").is_file():
        shutil.copyfile(samples / "about.json", folder / "about.json")


def _simplify_part(part: Path, folder: Path, worker: SimplifyWorker) -> None:
    certificates = read_certificates(part)
    assert certificates is not None
    shapes, rows = list(zip(certificates["set"], certificates["id"], strict=True)), []
    for kind, shape_id in track(shapes, description="simplifying", console=Console(stderr=True)):
        name = Path(kind) / f"{shape_id}.ply"
        record = _simplify_surface(part / name, folder / name, worker)
        rows.append({"set": kind, "id": shape_id, **record})
    write_certificates(folder, rows)


def _simplify_surface(source: Path, target: Path, worker: SimplifyWorker) -> dict[str, Any]:
    """The columns of one surface's row; its file is written if there is anything to write."""
    nothing = TriangleMesh(np.empty((0, 3)), np.empty((0, 3), dtype=np.int64))
    if not source.is_file():
        return {**surface_record(nothing), "reason": "no surface"}
    try:
        mesh = trimesh.load_mesh(source, process=False)
        simplified = worker.simplify(
            TriangleMesh(np.array(mesh.vertices), np.array(mesh.faces, dtype=np.int64))
        )
    except Exception as error:  # a model can make a mesh that breaks any parser
        reason = str(error) if isinstance(error, ShapeError) else f"{type(error).__name__}: {error}"
        log.warning("%s: %s", source, reason)
        return {**surface_record(nothing), "reason": " ".join(reason.split())}
    if len(simplified.faces):
        write_surface(target, simplified)
    return {**surface_record(simplified), "reason": ""}
