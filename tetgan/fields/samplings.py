"""Points and voxels of a category, over all its shards, as one data set."""

import hashlib
import json
import zlib
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float, Float32, Int
from rich.console import Console
from rich.progress import track

from tetgan.errors import UserError
from tetgan.fields.arrays import ArrayReader, Arrays, write_arrays
from tetgan.fields.dataset import ShardedStore, ShardIndex, enter_shards, read_index, write_index
from tetgan.fields.options import PointOptions, Sampling, ShapeSampling, VoxelOptions
from tetgan.fields.points import draw_points
from tetgan.fields.voxels import sample_distance
from tetgan.shapes.archive import read_meshes

# Arrays of one shape in a shard, with their dimensions.
_DIMENSIONS = {"points": {"points": 2, "occupancy": 1}, "voxels": {"distance": 3}}


class _Index(ShardIndex):
    """What `index.json` holds; `digests` are those of the shard files, in their order."""

    sampling: ShapeSampling
    digests: list[str]


def extract_samplings(meshes: Path, out: Path, options: Sampling) -> None:
    """Stage: sample every mesh of an archive; one mesh is in memory at a time.

    Raises:
        UserError: the archive cannot be read.
    """
    ids = [shape_id for shape_id, _, _ in read_meshes(meshes)]
    progress = track(
        read_meshes(meshes), description=options.kind, total=len(ids), console=Console(stderr=True)
    )
    shapes = (_sample(options, *mesh) for mesh in progress)
    write_arrays(out, ids, shapes, {"sampling": options.model_dump(mode="json")}, "sampling")


def index_samplings(shards: Sequence[Path], catalogue: Path, options: Sampling, out: Path) -> None:
    """Stage: join shards into one data set, the `index.json` that a store opens.

    Args:
        shards: some may be empty.
        catalogue: CSV with columns `id` and `split`; only shapes that are in a shard count.
        options: what the shards were made with.

    Raises:
        UserError: a shard is damaged or was made with other options, a shape is in two shards or not in
            the catalogue, or there is no training shape.
    """
    entries = enter_shards({path: _open_shard(path, options) for path in shards}, catalogue, out)
    if not any("train" in entry.shapes.values() for entry in entries):
        raise UserError(f"{catalogue}: no training shape in any shard; add shapes to the source")
    digests = [hashlib.sha256(path.read_bytes()).hexdigest() for path in shards]
    write_index(_Index(sampling=options, shards=entries, digests=digests), out)


class SamplingStore(ShardedStore[Arrays]):
    """Base class of the data sets of points and of voxels."""

    def __init__(self, path: Path, index: _Index) -> None:
        super().__init__(path, index)
        self._index = index

    @property
    def options(self) -> Sampling:
        """Options with which the shapes were sampled."""
        return self._index.sampling

    @cached_property
    def digest(self) -> str:
        """SHA-256 of what a training depends on: the options, the training ids and the shards."""
        parts = (self.options.model_dump(mode="json"), self.ids("train"), self._index.digests)
        return hashlib.sha256(json.dumps(parts).encode()).hexdigest()

    def _open_shard(self, path: Path) -> ArrayReader:
        return _open_shard(path, self.options)


class PointStore(SamplingStore):
    """Random access to the points of a category, shape by shape."""

    @classmethod
    def open(cls, index_path: str | Path) -> "PointStore":
        """Open the data set of an `index.json`; shards are opened when first read.

        Raises:
            UserError: the index is missing, malformed, or one of voxels.
        """
        return cls(Path(index_path), _read_index(Path(index_path), PointOptions))

    @property
    def box(self) -> float:
        """Side of the cube of points about the centre of the unit cube."""
        assert isinstance(self.options, PointOptions)
        return self.options.box

    def read(self, shape_id: str) -> tuple[Float32[np.ndarray, "N 3"], Bool[np.ndarray, "N"]]:
        """Points of one shape in the order in which they were drawn, and which lie inside.

        Raises:
            KeyError: no such shape.
            UserError: its shard is damaged, or no longer the one that was indexed.
        """
        arrays = self._read(shape_id)
        points = arrays["points"].astype(np.float32)
        return points, np.unpackbits(arrays["occupancy"], count=len(points)).astype(bool)


class VoxelStore(SamplingStore):
    """Random access to the signed distances of a category, shape by shape."""

    @classmethod
    def open(cls, index_path: str | Path) -> "VoxelStore":
        """Open the data set of an `index.json`; shards are opened when first read.

        Raises:
            UserError: the index is missing, malformed, or one of points.
        """
        return cls(Path(index_path), _read_index(Path(index_path), VoxelOptions))

    @property
    def resolution(self) -> int:
        """Cells along a side."""
        assert isinstance(self.options, VoxelOptions)
        return self.options.resolution

    def read(self, shape_id: str) -> Float32[np.ndarray, "R R R"]:
        """Signed distance at the cell centres of the unit cube, in cube sides, negative inside, clamped.

        Raises:
            KeyError: no such shape.
            UserError: its shard is damaged, or no longer the one that was indexed.
        """
        return self._read(shape_id)["distance"].astype(np.float32)


def open_sampling(index_path: Path, kind: str) -> PointStore | VoxelStore:
    """Open the data set of points or voxels, as `kind` says.

    Raises:
        UserError: the index is missing, malformed, or one of the other kind.
    """
    return PointStore.open(index_path) if kind == "points" else VoxelStore.open(index_path)


def _sample(
    options: Sampling, shape_id: str, vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"]
) -> Arrays:
    """What a shard keeps of one shape; half precision holds 5e-4 of a length."""
    if isinstance(options, VoxelOptions):
        return {"distance": sample_distance(vertices, faces, options.resolution).astype(np.float16)}
    seed = (options.seed, zlib.crc32(shape_id.encode()))  # other shapes may come and go
    points, occupancy = draw_points(vertices, faces, options.count, options.box, seed)
    return {"points": points.astype(np.float16), "occupancy": np.packbits(occupancy)}


def _open_shard(path: Path, options: Sampling) -> ArrayReader:
    reader = ArrayReader(path, _DIMENSIONS[options.kind], "sampling")
    if reader.ids and reader.attributes.get("sampling") != options.model_dump(mode="json"):
        raise UserError(f"{path}: made with other options; sample this shard again")
    return reader


def _read_index(path: Path, kind: type[Sampling]) -> _Index:
    index = read_index(path, _Index, "sampling")
    if not isinstance(index.sampling, kind):
        raise UserError(f"{path}: an index of {index.sampling.kind}; name another sampling")
    return index
