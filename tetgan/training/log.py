"""Training log: one row per epoch in log.csv, and the same numbers for TensorBoard."""

import csv
import math
from collections import defaultdict
from pathlib import Path
from typing import Any

from torch import Tensor
from torch.utils.tensorboard import SummaryWriter

from tetgan.files import whole_file

Row = dict[str, float | int]

Losses = dict[str, float | Tensor]
"""Numbers of a step by name; tensors stay where they are, so that no step waits for them."""


class RunLog:
    """Rows of finished epochs, and sums of the one under way; on disk too, if it `writes`."""

    def __init__(self, folder: Path, columns: tuple[str, ...], writes: bool = True) -> None:
        self.folder, self.columns = folder, columns
        self.rows: list[Row] = []
        self.sums: dict[str, list[Any]] = defaultdict(lambda: [0.0, 0])
        self._writer = SummaryWriter(str(folder / "events")) if writes else None

    def add(self, losses: Losses) -> None:
        """Count the losses of one step towards the epoch's means."""
        for name, value in losses.items():
            self.sums[name][0] += value.double() if isinstance(value, Tensor) else value
            self.sums[name][1] += 1

    def is_finite(self) -> bool:
        """Whether the losses of the epoch under way are."""
        return all(math.isfinite(value) for value in self._means().values())

    def _means(self) -> dict[str, float]:
        return {name: float(total) / count for name, (total, count) in self.sums.items()}

    def finish_epoch(self, epoch: int, further: Row) -> None:
        """Close the epoch's row and write it; `further` are numbers that are not means over steps."""
        row: Row = {"epoch": epoch, **further, **self._means()}
        self.sums.clear()
        self.rows.append(row)
        if self._writer is not None:
            self._write_csv()
            for name in row.keys() - {"epoch"}:
                self._writer.add_scalar(name, row[name], epoch)
            self._writer.flush()

    def _write_csv(self) -> None:
        with whole_file(self.folder / "log.csv") as partial, partial.open("w", newline="") as stream:
            table = csv.DictWriter(stream, self.columns, restval="")
            table.writeheader()
            table.writerows({name: _short(value) for name, value in row.items()} for row in self.rows)

    def state(self) -> dict[str, Any]:
        """State that a checkpoint keeps."""
        return {
            "rows": self.rows,
            "sums": {name: [float(total), count] for name, (total, count) in self.sums.items()},
        }

    def restore(self, state: dict[str, Any]) -> None:
        """Go on from a checkpoint."""
        self.rows = state["rows"]
        self.sums.update(state["sums"])

    def close(self) -> None:
        if self._writer is not None:
            self._writer.close()


def _short(value: float | int) -> str:
    return f"{value:.6g}" if math.isfinite(value) else "nan"
