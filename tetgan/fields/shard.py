"""One Zarr file with the fields of a shard of shapes."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from tetgan.fields.arrays import ArrayReader, write_arrays
from tetgan.fields.field import Field


def write_shard(path: str | Path, ids: list[str], fields: Iterable[Field], grid_digest: str) -> None:
    """Write the fields of `ids`, in that order; the same input gives the same bytes.

    Displacement is kept as float16, 5e-4 of its size. `fields` may be a generator: one is in memory at a
    time.

    Raises:
        ValueError: not as many fields as ids.
    """
    shapes = (
        {"occupancy": field.occupancy, "displacement": field.displacement.astype(np.float16)}
        for field in fields
    )
    write_arrays(path, ids, shapes, {"grid_digest": grid_digest}, "field")


class ShardReader:
    """The shapes of one shard file.

    Attributes:
        ids: in the order of the shard.
        grid_digest: of the hierarchy that the fields were extracted on.

    Raises:
        UserError: on opening or reading, the file is missing, damaged or no field shard.
    """

    def __init__(self, path: str | Path) -> None:
        self._reader = ArrayReader(path, {"occupancy": 1, "displacement": 2}, "field")
        self.ids = self._reader.ids
        self.grid_digest = str(self._reader.attributes.get("grid_digest"))

    def read(self, shape_id: str) -> Field:
        """One shape's field.

        Raises:
            KeyError: no such shape here.
        """
        arrays = self._reader.read(shape_id)
        return Field(arrays["occupancy"], arrays["displacement"].astype(np.float32))
