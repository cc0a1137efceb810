"""Camera shared by shapes of the unit cube, so that their pictures compare."""

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
    """Direction, scale and middle of a picture.

    Attributes:
        size: width and height in pixels.
        azimuth, elevation: as in `render_mesh`.
        span: cube sides along the shorter side of the picture; by default the whole cube is in it, however it
            is turned about the upright axis.
        middle: the point in the middle of the picture; by default that of the cube.
    """

    size: tuple[int, int] = (300, 300)
    azimuth: float | int = 35.0
    elevation: float | int = 20.0
    span: float | int = 1.5
    middle: tuple[float, float, float] = MIDDLE

    def close_to(self, shapes: Iterable[Float[np.ndarray, "_v 3"]]) -> "View":
        """As near as it can be with all of these vertices in the picture, themselves in the middle of it."""
        shapes = [points for points in shapes if len(points)]
        if not shapes:
            return self
        places = np.concatenate(shapes) @ self._axes
        offset = (places.min(axis=0) + places.max(axis=0)) / 2 - np.array(self.middle) @ self._axes
        x, y, z = np.array(self.middle) + self._axes @ offset
        view = replace(self, middle=(float(x), float(y), float(z)))
        return view.holding(view.reach_of(shapes))

    def reach_of(self, shapes: Iterable[Float[np.ndarray, "_v 3"]]) -> Float[np.ndarray, "2"]:
        """Largest distance of vertices from the middle, across and up the picture, in cube sides."""
        middle, axes = np.array(self.middle), self._axes
        reaches = [np.abs((points - middle) @ axes).max(axis=0) for points in shapes if len(points)]
        return np.max([np.zeros(2), *reaches], axis=0)

    def pixels(self, points: Float[np.ndarray, "A 3"]) -> Float[np.ndarray, "A 2"]:
        """Columns and rows of points in the picture."""
        scale = min(self.size) / self.span
        across = (points - np.array(self.middle)) @ self._axes
        return np.array(self.size) / 2 + scale * across * np.array([1, -1])

    @property
    def _axes(self) -> Float[np.ndarray, "3 2"]:
        """Across and up the picture."""
        return camera_axes(self.azimuth, self.elevation)[:, :2]

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
            middle=self.middle,
        )

    @property
    def blank(self) -> UInt8[np.ndarray, "H W 3"]:
        """A white picture: no shape is here."""
        return np.full((self.size[1], self.size[0], 3), 255, dtype=np.uint8)
