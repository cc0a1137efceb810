"""Plots of training logs."""

import numpy as np
import pandas as pd
from PIL import Image

from tetgan.rendering.plots import COLORS, draw_curves, line_styles, save_plot


def log_of(model: str, seed: int, **columns) -> pd.DataFrame:
    rows = {"model": model, "seed": seed, "epoch": [1, 2, 3], "seconds": [60.0, 120.0, 180.0], **columns}
    return pd.DataFrame(rows)


LOGS = pd.concat(
    [
        log_of("one", 0, occupancy_loss=[1.0, 0.5, 0.2], validation_iou=[np.nan, 0.4, 0.6]),
        log_of("one", 1, occupancy_loss=[0.9, 0.5, 0.3], validation_iou=[np.nan, 0.3, 0.5]),
        log_of("two", 0, occupancy_loss=[0.8, 0.7, 0.6], local_gap=[np.nan] * 3, sdf_loss=[3.0, 2.0, 1.0]),
    ]
)


def test_a_panel_a_measure_and_a_line_a_run_against_minutes():
    panels = {axes.get_title(loc="left"): axes for axes in draw_curves(LOGS).axes}
    assert list(panels) == ["Validation IoU", "Occupancy loss, training", "Sdf loss"]
    lines = panels["Occupancy loss, training"].get_lines()
    assert [line.get_ydata()[0] for line in lines] == [1.0, 0.9, 0.8]
    assert list(lines[0].get_xdata()) == [1.0, 2.0, 3.0]
    assert lines[0].get_color() == lines[1].get_color() != lines[2].get_color()
    assert [list(line.get_ydata()) for line in panels["Validation IoU"].get_lines()] == [
        [0.4, 0.6],
        [0.3, 0.5],
    ]
    assert (
        panels["Occupancy loss, training"].get_yscale() == "log"
        and panels["Validation IoU"].get_yscale() == "linear"
    )


def test_the_plot_and_its_numbers_are_written_and_equal_each_time(tmp_path):
    for name in ("a", "b"):
        save_plot(tmp_path / f"{name}.png", draw_curves(LOGS), LOGS)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    assert len(pd.read_csv(tmp_path / "a.csv")) == len(LOGS)
    image = np.asarray(Image.open(tmp_path / "a.png").convert("L"))
    assert image.shape[1] == 1440
    assert 0.01 < (image < 200).mean() < 0.3


def test_no_logs_make_an_empty_plot():
    figure = draw_curves(pd.DataFrame(columns=["model", "seed", "seconds"]))
    assert figure.axes == []


def test_more_names_than_colours_stay_different():
    names = [f"m{i}" for i in range(2 * len(COLORS))]
    looks = line_styles(names)
    assert len({tuple(look.values()) for look in looks.values()}) == len(names)
