"""Order of convergence, and the resolution at which an error is reached."""

from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from jaxtyping import Float

from tetgan.studies.resolution.representations import DEFORMED, NUMBERS, PAPER


class Needed(NamedTuple):
    """A resolution or a size; sign '>' or '<': at least or at most that, beyond what was measured."""

    value: float
    sign: str = ""

    def __str__(self) -> str:
        shown = f"{self.value:.1f}" if self.value < 1000 else f"{self.value:.0f}"
        return f"{self.sign} {shown}".strip()


def resolution_to_reach(
    resolutions: Float[np.ndarray, "N"], errors: Float[np.ndarray, "N"], target: float
) -> Needed:
    """Resolution from which the error stays below the target, on straight lines between the logarithms.

    Args:
        resolutions: rising.
    """
    above = np.flatnonzero(errors > target)
    if len(above) == 0:
        return Needed(float(resolutions[0]), "<")
    last = above[-1]
    if last == len(errors) - 1:
        return Needed(float(resolutions[-1]), ">")
    pair = [last + 1, last]  # np.interp wants its first axis, here the error, to rise
    return Needed(float(np.exp(np.interp(np.log(target), np.log(errors[pair]), np.log(resolutions[pair])))))


def convergence_order(resolutions: Float[np.ndarray, "N"], errors: Float[np.ndarray, "N"]) -> float:
    """Power of 1/resolution with which the error falls: least squares on logarithms; nan for one point."""
    if len(resolutions) < 2:
        return np.nan
    return -float(np.polyfit(np.log(resolutions), np.log(errors), 1)[0])


def summarise(curves: pd.DataFrame, reference_cells: int) -> pd.DataFrame:
    """One row per representation: what it needs to reach the error of the deformed reference lattice.

    Args:
        curves: of `measure_curves`.

    Returns:
        Columns `representation`; `needed`, a resolution as text, '> X' where X is the finest measured and
        does not reach it; `needed_paper`; `numbers` stored at that resolution, as text likewise; `order` of
        convergence; `target`, the error to reach; `finest` resolution measured and the `finest_error` there.
    """
    deformed = curves[curves["representation"] == DEFORMED].set_index("cells")
    reference: dict[Any, Any] = deformed.loc[reference_cells].to_dict()
    rows = []
    for name, curve in curves.groupby("representation", sort=False):
        resolutions, errors = curve["resolution"].to_numpy(), curve["error"].to_numpy()
        needed = (
            Needed(float(reference["resolution"]))
            if name == DEFORMED
            else resolution_to_reach(resolutions, errors, float(reference["error"]))
        )
        rows.append(
            {
                "representation": name,
                "needed": str(needed),
                "needed_paper": PAPER.get(str(name)),
                "numbers": str(needed._replace(value=NUMBERS[str(name)] * needed.value**3)),
                "order": convergence_order(resolutions, errors),
                "target": reference["error"],
                "finest": resolutions[-1],
                "finest_error": errors[-1],
            }
        )
    return pd.DataFrame(rows).astype({"needed_paper": "Int64"})
