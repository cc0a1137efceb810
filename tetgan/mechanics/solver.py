"""Displacements from stiffness and forces: factorised when small, by multigrid when large."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float
from scipy import sparse
from scipy.sparse.linalg import cg, splu

from tetgan.mechanics.errors import UnfitError

DIRECT_BELOW = 30_000
"""Unknowns from which multigrid takes over: thin shapes factorise well, and need many iterations."""

TOLERANCE = 1e-8
"""Residual over load at which the iteration ends."""

_MOST_ITERATIONS = 1000

_COARSEST = 300  # unknowns at which multigrid stops coarsening


class Solution(NamedTuple):
    """Displacements in the order of the unknowns, and how they were found.

    Attributes:
        displacement: in metres.
        method: `direct` or `multigrid`.
        iterations: 0 for a factorisation.
        residual: norm of what is left of the forces, over that of the load.
    """

    displacement: Float[np.ndarray, "M"]
    method: str
    iterations: int
    residual: float


def solve(
    stiffness: sparse.bsr_array,
    load: Float[np.ndarray, "M"],
    held: Bool[np.ndarray, "M"],
    motions: Float[np.ndarray, "M 6"],
    *,
    direct_below: int = DIRECT_BELOW,
) -> Solution:
    """Solve K u = f where u is not held; held unknowns are zero.

    Args:
        stiffness: of the free body, symmetric, in blocks of 3.
        motions: rigid motions; multigrid keeps them on its coarse levels (Vanek, Mandel & Brezina 1996).
        direct_below: unknowns from which multigrid takes over.

    Raises:
        UnfitError: the iteration does not converge.
    """
    matrix = _hold(stiffness, held)
    right = np.where(held, 0.0, load)
    if not right.any():
        return Solution(np.zeros_like(right), "direct", 0, 0.0)
    if len(right) < direct_below:
        method, iterations, found = "direct", 0, _factorised(matrix, right)
    else:
        method = "multigrid"
        found, iterations = _by_multigrid(matrix, right, np.where(held[:, None], 0.0, motions))
    left = float(np.linalg.norm(right - matrix @ found) / np.linalg.norm(right))
    if not left < 100 * TOLERANCE:
        raise UnfitError(
            "not solved",
            f"the equations are not solved (residual {left:.1e} after {iterations} iterations):"
            " nearly flat tets, or a part that hangs by a thread; look at the mesh with 'tetgan certify'",
        )
    return Solution(found, method, iterations, left)


def _hold(stiffness: sparse.bsr_array, held: Bool[np.ndarray, "M"]) -> sparse.bsr_array:
    """The matrix with rows and columns of held unknowns replaced by those of the identity, scaled to fit."""
    free = (~held).reshape(-1, 3).astype(float)
    rows = np.repeat(np.arange(len(free)), np.diff(stiffness.indptr))
    blocks = stiffness.data * free[rows][:, :, None] * free[stiffness.indices][:, None, :]
    diagonal = rows == stiffness.indices
    scale = np.abs(stiffness.diagonal()).mean()
    blocks[diagonal] += scale * np.eye(3) * (1 - free[rows[diagonal]])[:, :, None]
    return sparse.bsr_array((blocks, stiffness.indices, stiffness.indptr), shape=stiffness.shape)


def _factorised(matrix: sparse.bsr_array, right: Float[np.ndarray, "M"]) -> Float[np.ndarray, "M"]:
    factors = splu(
        matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
    )
    return factors.solve(right)


def _by_multigrid(
    matrix: sparse.bsr_array, right: Float[np.ndarray, "M"], motions: Float[np.ndarray, "M 6"]
) -> tuple[Float[np.ndarray, "M"], int]:
    """Conjugate gradients, preconditioned by smoothed aggregation, and the iterations they took."""
    from pyamg import smoothed_aggregation_solver  # noqa: PLC0415

    with _same_random_numbers():
        levels = smoothed_aggregation_solver(
            sparse.bsr_matrix(matrix),
            B=motions,
            strength=("symmetric", {"theta": 0.0}),
            improve_candidates=None,
            max_coarse=_COARSEST,
        )
    steps: list[None] = []
    found, _ = cg(
        matrix,
        right,
        rtol=TOLERANCE,
        maxiter=_MOST_ITERATIONS,
        M=levels.aspreconditioner(),
        callback=lambda _: steps.append(None),
    )
    return found, len(steps)


@contextmanager
def _same_random_numbers() -> Iterator[None]:
    """pyamg draws from numpy's global generator: the same numbers each time, and it is left as it was."""
    state = np.random.get_state()  # noqa: NPY002
    np.random.seed(0)  # noqa: NPY002
    try:
        yield
    finally:
        np.random.set_state(state)  # noqa: NPY002
