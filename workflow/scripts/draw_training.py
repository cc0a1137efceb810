"""Losses and validation IoU of every model that logs them, against the minutes of its training."""

from pathlib import Path

import pandas as pd

from tetgan.rendering.plots import draw_curves, save_plot


def draw(folders: list[Path], names: list[str], seeds: list[int], out: Path) -> None:
    """Models that are not trained step by step have no log, and no line."""
    logs = [
        pd.read_csv(folder / "log.csv").assign(model=name, seed=seed)
        for folder, name, seed in zip(folders, names, seeds, strict=True)
        if (folder / "log.csv").is_file()
    ]
    table = pd.concat(logs) if logs else pd.DataFrame(columns=["model", "seed", "seconds"])
    save_plot(out, draw_curves(table), table)


draw(
    [Path(weights).parent for weights in snakemake.input.weights],
    list(snakemake.params.names),
    list(snakemake.params.seeds),
    Path(snakemake.output.picture),
)
