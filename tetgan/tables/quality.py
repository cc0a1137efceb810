"""Stage: how many meshes are valid solids, and what that takes, both modes side by side."""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from jaxtyping import Float, Int

from tetgan.errors import UserError
from tetgan.evaluation.intervals import bootstrap
from tetgan.evaluation.metrics import headings_of
from tetgan.evaluation.options import BootstrapOptions
from tetgan.evaluation.seeds import named_rng
from tetgan.shapes.catalogue import read_catalogue
from tetgan.solids.folder import CERTIFICATES, KINDS, SampleFolder
from tetgan.tables.markdown import markdown_table, page, plain, round_value, row_name, write_twins
from tetgan.tables.paper import OWN_METHODS, quoted_figure, read_paper

IDENTITY = ("category", "model", "tets", "mode", "smoothing", "shapes", "seeds", "n", "empty")

SUMS = ("inverted_tets", "nonmanifold_edges", "nonmanifold_vertices", "self_intersections", "cavities")


# Figure to the column of certificates that it sums up over meshes, and how.
_STATISTICS: dict[str, tuple[str, Callable[..., Any]]] = {
    "valid": ("valid", np.mean),
    "p1_dihedral": ("p1_dihedral", np.mean),
    "manifold_edges": ("manifold_edges", np.mean),
    "components": ("components", np.mean),
}

FIGURES = (
    *("valid", "valid_low", "valid_high"),
    "inverted_tets",
    "inverted_share",
    "min_dihedral",
    *("p1_dihedral", "p1_dihedral_low", "p1_dihedral_high"),
    "min_radius_ratio",
    "radius_ratios",
    *("manifold_edges", "manifold_edges_low", "manifold_edges_high", "manifold_edges_paper"),
    "nonmanifold_edges",
    "nonmanifold_vertices",
    "self_intersections",
    *("components", "components_low", "components_high"),
    "cavities",
    "dropped_components",
    "held_share",
    *("volume_ratio", "volume_ratio_low", "volume_ratio_high"),
    *("volume_to_paper", "volume_to_paper_low", "volume_to_paper_high"),
)

_COUNTS = ("tets", "seeds", "n", "empty", *SUMS, "dropped_components")

_NEEDED = {
    "id",
    "set",
    "valid",
    "p1_dihedral",
    "radius_ratios",
    "snapped",
    "held",
    "dropped_components",
    *SUMS,
}

_HEADINGS = {
    **headings_of(("valid", "inverted_tets")),
    "min_dihedral": "Least angle ↑",
    "p1_dihedral": "1 % of angles ↑",
    "min_radius_ratio": "Least radius ratio ↑",
    **headings_of(("manifold_edges",)),
    "nonmanifold_edges": "Non-manifold edges ↓",
    "nonmanifold_vertices": "Non-manifold vertices ↓",
    "self_intersections": "Self-intersections ↓",
    **headings_of(("components",)),
    "dropped_components": "Dropped",
    "held_share": "Held back",
    "volume_ratio": "Volume to shape",
    "volume_to_paper": "Volume to paper",
}

_SHARES = {"valid", "manifold_edges", "held_share"}

_NOTES = [
    "Valid: no inverted tet, every boundary edge with two faces, every boundary vertex with one fan of them, "
    "no self-intersection of the boundary (libigl), no part within another; docs/certificate.md.",
    "Mode `paper` leaves the mesh as the paper's recipe makes it, `solid` makes it valid; the fields are the "
    "same. Training and validation shapes are ground-truth fields.",
    "Inverted tets, non-manifold edges and vertices, self-intersections and dropped pieces are sums over "
    "meshes. Angles are in degrees: the least of all tets, and the mean over meshes of what 1 % of their "
    "tets fall short of. Components are means. Empty meshes are left out.",
    "Held back: vertices of the boundary, counted as half of its faces, that the bound on angles keeps more "
    "than a tenth of a cell from the surface. Volume to shape: median over meshes of the volume over that of "
    "the repaired shape that the field is of; to paper: over that of the same field's mesh in mode `paper`.",
    "The paper states manifold edges of its ground-truth chairs and of generated ones (in parentheses), and "
    "names neither grid nor smoothing.",
    "[…]: bootstrap intervals of 95 % over meshes.",
]


