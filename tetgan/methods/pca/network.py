"""Principal components of the fields: the best linear code."""

import logging
from collections.abc import Callable

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor, nn

from tetgan.grids.hierarchy import GridHierarchy
from tetgan.methods.pca.options import PcaOptions
from tetgan.models.generator import FieldGenerator

log = logging.getLogger(__name__)

CHUNK = 1024  # tets at a time, so that memory holds a slice of the data only

NOISE = 1e-7  # a component with less than this share of the first one's variance is rounding


class PcaGenerator(FieldGenerator):
    """Mean field plus components, with coefficients scaled to variance 1 over the training shapes."""

    def __init__(self, options: PcaOptions, hierarchy: GridHierarchy) -> None:
        super().__init__()
        tets = len(hierarchy.finest.tets)
        self.mean = nn.Buffer(torch.zeros(tets, 4))
        self.components = nn.Buffer(torch.zeros(options.components, tets, 4))
        self.deviations = nn.Buffer(torch.zeros(options.components))

    @property
    def latent_shape(self) -> tuple[int, ...]:
        return (len(self.components),)

    def encode(self, field: Float[Tensor, "B T 4"]) -> Float[Tensor, "B K"]:
        coefficients = (field - self.mean).flatten(1) @ self.components.flatten(1).T
        return coefficients / self.deviations.clamp(min=torch.finfo(torch.float32).tiny)

    def decode(self, latent: Float[Tensor, "B K"]) -> Float[Tensor, "B T 4"]:
        field = self.mean + torch.tensordot(latent * self.deviations, self.components, dims=1)
        return torch.cat([field[..., :1] - 0.5, field[..., 1:].clamp(-1, 1)], dim=-1)

    def fit(self, tets: Callable[[slice], Float[np.ndarray, "N t 4"]]) -> None:
        """Set mean, components and deviations from the training fields, which `tets` gives by slices of tets.

        The eigenvectors of the (N, N) matrix of inner products give the components with no (4T, 4T) one.
        """
        slices = [slice(start, start + CHUNK) for start in range(0, len(self.mean), CHUNK)]
        gram = sum(rows @ rows.T for rows, _ in (_centred(tets(part)) for part in slices))
        variances, shapes = np.linalg.eigh(gram)
        kept = np.argsort(variances)[::-1][: len(self.components)]
        kept = kept[variances[kept] > NOISE * variances[-1]]
        if len(kept) < len(self.components):
            log.warning("%d shapes give %d of %d components", len(gram), len(kept), len(self.components))
        lengths, shapes = np.sqrt(variances[kept]), shapes[:, kept]
        shapes *= np.where(shapes[np.abs(shapes).argmax(axis=0), range(len(kept))] < 0, -1, 1)
        for part in slices:
            rows, mean = _centred(tets(part))
            self.mean[part] = torch.from_numpy(mean)
            components = (rows.T @ shapes / lengths).T
            self.components[: len(kept), part] = torch.from_numpy(components.reshape(len(kept), len(mean), 4))
        self.deviations[: len(kept)] = torch.from_numpy(lengths / np.sqrt(max(len(gram) - 1, 1)))


def _centred(fields: Float[np.ndarray, "N t 4"]) -> tuple[np.ndarray, Float[np.ndarray, "t 4"]]:
    """Each shape's deviation from the mean as a row of (N, 4t), and the mean; in double precision."""
    fields = fields.astype(np.float64)
    mean = fields.mean(axis=0)
    return (fields - mean).reshape(len(fields), -1), mean
