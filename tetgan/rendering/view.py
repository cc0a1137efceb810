"""One camera for many shapes of the unit cube, so that their pictures compare."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int, UInt8

from tetgan.rendering.raycast import STEEL, camera_axes, render_mesh

MIDDLE = (0.5, 0.5, 0.5)
_CLOSEST = 0.2  # span of a view of next to nothing, in cube sides
_MARGIN = 1.06  # room left around the shapes that touch the frame


@dataclass(frozen=True)
class View:
    """Direction and scale of a picture whose middle is that of the cube.

    Attributes:
        size: width and height in pixels.
        azimuth, elevation: as in `render_mesh`.
        span: cube sides along the shorter side of the picture; by default the whole cube is in it, however it
            is turned about the upright axis.
    """

    size: tuple[int, int] = (300, 300)
    azimuth: float | int = 35.0
    elevation: float | int = 20.0
    span: float | int = 1.5

    def close_to(self, shapes: Iterable[Float[np.ndarray, "_v 3"]]) -> "View":
        """The same view as near as it can be with all of these vertices in the picture."""
        return self.holding(self.reach_of(shapes))

    def reach_of(self, shapes: Iterable[Float[np.ndarray, "_v 3"]]) -> Float[np.ndarray, "2"]:
        """How far vertices lie from the middle at most, across and up the picture, in cube sides."""
        axes = camera_axes(self.azimuth, self.elevation)[:, :2]
        reaches = [np.abs((points - np.array(MIDDLE)) @ axes).max(axis=0) for points in shapes if len(points)]
        return np.max([np.zeros(2), *reaches], axis=0)

    def holding(self, reach: Float[np.ndarray, "2"]) -> "View":
        """The view with a reach just inside the picture; the view as it is, for no reach."""
        if not reach.any():
            return self
        frame = np.array(self.size) / min(self.size)
        return replace(self, span=max(2 * _MARGIN * float((reach / frame).max()), _CLOSEST))

    def draw(
        self,
        vertices: Float[np.ndarray, "V 3"],
        faces: Int[np.ndarray, "F 3"],
        colors: Float[np.ndarray, "F 3"] | tuple[float, float, float] = STEEL,
    ) -> UInt8[np.ndarray, "H W 3"]:
        """Picture of a mesh, see `render_mesh`."""
        return render_mesh(
            vertices,
            faces,
            size=self.size,
            azimuth=self.azimuth,
            elevation=self.elevation,
            colors=colors,
            span=self.span,
            middle=MIDDLE,
        )

    @property
    def blank(self) -> UInt8[np.ndarray, "H W 3"]:
        """A white picture: no shape stands here."""
        return np.full((self.size[1], self.size[0], 3), 255, dtype=np.uint8)