@dataclass(frozen=True)
class _Samples:
    """A folder that `tetgan sample` wrote, by its place `{category}/{model}/{seed}/{mode}`."""

    folder: Path

    @property
    def place(self) -> tuple[str, str, str, str]:
        category, model, seed, mode = self.folder.parts[-4:]
        return category, model, seed, mode

    @cached_property
    def about(self) -> dict[str, Any]:
        """Method, and number of tets of the grid; empty for samples of unknown origin."""
        path = self.folder / "about.json"
        return json.loads(path.read_text()) if path.is_file() else {}

    @cached_property
    def certificates(self) -> dict[str, pd.DataFrame]:
        """Those of meshes with and without smoothing.

        Raises:
            UserError: there are none, or they lack columns.
        """
        found = {}
        for path in sorted(self.folder.glob(CERTIFICATES)):
            certificate = SampleFolder(path.parent).certificate
            if certificate is None or not _NEEDED.issubset(certificate.columns):
                raise UserError(f"{path}: no certificate of solids; sample the model again")
            found[path.parent.name] = certificate
        if not found:
            raise UserError(f"{self.folder}: no samples; expected a folder 'none' or 'wls' in it")
        return found


def tabulate_quality(samples: Sequence[Path], catalogues: Sequence[Path], paper: Path, out: Path) -> None:
    """Write the table as CSV, and as Markdown beside it.

    Args:
        samples: folders `…/{category}/{model}/{seed}/{mode}` of models on a grid.
        catalogues: `…/{category}/catalogue.csv`, for the volumes of the shapes.
        paper: published figures (`tetgan.tables.paper`).
        out: `.csv` to write.

    Raises:
        UserError: no samples, or a folder that is none of samples.
    """
    if not samples:
        raise UserError(f"{out}: no samples to make a table of")
    for folder in samples:
        if len(folder.parts) < 4 or not folder.parts[-2].isdigit():
            raise UserError(f"{folder}: no folder {{category}}/{{model}}/{{seed}}/{{mode}} of samples")
    volumes = {path.parent.name: _shape_volumes(path) for path in catalogues}
    table = build_quality([_Samples(folder) for folder in samples], volumes, read_paper(paper))
    write_twins(table, _render(table), out)


def build_quality(
    samples: Sequence[_Samples], volumes: Mapping[str, pd.Series], paper: pd.DataFrame
) -> pd.DataFrame:
    """A row a category, model, mode, smoothing and kind of shapes: `IDENTITY`, then `FIGURES`.

    Args:
        volumes: of the shapes of each category, by their ids.
    """
    rows = [
        _row(members, smoothing, kind, samples=samples, volumes=volumes, paper=paper)
        for members in _of_one_row(samples)
        for smoothing in members[0].certificates
        for kind in KINDS
        if any((member.certificates[smoothing]["set"] == kind).any() for member in members)
    ]
    return pd.DataFrame(rows, columns=[*IDENTITY, *FIGURES]).astype(dict.fromkeys(_COUNTS, "Int64"))


def _of_one_row(samples: Sequence[_Samples]) -> Iterator[list[_Samples]]:
    """The seeds of each category, model and mode, in the order in which they come."""
    groups: dict[tuple[str, str, str], list[_Samples]] = {}
    for one in samples:
        category, model, _, mode = one.place
        groups.setdefault((category, model, mode), []).append(one)
    yield from groups.values()


def _shape_volumes(catalogue: Path) -> pd.Series:
    table = read_catalogue(catalogue)
    if "cube_volume" not in table:
        raise UserError(f"{catalogue}: no column 'cube_volume'; repair the shapes again")
    return pd.to_numeric(table.set_index("id")["cube_volume"]).dropna()


def _row(
    members: Sequence[_Samples],
    smoothing: str,
    kind: str,
    *,
    samples: Sequence[_Samples],
    volumes: Mapping[str, pd.Series],
    paper: pd.DataFrame,
) -> dict[str, Any]:
    category, model, _, mode = members[0].place
    found = [_meshes(member, smoothing, kind) for member in members]
    meshes = pd.concat(found)
    solids = meshes[meshes["tets"] > 0]
    about = members[0].about
    method = about.get("method")
    shapes = _shapes(method, kind)
    known = {"training": "ground truth", "generated": "generated"}  # as the paper calls them
    own = method in OWN_METHODS and shapes in known
    return {
        "category": category,
        "model": model,
        "tets": about.get("tets"),
        "mode": mode,
        "smoothing": smoothing,
        "shapes": shapes,
        "seeds": len(members),
        "n": len(solids),
        "empty": len(meshes) - len(solids),
        "manifold_edges_paper": quoted_figure(paper, category, known[shapes], "manifold_edges")
        if own
        else None,
        **(_figures(solids, mode) if len(solids) else {}),
        **_estimate("volume_ratio", _ratios(solids, volumes.get(category)), np.median),
        **_estimate("volume_to_paper", _ratios_to_paper(members, samples, smoothing, kind), np.median),
    }


