"""Pictures of triangle soups by ray casting on the processor.

Shading is two-sided and flat, so flipped, repeated and open faces look like any other; depth reads from
a shadowed key light and ambient occlusion.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int, UInt8

from tetgan.geometry.rays import Visibility
from tetgan.geometry.triangles import area_normals

STEEL: tuple[float, float, float] = (0.22, 0.42, 0.70)  # default colour of a surface, linear RGB

_MARGIN = 0.04  # of the picture's shorter side, left free around the shape

_SUPERSAMPLES = 2  # rays a pixel along each axis

_SKY_RAYS = 5  # ambient-occlusion rays a primary ray

_SKY_REACH = 0.6  # how far a surface darkens its surroundings, over the shape's diagonal

_LIFT = 2e-4  # start of a secondary ray above its surface, over the shape's diagonal


# Linear RGB of the lights: a warm one from the upper left, a weak one from the right, and the sky.
_KEY = np.array([0.74, 0.70, 0.64])

_FILL = np.array([0.13, 0.14, 0.16])

_SKY = np.array([0.34, 0.37, 0.42])


def _even_sphere(count: int) -> Float[np.ndarray, "N 3"]:
    """Points spread evenly over the unit sphere, in an order of which every stride is spread too."""
    number = np.arange(count)
    height = 1 - (2 * number + 1) / count
    angle = number * np.pi * (3 - np.sqrt(5))
    ring = np.sqrt(1 - height**2)
    return np.stack([ring * np.cos(angle), ring * np.sin(angle), height], axis=1).astype(np.float32)


_SPHERE = _even_sphere(_SKY_RAYS * _SUPERSAMPLES**2)


@dataclass(frozen=True)
class _Camera:
    """Orthographic: unit axes, the point at the picture's middle, and mesh units a pixel."""

    right: Float[np.ndarray, "3"]
    up: Float[np.ndarray, "3"]
    back: Float[np.ndarray, "3"]
    middle: Float[np.ndarray, "3"]
    pixel: float


def render_mesh(
    vertices: Float[np.ndarray, "V 3"],
    faces: Int[np.ndarray, "F 3"],
    *,
    size: tuple[int, int] = (400, 400),
    azimuth: float | int = 35.0,
    elevation: float | int = 20.0,
    colors: Float[np.ndarray, "F 3"] | tuple[float, float, float] = STEEL,
    span: float | int | None = None,
    middle: tuple[float, float, float] | None = None,
) -> UInt8[np.ndarray, "H W 3"]:
    """Shaded orthographic picture on white.

    Args:
        size: width and height in pixels.
        azimuth: degrees the camera goes round the y axis, from the front (+z) towards +x.
        elevation: degrees above the horizon.
        colors: linear RGB in 0..1, one or one a face.
        span: mesh units along the shorter side of the picture; by default the shape fills the picture.
        middle: with `span`, the point in the middle of the picture; by default that of the bounding box.

    Returns:
        sRGB pixels; all white for a mesh without faces.
    """
    if len(faces) == 0:
        return np.full((size[1], size[0], 3), 255, dtype=np.uint8)
    camera = _place_camera(
        vertices[np.unique(faces)], size, camera_axes(azimuth, elevation), span=span, middle=middle
    )
    # Embree computes in float32: a shape about the origin of size one loses least.
    diagonal = float(np.linalg.norm(np.ptp(vertices, axis=0))) or 1.0
    scaled = ((vertices - camera.middle) / diagonal).astype(np.float32)
    scene = Visibility(scaled[faces])

    origins = _ray_origins(camera, size, diagonal)
    hit, face, points = _first_hits(scene, origins, camera)
    normals = _facing_normals(scaled[faces[face]], camera)
    light = _light(scene, points, normals, _subpixels(size)[hit], camera)
    shade = np.ones((len(origins), 3))
    paint = np.asarray(colors, dtype=float)
    shade[hit] = _encode(light * (paint if paint.ndim == 1 else paint[face]))
    return _average(shade, size)


def camera_axes(azimuth: float | int, elevation: float | int) -> Float[np.ndarray, "3 3"]:
    """Unit columns: to the right, up and back towards the viewer; angles as in `render_mesh`."""
    turn, rise = np.radians(azimuth), np.radians(elevation)
    back = np.array([np.sin(turn) * np.cos(rise), np.sin(rise), np.cos(turn) * np.cos(rise)])
    right = np.array([np.cos(turn), 0.0, -np.sin(turn)])
    return np.stack([right, np.cross(back, right), back], axis=1)


def _place_camera(
    points: Float[np.ndarray, "V 3"],
    size: tuple[int, int],
    axes: Float[np.ndarray, "3 3"],
    *,
    span: float | int | None,
    middle: tuple[float, float, float] | None,
) -> _Camera:
    right, up, back = axes.T
    shorter = min(size)
    if span is not None:
        box = (points.min(axis=0) + points.max(axis=0)) / 2
        return _Camera(right, up, back, box if middle is None else np.array(middle), span / shorter)
    seen = points @ axes
    low, high = seen.min(axis=0), seen.max(axis=0)
    room = np.array(size) - 2 * _MARGIN * shorter
    pixel = float(((high - low)[:2] / room).max())
    return _Camera(right, up, back, axes @ (low + high) / 2, pixel or 1.0 / shorter)


