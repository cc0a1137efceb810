"""Linear layer over points with an extra input per shape."""

from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional


def joint_linear(
    layer: nn.Linear, points: Float[Tensor, "B N P"], shape: Float[Tensor, "B S"]
) -> Float[Tensor, "B N C"]:
    """`layer` of each point's P features followed by the S of its shape.

    The shape's share is multiplied once a shape, not once a point.
    """
    split = points.shape[-1]
    of_shape = functional.linear(shape, layer.weight[:, split:], layer.bias)
    return functional.linear(points, layer.weight[:, :split]) + of_shape[:, None]
