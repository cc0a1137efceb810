"""How sharply a triangle surface bends at its edges."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy.stats import wasserstein_distance

from tetgan.grids.adjacency import unique_edges


@dataclass(frozen=True, eq=False)
class Bends:
    """Edges with exactly two faces.

    Attributes:
        angles: degrees between the outward normals of the two faces: 0 where flat, 90 at the edges of a
            cube; 0 also where a face has no area.
        lengths: of the edges.
        ends: their end points.
    """

    angles: Float[np.ndarray, "E"]
    lengths: Float[np.ndarray, "E"]
    ends: Float[np.ndarray, "E 2 3"]

    def percentile(self, percent: float | int) -> float:
        """Angle below which so many per cent of the edges' length bend; nan without edges."""
        if not len(self.angles):
            return np.nan
        order = np.argsort(self.angles)
        cumulative = np.cumsum(self.lengths[order])
        place = np.searchsorted(cumulative, percent / 100 * cumulative[-1])
        return float(self.angles[order][min(place, len(order) - 1)])

    def share_above(self, degrees: float | int) -> float:
        """Share of the edges' length that bends by more; nan without edges."""
        total = self.lengths.sum()
        return float(self.lengths[self.angles > degrees].sum() / total) if total > 0 else np.nan

    def histogram(self, step: int) -> dict[str, float]:
        """Share of the edges' length in each range of `step` degrees from 0 to 180, by its name."""
        starts = range(0, 180, step)
        lengths, _ = np.histogram(self.angles, [*starts, 180], weights=self.lengths)
        shares = lengths / max(self.lengths.sum(), np.finfo(float).tiny)
        return {f"bend_{low}_{low + step}": float(share) for low, share in zip(starts, shares, strict=True)}

    def distance(self, other: "Bends") -> float:
        """Wasserstein-1 distance in degrees between the distributions of angle over length."""
        return float(wasserstein_distance(self.angles, other.angles, self.lengths, other.lengths))

    def draw(self, degrees: float | int, count: int, seed: int) -> Float[np.ndarray, "P 3"]:
        """Points uniform by length on the edges that bend by more; none where there is no such edge."""
        sharp = self.angles > degrees
        ends, total = self.ends[sharp], np.cumsum(self.lengths[sharp])
        if not len(total) or not total[-1] > 0:
            return np.empty((0, 3))
        along, place = np.random.default_rng(seed).random((2, count))
        chosen = np.searchsorted(total, place * total[-1], side="right")
        return ends[chosen, 0] + along[:, None] * (ends[chosen, 1] - ends[chosen, 0])


def measure_bends(vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"]) -> Bends:
    """The bend at each edge of a surface whose faces are turned alike."""
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    edges, edge_of_side = unique_edges(faces)
    sides = edge_of_side.ravel()
    manifold = np.bincount(sides, minlength=len(edges)) == 2
    order = np.argsort(sides, kind="stable")
    pairs = order[manifold[sides[order]]].reshape(-1, 2) // 3  # sides of one edge stand together
    one, other = normals[pairs[:, 0]], normals[pairs[:, 1]]
    sine = np.linalg.norm(np.cross(one, other), axis=1)
    angles = np.degrees(np.arctan2(sine, np.einsum("ec,ec->e", one, other)))
    ends = vertices[edges[manifold]]
    return Bends(angles, np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1), ends)
