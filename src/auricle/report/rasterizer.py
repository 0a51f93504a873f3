"""Rasteriser: pictures of coloured surfaces by a z-buffer, without a graphics system."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from auricle.arrays import Faces, Floats, Integers, PerVertex, Truths
from auricle.report.palettes import ColourScale
from auricle.report.views import Camera
from auricle.surface.mesh import Mesh

Image = NDArray[np.uint8]
"""Red, green, blue and opacity, shape (height, width, 4)."""

CANDIDATES = 1_000_000
"""Pixels in the bounding boxes of the faces drawn in one step: bounds the memory used."""

_SURFACE = np.array([222, 205, 196], dtype=np.float64)
_INSIDE = np.array([104, 82, 84], dtype=np.float64)
_LIGHT = np.array([-0.35, 0.45, 1.0]) / np.linalg.norm([-0.35, 0.45, 1.0])


@dataclass(frozen=True, eq=False)
class Raster:
    """What each pixel of a picture shows, before it is coloured.

    Attributes
    ----------
    camera
        The camera whose pixels these are.
    faces
        Index of the face seen, shape (height, width); -1 where there is none.
    weights
        Barycentric coordinates of the place seen, shape (height, width, 3).
    outside
        Whether the face's outer side is seen, shape (height, width).
    """

    camera: Camera
    faces: Integers
    weights: Floats
    outside: Truths


@dataclass(frozen=True, eq=False)
class _Planes:
    """One linear function of the picture's coordinates a face: a constant and two slopes."""

    level: Floats
    along_x: Floats
    along_y: Floats

    @classmethod
    def through(cls, corners: Floats, doubled: Floats, heights: Floats) -> Self:
        """Make the functions that take `heights`, shape (f, 3), at the corners."""
        x, y = (corners[:, 1:, axis] - corners[:, :1, axis] for axis in (0, 1))
        rise = heights[:, 1:] - heights[:, :1]
        # Faces seen exactly edge-on cover nothing, so that their slope does not matter.
        area = np.where(doubled == 0, 1.0, doubled)
        along_x = (rise[:, 0] * y[:, 1] - rise[:, 1] * y[:, 0]) / area
        along_y = (rise[:, 1] * x[:, 0] - rise[:, 0] * x[:, 1]) / area
        level = heights[:, 0] - along_x * corners[:, 0, 0] - along_y * corners[:, 0, 1]
        return cls(level, along_x, along_y)

    def at(self, faces: Integers, x: Floats, y: Floats) -> Floats:
        """Value of each face's function at a place of its own."""
        values: Floats = self.level[faces] + self.along_x[faces] * x + self.along_y[faces] * y
        return values


def rasterize(mesh: Mesh, camera: Camera) -> Raster:
    """Find what each pixel's centre shows: the face nearest to the viewer.

    Parameters
    ----------
    mesh
        The surface; parts outside the picture are cut off.
    camera
        Where it is looked at from.

    Returns
    -------
    Raster
        One entry a pixel. A centre on the edge of two faces belongs to exactly one of them.
    """
    corners = camera.project(mesh.vertices)[mesh.faces]
    doubled = _doubled_areas(corners)
    depth = _Planes.through(corners, doubled, corners[:, :, 2])
    nearest = np.full(camera.width * camera.height, -np.inf)
    faces = np.full(camera.width * camera.height, -1)
    for batch in _batches(corners, doubled, camera):
        pixels, found = _covered(corners[batch], camera)
        found = batch[found]
        depths = depth.at(found, *_centres(pixels, camera))
        np.maximum.at(nearest, pixels, depths)
        front = depths == nearest[pixels]
        faces[pixels[front]] = found[front]
    seen = np.flatnonzero(faces >= 0)
    weights = np.zeros((len(faces), 3))
    weights[seen] = _barycentric(corners, doubled, faces[seen], _centres(seen, camera))
    shape = (camera.height, camera.width)
    # Pixels count downwards, so a face seen from outside has a negative area in them.
    outside = (doubled[faces] < 0).reshape(shape)
    return Raster(camera, faces.reshape(shape), weights.reshape((*shape, 3)), outside)


