"""Whether two sets of meshes stand in one frame, and in the unit cube."""

import numpy as np
from jaxtyping import Float

# Shapes of one category differ by less than this between two fair sets; frames that differ, by far more.
_RATIO = 1.25
_SHIFT = 0.1
_SLACK = 0.01

Boxes = Float[np.ndarray, "_ 2 3"]


def bounding_box(vertices: Float[np.ndarray, "V 3"]) -> Float[np.ndarray, "2 3"]:
    """Lowest and highest corner."""
    return np.stack([vertices.min(0), vertices.max(0)])


def frame_notes(found: Boxes, real: Boxes) -> list[str]:
    """What to know before distances are read: sizes or places that differ, shapes outside the unit cube."""
    return [*_differences(found, real), *_outside(found, "samples"), *_outside(real, "reference")]


def _differences(found: Boxes, real: Boxes) -> list[str]:
    """Medians of the longest sides and of the centres."""
    own, other = (float(np.median(np.ptp(boxes, axis=1).max(1))) for boxes in (found, real))
    centers = [np.median(boxes.mean(1), axis=0) for boxes in (found, real)]
    shift = float(np.linalg.norm(centers[0] - centers[1])) / other
    notes = []
    if not 1 / _RATIO < own / other < _RATIO:
        notes.append(
            f"**The longest side of a sample is {own:.3g}, of a reference mesh {other:.3g} (medians). "
            "Distances measure this, too; --normalise fits every mesh to the unit cube**"
        )
    if shift > _SHIFT:
        notes.append(
            f"**Samples stand {shift:.2g} of a longest side away from the reference (medians of the boxes' "
            "centres). Distances measure this, too; --normalise puts every mesh in the unit cube**"
        )
    return notes


def _outside(boxes: Boxes, name: str) -> list[str]:
    count = int(((boxes < -_SLACK) | (boxes > 1 + _SLACK)).any((1, 2)).sum())
    if not count:
        return []
    return [
        f"{count} of {len(boxes)} meshes of the {name} reach out of the unit cube: JSD counts what is "
        "outside in the cells at the border, and lengths are not in sides of the cube"
    ]
