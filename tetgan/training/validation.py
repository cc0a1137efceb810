"""How well shapes that were not trained on come back."""

import numpy as np
import torch

from tetgan.models.measures import occupancy_iou
from tetgan.models.tetgan import TetganGenerator
from tetgan.nn.rows import RowMap
from tetgan.training.data import FieldData
from tetgan.training.losses import displacement_loss, occupancy_loss


@torch.no_grad()
def validate(
    generator: TetganGenerator, vertices: RowMap, data: FieldData, batch_size: int
) -> dict[str, float]:
    """Means over the split: occupancy IoU and the unweighted losses of the posterior mean's decoding."""
    sums = np.zeros(3)
    for field in data.batches(torch.arange(len(data)).split(batch_size)):
        decoded = generator.decode(generator.encode(field))
        iou = occupancy_iou((decoded[..., 0] > 0).cpu().numpy(), (field[..., 0] > 0.5).cpu().numpy())
        compared = displacement_loss(generator.in_range(decoded), generator.in_range(field), vertices)
        losses = occupancy_loss(decoded, field, 1.0), compared
        sums += [iou.sum(), *(len(field) * float(loss) for loss in losses)]
    names = ("validation_iou", "validation_occupancy_loss", "validation_displacement_loss")
    return {name: float(value) for name, value in zip(names, sums / len(data), strict=True)}