def _doubled_areas(corners: Floats) -> Floats:
    """Twice the signed area of each face in the picture, square pixels."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas: Floats = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    return areas


def _batches(corners: Floats, doubled: Floats, camera: Camera) -> Iterator[Integers]:
    """Faces that can cover a pixel, in groups whose boxes hold about `CANDIDATES` pixels."""
    limits = np.array([camera.width, camera.height])
    low = np.clip(corners[:, :, :2].min(axis=1), 0, limits)
    high = np.clip(corners[:, :, :2].max(axis=1), 0, limits)
    boxes = np.prod(high - low + 1, axis=1)
    visible = np.flatnonzero((high > low).all(axis=1) & (doubled != 0))
    group = np.cumsum(boxes[visible]) // CANDIDATES
    yield from np.split(visible, np.flatnonzero(np.diff(group)) + 1)


def _covered(corners: Floats, camera: Camera) -> tuple[Integers, Integers]:
    """Flat indices of the pixels whose centres the faces cover, and the face of each."""
    faces, rows = _crossed_rows(corners[:, :, 1], camera.height)
    left, right = _crossings(corners, faces, rows)
    first = np.clip(np.ceil(left - 0.5), 0, camera.width).astype(np.int64)
    stop = np.clip(np.ceil(right - 0.5), 0, camera.width).astype(np.int64)
    span, column = _expanded(first, np.maximum(stop, first))
    return rows[span] * camera.width + column, faces[span]


def _crossed_rows(y: Floats, height: int) -> tuple[Integers, Integers]:
    """Every pair of a face and a row of pixels whose centres lie within the face's height."""
    first = np.clip(np.ceil(y.min(axis=1) - 0.5), 0, height).astype(np.int64)
    stop = np.clip(np.ceil(y.max(axis=1) - 0.5), 0, height).astype(np.int64)
    return _expanded(first, stop)


def _expanded(first: Integers, stop: Integers) -> tuple[Integers, Integers]:
    """Every integer of every range [first, stop), after the index of its range."""
    lengths = stop - first
    ranges = np.repeat(np.arange(len(first)), lengths)
    starts = np.cumsum(lengths) - lengths
    return ranges, np.arange(len(ranges)) + (first - starts)[ranges]


def _crossings(corners: Floats, faces: Integers, rows: Integers) -> tuple[Floats, Floats]:
    """Where the outline of each face in `faces` crosses the middle of a row: left and right."""
    y = rows + 0.5
    left, right = np.full(len(y), np.inf), np.full(len(y), -np.inf)
    for start, end in ((0, 1), (1, 2), (2, 0)):
        # Upwards whichever face asks, so that two faces agree on their common edge to the bit.
        downwards = corners[:, start, 1] > corners[:, end, 1]
        low = np.where(downwards[:, None], corners[:, end, :2], corners[:, start, :2])
        high = np.where(downwards[:, None], corners[:, start, :2], corners[:, end, :2])
        rise = high[:, 1] - low[:, 1]
        slope = (high[:, 0] - low[:, 0]) / np.where(rise > 0, rise, 1.0)
        crosses = (low[faces, 1] <= y) & (y < high[faces, 1])
        x = low[faces, 0] + (y - low[faces, 1]) * slope[faces]
        left = np.where(crosses, np.minimum(left, x), left)
        right = np.where(crosses, np.maximum(right, x), right)
    return left, right


def _centres(pixels: Integers, camera: Camera) -> tuple[Floats, Floats]:
    """Horizontal and vertical position of the centres of pixels."""
    rows, columns = np.divmod(pixels, camera.width)
    return columns + 0.5, rows + 0.5


def _barycentric(
    corners: Floats, doubled: Floats, faces: Integers, centres: tuple[Floats, Floats]
) -> Floats:
    """Weights of each face's corners at a pixel's centre, shape (p, 3), of sum 1."""
    of_first = _Planes.through(
        corners, doubled, np.broadcast_to([0.0, 1.0, 0.0], (len(corners), 3))
    )
    of_second = _Planes.through(
        corners, doubled, np.broadcast_to([0.0, 0.0, 1.0], (len(corners), 3))
    )
    first, second = of_first.at(faces, *centres), of_second.at(faces, *centres)
    # A thin face, seen edge-on, may be met a rounding error outside.
    weights = np.clip(np.stack([1 - first - second, first, second], axis=1), 0.0, 1.0)
    normalised: Floats = weights / np.einsum("pc->p", weights)[:, None]
    return normalised