def _meshes(member: _Samples, smoothing: str, kind: str) -> pd.DataFrame:
    certificate = member.certificates[smoothing]
    return certificate[certificate["set"] == kind].set_index("id")


def _shapes(method: str | None, kind: str) -> str:
    """What the fields are: of a representation they are the ground truth of the two splits."""
    if method == "representation":
        return {"generated": "training", "reconstructed": "validation"}[kind]
    return kind


def _figures(solids: pd.DataFrame, mode: str) -> dict[str, Any]:
    """Figures of meshes that have tets; what is done in mode `solid` alone is empty in the other."""
    figures: dict[str, Any] = {name: int(solids[name].sum()) for name in SUMS} | {
        "inverted_share": float(solids["inverted_tets"].sum() / solids["tets"].sum()),
        "min_dihedral": float(solids["min_dihedral"].min()),
        "min_radius_ratio": float(solids["min_radius_ratio"].min()),
        "radius_ratios": " ".join(map(str, _histogram(solids["radius_ratios"]))),
    }
    if mode == "solid":
        figures["dropped_components"] = int(solids["dropped_components"].sum())
        figures["held_share"] = float(solids["held"].sum() / (solids["faces"].sum() / 2))
    for name, (column, statistic) in _STATISTICS.items():
        figures |= _estimate(name, solids[column].to_numpy(np.float64), statistic)
    return figures


def _estimate(
    name: str, values: Float[np.ndarray, "N"], statistic: Callable[..., Any]
) -> dict[str, float | None]:
    """The statistic over meshes, and its bootstrap interval; empty of no meshes."""
    if len(values) == 0:
        return {}
    options = BootstrapOptions()
    interval = bootstrap(values, statistic, options.resamples, options.level, named_rng(0, "quality", name))
    return {name: float(statistic(values)), f"{name}_low": interval.low, f"{name}_high": interval.high}


def _histogram(counts: pd.Series) -> Int[np.ndarray, "B"]:
    """Sum of histograms, each as numbers with blanks between."""
    return np.sum([np.array(each.split(), dtype=np.int64) for each in counts], axis=0)


def _ratios(solids: pd.DataFrame, volumes: pd.Series | None) -> Float[np.ndarray, "N"]:
    """Volume of each solid of a known shape over the shape's; none for generated ones."""
    if volumes is None:
        return np.empty(0)
    return (solids["volume"] / volumes.reindex(solids.index)).dropna().to_numpy(np.float64)


def _ratios_to_paper(
    members: Sequence[_Samples], samples: Sequence[_Samples], smoothing: str, kind: str
) -> Float[np.ndarray, "N"]:
    """Volume of each solid over that of the same field meshed as the paper does; none in mode `paper`."""
    by_place = {one.place: one for one in samples}
    ratios: list[float] = []
    for member in members:
        category, model, seed, mode = member.place
        faithful = by_place.get((category, model, seed, "paper"))
        if mode == "paper" or faithful is None or smoothing not in faithful.certificates:
            continue
        own, theirs = (_meshes(one, smoothing, kind) for one in (member, faithful))
        volumes = own.loc[own["tets"] > 0, "volume"], theirs.loc[theirs["volume"] > 0, "volume"]
        ratios += volumes[0].div(volumes[1]).dropna().tolist()  # by id
    return np.array(ratios)


def _render(table: pd.DataFrame) -> str:
    columns: dict[str, Any] = {
        "Category": table["category"],
        "Model": table.apply(row_name, axis=1),
        "Shapes": table["shapes"],
        "N": table["n"].map(plain),
    }
    columns |= {title: table.apply(_cell, axis=1, figure=name) for name, title in _HEADINGS.items()}
    return page("Quality of the solids", markdown_table(columns), notes=_NOTES)


def _cell(row: pd.Series, figure: str) -> str:
    printed = row.get(f"{figure}_paper")
    paper = "" if pd.isna(printed) else f" (paper {printed})"
    value = row[figure]
    if pd.isna(value):
        return f"—{paper}"
    if figure in _SHARES:
        return f"{round_value(100 * value)} %{_interval(row, figure, 100)}{paper}"
    share = f" ({round_value(100 * row['inverted_share'])} %)" if figure == "inverted_tets" and value else ""
    shown = int(value) if figure in _COUNTS else round_value(value)
    return f"{shown}{share}{_interval(row, figure)}{paper}"


def _interval(row: pd.Series, figure: str, scale: int = 1) -> str:
    low, high = row.get(f"{figure}_low", np.nan), row.get(f"{figure}_high", np.nan)
    if np.isnan(low):
        return ""
    return f" [{round_value(scale * low)}, {round_value(scale * high)}]"
