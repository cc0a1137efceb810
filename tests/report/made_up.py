"""A made-up folder of results, hostile text included."""

from pathlib import Path

import meshio
import numpy as np
from PIL import Image

EVIL = '<script>alert("1")</script>'
CONFIG = {
    "run": "try",
    "categories": ["chair"],
    "sources": {"chair": {"kind": "builtin", "seed": 7}, "vase": {"path": f"my/{EVIL}", "seed": 8}},
    "seeds": [0, 1],
}
_TWIN = f"""# chair

Notes {EVIL} and [a link](https://example.org/x).

| Model | FID ↓ |
|:--|:--|
| tetgan-LR, wLS | 0.25 [0.2, 0.3] (paper 2.09) |
| {EVIL} | — |

## Notes

- ![p](http://example.org/p.png) <https://example.org> **bold**
"""
_BENCHMARKS = {
    "repair_shapes/chair/1-of-2": "30\t0:00:30\t120.0",
    "repair_shapes/chair/2-of-2": "90\t0:01:30\t123.4",
    "train": "600\t0:10:00\t-",
}


def write_results(folder: Path, vertices: np.ndarray, tets: np.ndarray) -> None:
    """Two tables, three figures, benchmarks, and three variants of a solid for each of two models."""
    wide = [f"m{number}" for number in range(14)]
    write_text(folder / "tables/chair.csv", f"model,{','.join(wide)}\nx{',1' * 14}\n")
    write_text(folder / "tables/chair.md", _TWIN)
    write_text(folder / "tables/manifold.csv", f"id,share\n{EVIL},0.98912345\n")
    for seed, name in enumerate(("chair/samples", "chair/interpolation", "resolution")):
        write_noise(folder / "figures" / f"{name}.png", seed)
    write_text(folder / "figures/resolution.csv", "resolution,error\n41,0.5\n")
    for stage, line in _BENCHMARKS.items():
        write_text(folder / "benchmarks" / f"{stage}.tsv", f"s\th:m:s\tmax_rss\n{line}\n")
    write_text(folder / "models/chair/tetgan-LR/0/options.json", '{"device": "a GPU"}\n')
    for model in ("tetgan-LR", "pca"):
        for seed, count in ((0, 3), (2, 1)):
            solids = folder / f"samples/chair/{model}/{seed}/paper/wls/generated"
            for number in range(count):
                write_solid(solids / f"{number:04d}.vtu", vertices * [1, 1 + number / 4, 1], tets[number:])


def write_text(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def write_noise(path: Path, seed: int) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    picture = np.random.default_rng(seed).integers(0, 256, (40, 60, 3), dtype=np.uint8)
    Image.fromarray(picture).save(path)


def write_solid(path: Path, vertices: np.ndarray, tets: np.ndarray) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    meshio.write(path, meshio.Mesh(vertices, [("tetra", tets)]))
