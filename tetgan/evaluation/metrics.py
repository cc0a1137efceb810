"""List of every metric: name, title, better side, group and meaning.

Tables, reports, figures and docs/metrics.md take all of these from here.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

GROUPS = {
    "reconstruction": "Reconstructions",
    "meshes": "Meshes",
    "edges": "Edges by their faces",
    "solids": "Solids",
    "features": "Generated shapes beside hold-out shapes: features",
    "sets": "Generated shapes beside hold-out shapes: distances",
    "samples": "Generated shapes",
}
"""Heading of every group, in the order in which tables show them."""

_ARROWS = {"lower": " ↓", "higher": " ↑", "half": " → ½", None: ""}


@dataclass(frozen=True)
class Metric:
    """One figure of a set of shapes.

    Attributes:
        name: key in the JSON of metrics, and column of tables.
        title: what people read.
        group: key of `GROUPS`.
        meaning: definition in one line.
        better: which values are better; None where neither high nor low is.
        share: whether it lies between 0 and 1, and so do the ends of its interval.
        in_paper: whether the paper's Table 1 has it.
    """

    name: str
    title: str
    group: str
    meaning: str
    better: Literal["lower", "higher", "half"] | None = None
    share: bool = False
    in_paper: bool = False

    @property
    def heading(self) -> str:
        """Title, and an arrow to the better side."""
        return self.title + _ARROWS[self.better]


METRICS = (
    Metric(
        "chamfer",
        "Chamfer",
        better="lower",
        group="reconstruction",
        meaning="mean squared distance to the nearest point of the original, each way, summed; of those "
        "that have a surface",
        in_paper=True,
    ),
    Metric(
        "chamfer_l1",
        "Chamfer L1",
        better="lower",
        group="reconstruction",
        meaning="mean distance to the nearest point, averaged over both ways",
    ),
    Metric(
        "fscore",
        "F-score",
        better="higher",
        group="reconstruction",
        meaning="harmonic mean of the shares of points within 0.01 (`fscore_threshold`) of the other "
        "surface; 0 without a surface",
        share=True,
    ),
    Metric(
        "normal_consistency",
        "Normals",
        better="higher",
        group="reconstruction",
        meaning="mean absolute cosine between the normals of nearest points, averaged over both ways",
        share=True,
    ),
    Metric(
        "iou",
        "Field IoU",
        better="higher",
        group="reconstruction",
        meaning="tets occupied in both over tets occupied in either, before the filter of Eq. 5; for "
        "baselines, points or voxels",
        share=True,
    ),
    Metric(
        "volume_iou",
        "Volume IoU",
        better="higher",
        group="reconstruction",
        meaning="volume inside both surfaces over volume inside either; 0 without a surface",
        share=True,
    ),
    Metric(
        "empty_reconstructions",
        "Empty reconstructions",
        better="lower",
        group="reconstruction",
        meaning="share of reconstructions without a surface",
        share=True,
    ),
    Metric(
        "faces",
        "Faces",
        group="meshes",
        meaning="mean triangles of a mesh: a reconstruction, or a generated shape where there are none",
        in_paper=True,
    ),
    Metric(
        "manifold_edges",
        "Manifold edges",
        better="higher",
        group="meshes",
        meaning="share of a mesh's edges with exactly two faces",
        share=True,
    ),
    Metric(
        "inverted_tets",
        "Inverted tets",
        better="lower",
        group="meshes",
        meaning="share of a mesh's tets with no or negative volume",
        share=True,
    ),
    Metric(
        "valid",
        "Valid solids",
        better="higher",
        group="meshes",
        meaning="share of the meshes that are valid solids (docs/certificate.md)",
        share=True,
    ),
    Metric(
        "boundary_edges",
        "One face",
        better="lower",
        group="edges",
        meaning="share of a mesh's edges with one face",
        share=True,
    ),
    Metric(
        "nonmanifold_edges",
        "Three or more",
        better="lower",
        group="edges",
        meaning="share of a mesh's edges with three faces or more",
        share=True,
    ),
    Metric(
        "manifold_shapes",
        "Manifold shapes",
        better="higher",
        group="edges",
        meaning="share of shapes in which all edges have two faces and each vertex one fan of them",
        share=True,
    ),
    Metric(
        "volume",
        "Volume",
        group="solids",
        meaning="signed volume of the tets, in cube volumes",
    ),
    Metric(
        "thickness",
        "Thickness",
        group="solids",
        meaning="median way straight through the solid, in cube sides",
    ),
    Metric(
        "components",
        "Components",
        better="lower",
        group="solids",
        meaning="parts joined by faces of tets",
    ),
    Metric(
        "floating",
        "Floating tets",
        better="lower",
        group="solids",
        meaning="share of tets outside the largest part",
        share=True,
    ),
    Metric(
        "fid",
        "FID",
        better="lower",
        group="features",
        meaning="Fréchet distance of Gaussians fitted to features",
        in_paper=True,
    ),
    Metric(
        "kid",
        "KID",
        better="lower",
        group="features",
        meaning="squared maximum mean discrepancy of the features, kernel (x·y/256 + 1)³, unbiased; can be "
        "negative",
    ),
    Metric(
        "fid_infinity",
        "FID∞",
        better="lower",
        group="features",
        meaning="FID extrapolated to infinitely many surfaces; can be negative",
    ),
    Metric(
        "precision",
        "Precision",
        better="higher",
        group="features",
        meaning="share of generated surfaces whose features lie among the real ones",
        share=True,
    ),
    Metric(
        "recall",
        "Recall",
        better="higher",
        group="features",
        meaning="share of real surfaces whose features lie among the generated ones",
        share=True,
    ),
    Metric(
        "mmd",
        "MMD",
        better="lower",
        group="sets",
        meaning="Chamfer distance to the nearest generated surface, mean over real ones",
    ),
    Metric(
        "cov",
        "COV",
        better="higher",
        group="sets",
        meaning="share of real surfaces that are the nearest real one of some generated surface",
        share=True,
    ),
    Metric(
        "nna",
        "1-NNA",
        better="half",
        group="sets",
        meaning="leave-one-out accuracy of telling generated from real by the nearest neighbour; below ½ "
        "generated shapes are copies",
        share=True,
    ),
    Metric(
        "jsd",
        "JSD",
        better="lower",
        group="sets",
        meaning="Jensen-Shannon divergence, in bits, of where the points of a set are",
        share=True,
    ),
    Metric(
        "variety",
        "Variety",
        better="higher",
        group="samples",
        meaning="mean Chamfer distance of the closest of random pairs",
        in_paper=True,
    ),
    Metric(
        "novelty",
        "Novelty",
        group="samples",
        meaning="Chamfer distance to the nearest training shape, mean over generated ones",
    ),
    Metric(
        "empty_samples",
        "Empty samples",
        better="lower",
        group="samples",
        meaning="share of generated shapes without a surface, which all other metrics leave out",
        share=True,
    ),
)
"""In the order in which tables and reports show them."""

BY_NAME = {metric.name: metric for metric in METRICS}


def names_of(*groups: str) -> tuple[str, ...]:
    """Names of the metrics of some groups, in the order of the list."""
    return tuple(metric.name for metric in METRICS if metric.group in groups)


def titles_of(names: Iterable[str]) -> str:
    """Titles of some metrics, separated by commas."""
    return ", ".join(BY_NAME[name].title for name in names)


def headings_of(names: Iterable[str]) -> dict[str, str]:
    """Heading of each of some metrics, by name."""
    return {name: BY_NAME[name].heading for name in names}
