"""DefTet's surface network (Gao et al. 2020), ablation (b): displaces the vertices of a given boundary.

It learns on the boundary of true occupancies, and is applied to the boundary that TetGAN decodes.
docs/fidelity.md says what the paper leaves open here.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Bool, Float, Float32, Int
from scipy import sparse
from torch import Tensor, nn
from torch.nn import functional

from tetgan.fields.field import Field, VertexField
from tetgan.geometry.adjacency import boundary_faces, unique_edges
from tetgan.grids.grid import TetGrid
from tetgan.grids.hierarchy import GridHierarchy
from tetgan.methods.deftet.options import DeftetOptions
from tetgan.methods.tetgan.network import TetganGenerator
from tetgan.models.generator import FieldGenerator
from tetgan.nn.rows import RowMap

FEATURES = 6


class SurfaceGraph(NamedTuple):
    """The boundary of an occupancy as a graph of its N vertices.

    Attributes:
        vertices: their positions in the grid.
        features: position, -1 to 1 across the cube, and unit outward normal of the boundary on the grid.
        around: averages over the vertices at the other ends of the boundary's edges.
    """

    vertices: Int[np.ndarray, "N"]
    features: Float32[np.ndarray, "N 6"]
    around: sparse.csr_array


def surface_graph(occupancy: Bool[np.ndarray, "T"], grid: TetGrid) -> SurfaceGraph:
    """The graph of the faces between occupied and other tets; without vertices where there are none."""
    faces = boundary_faces(grid.tets[occupancy])
    vertices, compact = np.unique(faces, return_inverse=True)
    faces = compact.reshape(-1, 3)
    places = grid.vertices[vertices]
    features = np.concatenate([2 * places - 1, _normals(places, faces)], axis=1)
    return SurfaceGraph(vertices, features.astype(np.float32), _means_around(faces, len(vertices)))


def _normals(places: Float[np.ndarray, "N 3"], faces: Int[np.ndarray, "F 3"]) -> Float[np.ndarray, "N 3"]:
    """Of the faces around each vertex, weighted by area; zero where they cancel."""
    corners = places[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sums = np.zeros_like(places)
    np.add.at(sums, faces.ravel(), np.repeat(normals, 3, axis=0))
    return sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), np.finfo(float).tiny)


def _means_around(faces: Int[np.ndarray, "F 3"], count: int) -> sparse.csr_array:
    """(N, N), each row the mean over the neighbors of a vertex along edges."""
    one, other = unique_edges(faces)[0].T
    rows, columns = np.concatenate([one, other]), np.concatenate([other, one])
    weights = 1 / np.bincount(rows, minlength=count)[rows]
    return sparse.csr_array((weights, (rows, columns)), shape=(count, count))


class GraphConv(nn.Module):
    """y = x W + (mean of x over the neighbors) W' + bias."""

    def __init__(self, channels: int, out_channels: int) -> None:
        super().__init__()
        self.own = nn.Linear(channels, out_channels)
        self.others = nn.Linear(channels, out_channels, bias=False)

    def forward(self, x: Float[Tensor, "N C"], around: RowMap) -> Float[Tensor, "N D"]:
        return self.own(x) + self.others(around(x))


class ResidualBlock(nn.Module):
    """Two graph convolutions around which the features also go straight."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.first, self.second = GraphConv(width, width), GraphConv(width, width)

    def forward(self, x: Float[Tensor, "N C"], around: RowMap) -> Float[Tensor, "N C"]:
        return x + self.second(functional.relu(self.first(functional.relu(x), around)), around)


class SurfaceNetwork(nn.Module):
    """Features of the vertices of one or more graphs to their displacements, in units of the typical one."""

    def __init__(self, width: int, blocks: int) -> None:
        super().__init__()
        self.start = GraphConv(FEATURES, width)
        self.blocks = nn.ModuleList(ResidualBlock(width) for _ in range(blocks))
        self.end = nn.Linear(width, 3)

    def forward(self, graphs: Sequence[SurfaceGraph]) -> Float[Tensor, "N 3"]:
        """Graphs one after the other; none of them sees the others."""
        device = self.end.weight.device
        around = RowMap(sparse.block_diag([graph.around for graph in graphs], format="csr")).to(device)
        x = torch.from_numpy(np.concatenate([graph.features for graph in graphs])).to(device)
        x = self.start(x, around)
        for block in self.blocks:
            x = block(x, around)
        return self.end(functional.relu(x))


class DeftetGenerator(FieldGenerator):
    """Another model's occupancy, and a surface network that moves its boundary.

    Codes, their prior and occupancy are the other model's; its displacements are not used.
    """

    def __init__(self, options: DeftetOptions, hierarchy: GridHierarchy, of: TetganGenerator) -> None:
        super().__init__()
        self.of = of
        self.network = SurfaceNetwork(options.width, options.blocks)
        self.unit = nn.Buffer(torch.ones(()))  # length of a typical displacement, in cube sides
        self.grid = hierarchy.finest

    @property
    def latent_shape(self) -> tuple[int, ...]:
        return self.of.latent_shape

    def draw_noise(self, generator: torch.Generator) -> Float[Tensor, "..."]:
        return self.of.draw_noise(generator)

    def from_noise(self, noise: Float[Tensor, "B ..."]) -> Float[Tensor, "B ..."]:
        return self.of.from_noise(noise)

    def encode(self, field: Float[Tensor, "B T 4"]) -> Float[Tensor, "B ..."]:
        return self.of.encode(field)

    def decode(self, latent: Float[Tensor, "B ..."]) -> Float[Tensor, "B T 4"]:
        """The other model's field; `meshed` puts the network's displacements in place of its own."""
        return self.of.decode(latent)

    @torch.no_grad()
    def meshed(self, field: Field) -> VertexField:
        graph = surface_graph(field.occupancy, self.grid)
        displacement = np.zeros((len(self.grid.vertices), 3), dtype=np.float32)
        if len(graph.vertices):
            displacement[graph.vertices] = (self.unit * self.network([graph])).cpu().numpy()
        return VertexField(field.occupancy, displacement)
