"""The course of a run: one row an epoch in log.csv, the same numbers for TensorBoard."""

import csv
import math
from collections import defaultdict
from pathlib import Path
from typing import Any

from torch import Tensor
from torch.utils.tensorboard import SummaryWriter

from tetgan.files import whole_file

COLUMNS = (
    *("epoch", "seconds", "learning_rate", "kl_weight", "occupancy_loss", "displacement_loss", "kl"),
    *("local_gap", "local_penalty", "global_gap", "global_penalty"),
    *("adversarial_loss", "adversarial_ratio"),
    *("validation_iou", "validation_occupancy_loss", "validation_displacement_loss"),
)

Row = dict[str, float | int]

Losses = dict[str, float | Tensor]
"""Numbers of a step by name; tensors stay where they are, so that nobody waits for them."""


class RunLog:
    """Rows of finished epochs, and sums of the one under way; on disk too, if it `writes`."""

    def __init__(self, folder: Path, columns: tuple[str, ...] = COLUMNS, writes: bool = True) -> None:
        self.folder, self.columns = folder, columns
        self.rows: list[Row] = []
        self.sums: dict[str, list[Any]] = defaultdict(lambda: [0.0, 0])
        self._writer = SummaryWriter(str(folder / "events")) if writes else None

    def add(self, losses: Losses) -> None:
        """Count the losses of one step towards the epoch's means."""
        for name, value in losses.items():
            self.sums[name][0] += value.double() if isinstance(value, Tensor) else value
            self.sums[name][1] += 1

    def finish_epoch(self, epoch: int, further: Row) -> Row:
        """Close the epoch's row and write it; `further` are numbers that are not means over steps."""
        means = {name: float(total) / count for name, (total, count) in self.sums.items()}
        row: Row = {"epoch": epoch, **further, **means}
        self.sums.clear()
        self.rows.append(row)
        if self._writer is not None:
            self._write_csv()
            for name in row.keys() - {"epoch"}:
                self._writer.add_scalar(name, row[name], epoch)
            self._writer.flush()
        return row

    def _write_csv(self) -> None:
        with whole_file(self.folder / "log.csv") as partial, partial.open("w", newline="") as stream:
            table = csv.DictWriter(stream, self.columns, restval="")
            table.writeheader()
            table.writerows({name: _short(value) for name, value in row.items()} for row in self.rows)

    def state(self) -> dict[str, Any]:
        """What a checkpoint keeps."""
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
