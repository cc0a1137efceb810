"""Two folders in different frames are noticed."""

import numpy as np
import pytest

from tetgan.evaluation.meshfolder import bounding_box, frame_notes


def boxes(size: float, at: float) -> np.ndarray:
    """Ten boxes of about one size around (at, at, at)."""
    sizes = size * np.linspace(0.9, 1.1, 10)
    return np.array([[[at - s / 2] * 3, [at + s / 2] * 3] for s in sizes])


def test_one_frame_needs_no_words():
    assert frame_notes(boxes(0.8, 0.5), boxes(0.75, 0.51)) == []


@pytest.mark.parametrize(
    ("found", "words"),
    [
        (boxes(0.4, 0.5), "longest side of a sample is 0.4, of a reference mesh 0.8"),
        (boxes(0.8, 0.1), "away from the reference"),
        (boxes(80, 50), "10 of 10 meshes of the samples reach out of the unit cube"),
    ],
)
def test_other_frames_are_named(found, words):
    assert words in " ".join(frame_notes(found, boxes(0.8, 0.5)))


def test_a_bounding_box_is_the_lowest_and_highest_corner():
    got = bounding_box(np.array([[0.0, 5.0, 1.0], [2.0, 3.0, 1.0]]))
    np.testing.assert_array_equal(got, [[0, 3, 1], [2, 5, 1]])
