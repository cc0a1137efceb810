"""TetFlow as a model of fields: codes of the flow, decoded with splits of their own."""

from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from scipy.spatial import KDTree
from torch import Tensor, nn

from tetgan.grids.active import CHILDREN, children_of, tables_among
from tetgan.grids.hierarchy import GridHierarchy
from tetgan.methods.tetflow.autoencoder import CLIP, Autoencoder
from tetgan.methods.tetflow.flow import CodeFlow
from tetgan.methods.tetflow.options import TetflowOptions
from tetgan.methods.tetflow.shapes import ActiveSets, ActiveShape, collate, neighbor_tensors
from tetgan.models.generator import FieldGenerator

SIGN = 6.0  # logit of the side at the reach, over the distance in units of it

FEET = 2.0  # tets further from the surface than this, in units of the reach, tell no point of it


@dataclass(frozen=True, eq=False)
class Descent:
    """What a decoder found, of B shapes.

    Attributes:
        inside: (B, T) of every finest tet; where none is active, what its nearest ancestor said.
        cells: (N,) finest active tets, numbered on from shape to shape.
        distance, normal: theirs; the distance in units of the reach.
        leaves: numbers of the tets above them that were not split, by level, likewise numbered on.
    """

    inside: Bool[np.ndarray, "B T"]
    cells: Int[np.ndarray, "N"]
    distance: Float[np.ndarray, "N"]
    normal: Float[np.ndarray, "N 3"]
    leaves: list[Int[np.ndarray, "_L"]]


class TetflowGenerator(FieldGenerator):
    """The autoencoder, and the flow that draws codes for it. A latent has a code for each coarsest tet."""

    def __init__(self, options: TetflowOptions, hierarchy: GridHierarchy) -> None:
        super().__init__()
        self.hierarchy, self.sets = hierarchy, ActiveSets(hierarchy, options.reach)
        self.tets, self.code, self.steps = len(hierarchy.coarsest.tets), options.code, options.flow_steps
        self.autoencoder = Autoencoder(
            self.tets,
            hierarchy.depth,
            code=options.code,
            width=options.width,
            base_width=options.base_width,
            blocks=options.blocks,
        )
        self.flow = CodeFlow(
            self.tets, options.code, options.flow_width, options.flow_layers, options.flow_heads
        )
        self.unit = nn.Buffer(torch.ones(()))  # longest displacement, in cube sides
        self.mean = nn.Buffer(torch.zeros(self.latent_shape))  # of the training codes
        self.deviation = nn.Buffer(torch.ones(self.latent_shape))

    @property
    def latent_shape(self) -> tuple[int, int]:
        return self.tets, self.code

    def from_noise(self, noise: Float[Tensor, "B K Z"]) -> Float[Tensor, "B K Z"]:
        return self.mean + self.deviation * self.flow.carry(noise, self.steps)

    def encode(self, field: Float[Tensor, "B T 4"]) -> Float[Tensor, "B K Z"]:
        unit = self.unit.item()
        shapes = [
            self.sets.shape(shape[:, 0] > 0.5, unit * shape[:, 1:]) for shape in field.cpu().float().numpy()
        ]
        return self.encode_shapes(shapes)

    def encode_shapes(self, shapes: list[ActiveShape]) -> Float[Tensor, "B K Z"]:
        """The mean code of each active shape."""
        mean: Tensor = self.autoencoder.encoder(collate(shapes, self.mean.device))[0]
        return mean

    def decode(self, latent: Float[Tensor, "B K Z"]) -> Float[Tensor, "B T 4"]:
        found = self.descend(latent)
        displacement = self._displacement(found, len(latent)) / np.float32(self.unit.item())
        logit = np.where(found.inside, np.float32(CLIP), np.float32(-CLIP))
        logit.ravel()[found.cells] = -found.distance
        field = np.concatenate([SIGN * logit[..., None], displacement.clip(-1, 1)], axis=2)
        return torch.from_numpy(field).to(latent)

    @torch.no_grad()
    def descend(self, latent: Float[Tensor, "B K Z"]) -> Descent:
        """Decode with the splits that the decoder itself asks for."""
        decoder, count = self.autoencoder.decoder, len(latent)
        x, cells, leaves = decoder.start(latent), np.arange(count * self.tets), []
        inside = np.zeros((count, self.tets), dtype=bool)
        for number, around in enumerate(self.sets.around):
            neighbors = neighbor_tensors(*tables_among(around, cells), latent.device)
            x, output = decoder.level(number, x, neighbors)
            found = output.float().cpu().numpy()
            if number == self.hierarchy.depth:
                break
            inside.ravel()[cells] = found[:, 0] > 0
            split = found[:, 1] > 0
            leaves.append(cells[~split])
            x = decoder.rise(number, x[torch.from_numpy(split).to(x.device)])
            cells, inside = children_of(cells[split]), inside.repeat(CHILDREN, axis=1)
        inside.ravel()[cells] = found[:, 0] < 0
        length = np.linalg.norm(found[:, 1:], axis=1, keepdims=True)
        return Descent(inside, cells, found[:, 0], found[:, 1:] / np.maximum(length, 1e-6), leaves)

    def _displacement(self, found: Descent, count: int) -> Float[np.ndarray, "B T 3"]:
        """In cube sides: of active tets from distance and normal; of others to the foot of an active one.

        All finest tets of a leaf take the foot that is nearest to the leaf's centroid, and none comes nearer
        to the surface than the reach.
        """
        reach, tets = self.sets.reach, len(self.hierarchy.finest.tets)
        displacement = np.empty((count, tets, 3), dtype=np.float32)
        shape, cell = np.divmod(found.cells, tets)
        centroids = self.hierarchy.finest.centroids
        own = -reach * found.distance[:, None] * found.normal
        displacement[shape, cell] = own
        feet = centroids[cell] + own
        near = np.abs(found.distance) < FEET
        for number in range(count):
            known = feet[near & (shape == number)]
            tree = KDTree(known) if len(known) else None
            for level, leaves in enumerate(found.leaves):
                owner, leaf = np.divmod(leaves, len(self.hierarchy.levels[level].tets))
                leaf = leaf[owner == number]
                inside = CHILDREN ** (self.hierarchy.depth - level)
                places = leaf[:, None] * inside + np.arange(inside)
                if tree is None:
                    displacement[number, places] = self.unit.item() * np.eye(3)[2]
                    continue
                nearest = known[tree.query(self.hierarchy.levels[level].centroids[leaf])[1]]
                displacement[number, places] = _at_least(reach, nearest[:, None] - centroids[places])
        return displacement


def _at_least(length: float, vectors: Float[np.ndarray, "*N 3"]) -> Float[np.ndarray, "*N 3"]:
    """Vectors, those shorter than a length made that long."""
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors * np.maximum(1, length / np.maximum(lengths, 1e-9))
