"""Features of point clouds and surfaces for FID, KID, precision and recall."""

from typing import Any

import numpy as np
import torch
from jaxtyping import Float
from rich.console import Console
from rich.progress import track

from tetgan.extractor.network import Classifier, PointNet2, prepare_clouds

# Enough to share the steps of farthest-point sampling; more only takes memory.
_BATCH = 8


@torch.no_grad()
def cloud_features(
    clouds: Float[np.ndarray, "N P 3"], network: PointNet2, label: str = "features"
) -> Float[np.ndarray, "N 256"]:
    """Features of 1,024 farthest points of every cloud, each centred and scaled to the unit sphere.

    Both sides of a comparison must start from clouds of the same P: the more points to choose from, the more
    evenly the farthest lie, and the features notice.

    Args:
        clouds: points in random order (the first one starts the farthest-point sampling).
        network: in evaluation mode, as `load_classifier` returns it; its device does the work.

    Raises:
        ValueError: a cloud has fewer than 1,024 points.
    """
    device = next(network.parameters()).device
    batches = torch.from_numpy(np.ascontiguousarray(clouds, dtype=np.float32)).split(_BATCH)
    found = [
        network.features(prepare_clouds(batch.to(device))).cpu()
        for batch in track(batches, label, console=Console(stderr=True), transient=True)
    ]
    return torch.cat(found).double().numpy()


def about_extractor(classifier: Classifier) -> dict[str, Any]:
    """Entries of a report about the network behind its features."""
    return {
        "digest": classifier.digest,
        "accuracy": classifier.accuracy,
        "categories": list(classifier.categories),
    }
