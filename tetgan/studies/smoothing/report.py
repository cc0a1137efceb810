"""The smoothing study as people read it: what becomes of the paper's claims, and the figures."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from tetgan.evaluation.estimates import mean_estimate
from tetgan.evaluation.metrics import headings_of
from tetgan.studies.smoothing.files import Study
from tetgan.studies.smoothing.smoothers import Variant

_HEADINGS = {
    **headings_of(("chamfer", "fid", "kid")),
    "volume_ratio": "Volume, smoothed / not",
    "volume_to_repaired": "Volume / repaired",
    "bend_p95": "Bend, 95th percentile",
    "bend_sharp": "Sharp edge",
    "bend_w1": "Bend, distance ↓",
    "crease_distance": "Crease distance ↓",
    **headings_of(("manifold_edges", "inverted_tets")),
}

_FEATURE_CLAIMS = {"fid": "wLS raises FID", "kid": "wLS raises KID"}


class Claim(NamedTuple):
    """A statement that `figure` of one variant is above (`sign` 1) or below (-1) that of another."""

    statement: str
    figure: str
    sign: int
    one: Variant
    other: Variant


class Finding(NamedTuple):
    """Mean difference over the same shapes, its interval, and what it says of the claim."""

    difference: float
    low: float
    high: float
    holds: str


_NONE, _WLS, _UNIFORM, _COTANGENT = (
    Variant(True, smoothing) for smoothing in ("none", "wls", "uniform", "cotangent")
)

CLAIMS = (
    Claim("wLS bends more sharply than cotangent (95th percentile)", "bend_p95", 1, _WLS, _COTANGENT),
    Claim("wLS has more sharp edge than cotangent", "bend_sharp", 1, _WLS, _COTANGENT),
    Claim("wLS keeps closer to the shape's creases than cotangent", "crease_distance", -1, _WLS, _COTANGENT),
    Claim("wLS keeps closer to the shape's creases than plain", "crease_distance", -1, _WLS, _UNIFORM),
    Claim("wLS thins: it takes volume away", "volume_to_repaired", -1, _WLS, _NONE),
    Claim("wLS thins more than cotangent", "volume_to_repaired", -1, _WLS, _COTANGENT),
    Claim("wLS bends more like the shape than no smoothing", "bend_w1", -1, _WLS, _NONE),
    Claim("wLS lies closer to the shape than no smoothing", "chamfer", -1, _WLS, _NONE),
)


def weigh_claim(claim: Claim, study: Study) -> Finding:
    """Compare two variants shape by shape.

    Returns:
        `holds` is 'yes' or 'no' where the interval of the mean difference leaves zero out, else 'undecided'.
    """
    one, other = (study.of(variant)[claim.figure] for variant in (claim.one, claim.other))
    values = (one - other).dropna().to_numpy(dtype=np.float64)
    estimate = mean_estimate(values, claim.statement, study.evaluation)
    return _judge(estimate.value, estimate.low, estimate.high, claim.sign)


def weigh_features(metric: str, study: Study) -> Finding:
    """Whether the paper's smoothing raises FID or KID; decided where the two intervals do not touch."""
    before, after = (
        {key: np.nan if value is None else value for key, value in estimate.items()}
        for estimate in (study.report["features"][variant.name][metric] for variant in (_NONE, _WLS))
    )
    return _judge(
        after["value"] - before["value"], after["low"] - before["high"], after["high"] - before["low"], 1
    )


def _judge(difference: float, low: float, high: float, sign: int) -> Finding:
    if low > 0 or high < 0:
        return Finding(difference, low, high, "yes" if sign * difference > 0 else "no")
    return Finding(difference, low, high, "undecided")


def render_smoothing(table: pd.DataFrame, studies: Sequence[Study]) -> str:
    """Markdown: what becomes of the paper's claims, the figures, and how they were measured.

    Args:
        table: of all models, over their seeds.
        studies: of the same models, one for each seed.
    """
    parts = ["# Smoothing", _introduction(studies), "## The paper's claims", _claims(studies)]
    for (category, model), rows in table.groupby(["category", "model"], sort=False):
        parts += [f"## {category}, {model}", _figures(rows)]
    return "\n\n".join([*parts, "## Notes", _notes(studies)]) + "\n"