def paint(
    raster: Raster,
    mesh: Mesh,
    values: PerVertex | None = None,
    *,
    scale: ColourScale | None = None,
    shading: float = 0.45,
) -> Image:
    """Colour what `raster` shows.

    Parameters
    ----------
    raster, mesh
        What each pixel shows, and the surface it was made from.
    values
        One number a vertex, interpolated over the faces; NaN is drawn in the scale's grey. None
        draws a plain surface.
    scale
        Colours of the values; needed with `values`.
    shading
        How much darker a part turned away from the light is, 0 (flat colours) to 1.

    Returns
    -------
    Image
        Shape (height, width, 4); transparent where there is no surface. The inside of the
        surface, seen through a hole, has a dark tone of its own whatever its values.
    """
    seen = raster.faces >= 0
    corners = mesh.faces[raster.faces[seen]]
    weights, outside = raster.weights[seen], raster.outside[seen]
    colours = np.broadcast_to(_SURFACE, (len(corners), 3)).copy()
    if values is not None and scale is not None:
        colours = scale.colours_of(_interpolated(values, corners, weights))
    colours[~outside] = _INSIDE
    lit = np.einsum("pc,pc->p", _brightness(mesh, raster.camera)[corners], weights)
    brightness = np.clip(np.where(outside, lit, -lit), 0.0, 1.0)
    colours *= (1 - shading + shading * brightness)[:, None]
    image = np.zeros((*raster.faces.shape, 4), dtype=np.uint8)
    image[seen, :3] = np.rint(colours)
    image[seen, 3] = 255
    return image


def _interpolated(values: PerVertex, corners: Faces, weights: Floats) -> Floats:
    """Values at places inside faces; unknown where unknown corners weigh more than the known."""
    known = np.isfinite(values)
    share = np.einsum("pc,pc->p", known.astype(np.float64)[corners], weights)
    total = np.einsum("pc,pc->p", np.where(known, values, 0.0)[corners], weights)
    interpolated = np.full(len(corners), np.nan)
    np.divide(total, share, out=interpolated, where=share >= 0.5)
    return interpolated


def _brightness(mesh: Mesh, camera: Camera) -> PerVertex:
    """Cosine between the outward normal at each vertex and the light; negative turned away."""
    normals = np.zeros_like(mesh.vertices)
    for corner in range(3):
        np.add.at(normals, mesh.faces[:, corner], mesh.face_normals)
    lengths = np.linalg.norm(normals, axis=1)
    view = camera.view
    light = _LIGHT @ np.stack([view.right, view.up, view.toward])
    brightness: PerVertex = normals @ light / np.maximum(lengths, np.finfo(float).tiny)
    return brightness


def render(
    mesh: Mesh,
    camera: Camera,
    values: PerVertex | None = None,
    *,
    scale: ColourScale | None = None,
    shading: float = 0.45,
    supersampling: int = 2,
) -> Image:
    """Picture of a surface: `rasterize` and `paint` at a finer grid, then averaged.

    Parameters
    ----------
    mesh, camera
        The surface and where it is looked at from.
    values, scale, shading
        As in `paint`.
    supersampling
        Pixels of the fine grid along one side of a pixel.

    Returns
    -------
    Image
        Shape (height, width, 4); the opacity is the covered share of a pixel.
    """
    raster = rasterize(mesh, finer(camera, supersampling))
    return coarser(paint(raster, mesh, values, scale=scale, shading=shading), supersampling)


def finer(camera: Camera, factor: int) -> Camera:
    """Return the same picture with `factor` times as many pixels along each side."""
    return replace(
        camera,
        mm_per_pixel=camera.mm_per_pixel / factor,
        width=camera.width * factor,
        height=camera.height * factor,
    )


def coarser(image: Image, factor: int) -> Image:
    """Average blocks of `factor` × `factor` pixels, the transparent ones without colour."""
    opaque = image[..., 3:].astype(np.float32)
    parts = np.concatenate([image[..., :3] * opaque, opaque], axis=2)
    places = [(row, column) for row in range(factor) for column in range(factor)]
    sums = np.sum([parts[row::factor, column::factor] for row, column in places], axis=0)
    colour = sums[..., :3] / np.maximum(sums[..., 3:], 1.0)
    averaged: Image = np.rint(np.dstack([colour, sums[..., 3:] / factor**2])).astype(np.uint8)
    return averaged
