"""The picture of a body under load."""

import numpy as np
import pytest
from PIL import Image

from tetgan.mechanics.figure import exaggeration, write_figure
from tetgan.mechanics.options import LoadCase
from tetgan.mechanics.simulation import simulate


def test_the_exaggeration_is_round_and_shows_a_moderate_displacement(crooked):
    soft, hard = (simulate(crooked, LoadCase(order=1, material=name)) for name in ("rubber", "steel"))
    for found in (soft, hard):
        times = exaggeration(found)
        shown = times * np.linalg.norm(found.displacement, axis=1).max()
        assert 0.12 / 2.5 - 1e-9 <= shown <= 0.12
        assert f"{times:.0e}"[0] in "125"
    assert exaggeration(hard) > exaggeration(soft)


@pytest.mark.slow
def test_the_picture_shows_the_body_twice_and_is_the_same_each_time(crooked, tmp_path):
    found = simulate(crooked, LoadCase(order=1))
    for name in "ab":
        write_figure(tmp_path / f"{name}.png", found, "a cube")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    picture = np.asarray(Image.open(tmp_path / "a.png").convert("RGB")).astype(int)
    drawn = (picture < 235).any(axis=2)
    left, right = drawn[:, : drawn.shape[1] // 2], drawn[:, drawn.shape[1] // 2 :]
    assert left.mean() > 0.1 and right.mean() > 0.1
    # Wood has one hue; the colours of stress have many.
    spread = np.ptp(picture - picture.mean(axis=2, keepdims=True), axis=2)
    assert spread[:, drawn.shape[1] // 2 :].max() > spread[:, : drawn.shape[1] // 2].max()