def _introduction(studies: Sequence[Study]) -> str:
    beta = " or ".join(sorted({f"{study.report['meshing']['beta']:g}" for study in studies}))
    return (
        "Blocky and displaced (Eq. 3) surfaces, each as it is and after one step of three smoothings that "
        f"keep a share β = {beta} of every vertex: the paper's (wLS, Eq. 4), the plain Laplacian and the "
        "cotangent Laplacian. The paper shows a picture, gives no figures, and says: wLS yields smoother "
        "meshes that keep their detail better than LS alone; it creates sharper features than cotangent LS; "
        "it makes unnaturally thin pieces, which harms FID."
    )


def _claims(studies: Sequence[Study]) -> str:
    several = len({study.report["seed"] for study in studies}) > 1
    lines = []
    for study in studies:
        findings = {claim.statement: weigh_claim(claim, study) for claim in CLAIMS}
        findings |= {text: weigh_features(metric, study) for metric, text in _FEATURE_CLAIMS.items()}
        for statement, finding in findings.items():
            lines.append(
                {
                    "Category": study.report["category"],
                    "Fields": study.report["model"],
                    **({"Seed": study.report["seed"]} if several else {}),
                    "Claim": statement,
                    "Difference": _difference(finding),
                    "Holds": finding.holds,
                }
            )
    return pd.DataFrame(lines).to_markdown(index=False, disable_numparse=True)


def _difference(finding: Finding) -> str:
    if pd.isna(finding.difference):
        return "—"
    return f"{finding.difference:+.3g} [{finding.low:+.3g}, {finding.high:+.3g}]"


def _figures(rows: pd.DataFrame) -> str:
    shown = {"Surface": [_row_name(*row) for row in zip(rows["displaced"], rows["smoothing"], strict=True)]}
    for figure, title in _HEADINGS.items():
        shown[title] = [
            _figure(value, std) for value, std in zip(rows[figure], rows[f"{figure}_std"], strict=True)
        ]
    return pd.DataFrame(shown).to_markdown(index=False, disable_numparse=True)


def _figure(value: float, std: float) -> str:
    """A mean over seeds, and the deviation where there are several."""
    if pd.isna(value):
        return "—"
    return f"{value:.3g}" + ("" if pd.isna(std) else f" ± {std:.2g}")


def _row_name(displaced: Any, smoothing: str) -> str:
    if pd.isna(displaced):
        return "repaired shape, against itself"
    named = {"none": "not smoothed", "wls": "wLS", "uniform": "plain", "cotangent": "cotangent"}[smoothing]
    return f"{'displaced' if displaced else 'blocky'}, {named}"


def _notes(studies: Sequence[Study]) -> str:
    first = studies[0].report
    crease, level = first["study"]["crease"], 100 * first["evaluation"]["bootstrap"]["level"]
    numbers = ", ".join(dict.fromkeys(f"{study.report['samples']}" for study in studies))
    notes = [
        f"Claims: mean difference over the same shapes, displaced, with its {level:g} % bootstrap interval; "
        "'undecided' where that holds zero. For FID and KID: the difference, and the ends that the two "
        "intervals leave it.",
        "Chamfer, volumes, bends: reconstructions of validation shapes against their repaired meshes; a "
        "`representation` reconstructs by ground-truth fields. The CSV has every interval.",
        "Several seeds are one row: mean ± deviation over seeds; the claims are weighed seed by seed.",
        f"FID and KID: {numbers} generated surfaces against as many held-out ones (a `representation` takes "
        "training fields); the same fields and random points for each variant.",
        "Bend: angle between the outward normals of two faces that share an edge, weighted by the edge's "
        f"length; sharp edge: share that bends by more than {crease:g}°; distance: Wasserstein-1 in degrees "
        "to the repaired mesh's distribution. That mesh is triangulated more finely, so its bends are "
        "smaller where it is curved; variants share one triangulation and can be compared with each other. "
        "Bends far above 90° are folds of parts one tet thick, no features.",
        f"Crease distance: from points on the repaired mesh's sharp edges (over {crease:g}°) to the surface, "
        "mean, cube sides. Noise makes an edge bend more, but only a kept feature makes this small.",
        *dict.fromkeys(note for study in studies for note in study.report["notes"]),
    ]
    return "\n".join(f"- {note}" for note in notes)
