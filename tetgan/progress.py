"""Work on several threads with a progress bar."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

import numpy as np
from rich.console import Console
from rich.progress import track

R = TypeVar("R")


def map_threads(
    function: Callable[..., R], items: Sequence[Any] | np.ndarray, threads: int, label: str
) -> list[R]:
    """Results of `function` for every item, in their order."""
    with ThreadPoolExecutor(max_workers=threads) as pool:
        results = pool.map(function, items)
        return list(track(results, label, total=len(items), console=Console(stderr=True), transient=True))
