"""One sample at rest and under load."""

from pathlib import Path

import pandas as pd

from tetgan.mechanics.figure import draw_simulation, exaggeration
from tetgan.mechanics.options import SimulationOptions
from tetgan.mechanics.simulation import write_simulation
from tetgan.mechanics.study import first_standing
from tetgan.rendering.plots import save_plot


def draw(samples: Path, model: str, options: SimulationOptions, out: Path) -> None:
    found = first_standing(samples, options.case)
    row = {"model": model, "id": found.sample, "whole": found.whole, "standing": found.standing}
    data = pd.DataFrame([{**row, **found.result.record(), "exaggeration": exaggeration(found.result)}])
    save_plot(out, draw_simulation(found.result, f"sample {found.sample} of {model}"), data)
    write_simulation(out.with_suffix(".vtu"), found.result)


draw(
    Path(snakemake.input.samples[0]),
    snakemake.params.names[0],
    SimulationOptions.model_validate_json(snakemake.params.options),
    Path(snakemake.output.picture),
)
