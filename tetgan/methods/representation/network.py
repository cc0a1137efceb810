"""Ground-truth fields in place of a model: the best that any model on the grid can do."""

from jaxtyping import Float
from torch import Tensor

from tetgan.grids.hierarchy import GridHierarchy
from tetgan.methods.representation.options import RepresentationOptions
from tetgan.models.generator import FieldGenerator


class RepresentationGenerator(FieldGenerator):
    """The field is its own latent. There is no prior to draw from: training fields replace samples."""

    is_identity = True

    def __init__(self, options: RepresentationOptions, hierarchy: GridHierarchy) -> None:
        super().__init__()
        self.tets = len(hierarchy.finest.tets)

    def fit(self, tets: object) -> None:
        """There is nothing to fit."""

    @property
    def latent_shape(self) -> tuple[int, ...]:
        return (self.tets, 4)

    def encode(self, field: Float[Tensor, "B T 4"]) -> Float[Tensor, "B T 4"]:
        return field

    def decode(self, latent: Float[Tensor, "B T 4"]) -> Float[Tensor, "B T 4"]:
        decoded = latent.clone()
        decoded[..., 0] -= 0.5
        return decoded