def _ray_origins(camera: _Camera, size: tuple[int, int], diagonal: float) -> Float[np.ndarray, "R 3"]:
    """Start points in scene units, in front of everything: rows from the top, subpixels in place."""
    width, height = (extent * _SUPERSAMPLES for extent in size)
    step = camera.pixel / _SUPERSAMPLES / diagonal
    x = (np.arange(width) + 0.5 - width / 2) * step
    y = (height / 2 - np.arange(height) - 0.5) * step
    plane = y[:, None, None] * camera.up + x[None, :, None] * camera.right
    return (plane + 2.0 * camera.back).reshape(-1, 3).astype(np.float32)


def _subpixels(size: tuple[int, int]) -> Int[np.ndarray, "R"]:
    """Place of each ray within its pixel, in the order of the rays."""
    width, height = (extent * _SUPERSAMPLES for extent in size)
    column, row = np.arange(width) % _SUPERSAMPLES, np.arange(height) % _SUPERSAMPLES
    return (row[:, None] * _SUPERSAMPLES + column).ravel()


def _first_hits(
    scene: Visibility, origins: Float[np.ndarray, "R 3"], camera: _Camera
) -> tuple[Bool[np.ndarray, "R"], Int[np.ndarray, "N"], Float[np.ndarray, "N 3"]]:
    """Which rays hit, and for those the face and the point."""
    face, distance = scene.first_faces(origins, -camera.back)
    hit = face >= 0
    return hit, face[hit], origins[hit] - distance[hit, None] * camera.back


def _facing_normals(corners: Float[np.ndarray, "N 3 3"], camera: _Camera) -> Float[np.ndarray, "N 3"]:
    """Unit normals of triangles, turned to the camera: the winding of a soup means nothing."""
    normals = area_normals(corners.astype(float))
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    return np.where((normals @ camera.back < 0)[:, None], -normals, normals)


def _light(
    scene: Visibility,
    points: Float[np.ndarray, "N 3"],
    normals: Float[np.ndarray, "N 3"],
    subpixel: Int[np.ndarray, "N"],
    camera: _Camera,
) -> Float[np.ndarray, "N 3"]:
    """Linear RGB arriving at each hit point, 0 to about 1.2."""
    starts = (points + _LIFT * normals).astype(np.float32)
    key = _unit(-0.45 * camera.right + 0.70 * camera.up + 0.75 * camera.back)
    fill = _unit(0.85 * camera.right + 0.15 * camera.up + 0.5 * camera.back)
    towards = np.clip(normals @ key, 0, None)
    lit = towards > 0
    towards[lit] *= scene.sees_out(starts[lit], key[None], reach=1e3)
    sky = _open_sky(scene, starts, normals, subpixel)
    from_sky = sky * (1 + 0.25 * normals[:, 1])  # brighter above than below
    from_fill = np.clip(normals @ fill, 0, None) * sky
    return towards[:, None] * _KEY + from_fill[:, None] * _FILL + from_sky[:, None] * _SKY


def _open_sky(
    scene: Visibility,
    starts: Float[np.ndarray, "N 3"],
    normals: Float[np.ndarray, "N 3"],
    subpixel: Int[np.ndarray, "N"],
) -> Float[np.ndarray, "N"]:
    """Cosine-weighted share of nearby directions that are free.

    Each subpixel looks in its own few directions of one even set, the same for every pixel: a pixel's average
    covers the whole set and shows no grain.
    """
    free = np.zeros(len(starts))
    for group in range(_SUPERSAMPLES**2):
        here = np.flatnonzero(subpixel == group)
        from_here, normals_here = starts[here], normals[here].astype(np.float32)
        for direction in _SPHERE[group :: _SUPERSAMPLES**2]:
            # A uniform point of the sphere plus the normal is cosine-weighted about the normal. Its length,
            # up to two, scales the reach: what lies straight ahead darkens from further away.
            rays = normals_here + 0.999 * direction
            free[here] += scene.sees_out(from_here, rays, reach=_SKY_REACH / 2)
    return free / _SKY_RAYS


def _unit(vectors: Float[np.ndarray, "*rows 3"]) -> Float[np.ndarray, "*rows 3"]:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def _encode(linear: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "N 3"]:
    """Linear light to sRGB by its usual power law."""
    return np.clip(linear, 0, 1) ** (1 / 2.2)


def _average(shade: Float[np.ndarray, "R 3"], size: tuple[int, int]) -> UInt8[np.ndarray, "H W 3"]:
    width, height = size
    blocks = shade.reshape(height, _SUPERSAMPLES, width, _SUPERSAMPLES, 3)
    return np.round(255 * blocks.mean(axis=(1, 3))).astype(np.uint8)
