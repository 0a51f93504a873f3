"""Signed distances of ellipsoids, tubes and their unions on a block, negative inside, in mm."""

from dataclasses import dataclass
from math import sqrt
from typing import Protocol

import numpy as np

from auricle.arrays import Floats, Integers, Points
from auricle.compiled import compiled
from auricle.simulation.ct_block import Block, Box, Grid
from auricle.simulation.implicit import half_space_distance, smooth_minimum

FAR = 1e3
"""Distance given where a shape is too far to matter, mm."""


class Shape(Protocol):
    """A region of space with a smooth surface."""

    @property
    def box(self) -> Box:
        """Where it lies."""

    def distance(self, block: Block) -> Grid:
        """Signed distance at the voxels, mm, right to first order beside the surface."""


@dataclass(frozen=True, eq=False)
class Ellipsoids:
    """The smooth union of ellipsoids.

    Attributes
    ----------
    centres
        Shape (m, 3), mm.
    shapes
        Shape (m, 3, 3): the rows are the unit axes divided by the semi-axes, 1/mm.
    blend
        Width of the seams, mm, as in `smooth_minimum`.
    """

    centres: Points
    shapes: Floats
    blend: float = 0.0

    @property
    def box(self) -> Box:
        """Where they lie."""
        reach = np.linalg.norm(np.linalg.inv(self.shapes), axis=2) + self.blend / 4.0
        return (self.centres - reach).min(axis=0), (self.centres + reach).max(axis=0)

    def distance(self, block: Block) -> Grid:
        """Signed distance at the voxels, mm."""
        out = np.empty(block.shape, dtype=np.float32)
        _ellipsoids(out, block.origin, block.steps, self.centres, self.shapes, self.blend)
        return out


def ellipsoid(centre: Points, semi_axes: Points, long_axis: Points | None = None) -> Ellipsoids:
    """One ellipsoid; its third semi-axis along `long_axis`, or along z."""
    axes = np.eye(3) if long_axis is None else frame(long_axis)
    shape = axes / np.asarray(semi_axes)[:, None]
    return Ellipsoids(np.asarray(centre, dtype=np.float64)[None], shape[None])


def frame(axis: Points) -> Floats:
    """Three orthonormal rows, the last along `axis`.

    >>> bool(np.allclose(frame(np.array([0.0, 3.0, 4.0]))[2], [0.0, 0.6, 0.8]))
    True
    """
    third = np.asarray(axis, dtype=np.float64) / np.linalg.norm(axis)
    first = np.cross(third, np.eye(3)[np.argmin(np.abs(third))])
    first /= np.linalg.norm(first)
    rows: Floats = np.array([first, np.cross(third, first), third])
    return rows


def joined(shapes: list[Ellipsoids], *, blend: float) -> Ellipsoids:
    """The smooth union of ellipsoids as one shape."""
    return Ellipsoids(
        np.concatenate([shape.centres for shape in shapes]),
        np.concatenate([shape.shapes for shape in shapes]),
        blend,
    )


@dataclass(frozen=True, eq=False)
class Sweep:
    """A tube or a tree of tubes: spheres that move along segments and change size as they go.

    Attributes
    ----------
    segments
        Shape (s, 2, 4): x, y, z and radius at both ends of each segment, mm.
    reach
        How far from the surface distances are told apart, mm; beyond that they are `FAR`.
    """

    segments: Floats
    reach: float = 4.0

    @property
    def box(self) -> Box:
        """Where it lies."""
        places, radii = self.segments[..., :3], self.segments[..., 3:]
        return (places - radii).min(axis=(0, 1)), (places + radii).max(axis=(0, 1))

    def distance(self, block: Block) -> Grid:
        """Signed distance at the voxels, mm."""
        out = np.full(block.shape, FAR, dtype=np.float32)
        _sweep(out, block.origin, block.steps, self.segments, self._ranges(block), self.reach)
        return out

    def _ranges(self, block: Block) -> Integers:
        """First index and the one after the last, along i, j, k, of each segment's voxels."""
        ends = (self.segments[..., :3] - block.origin) @ block.inverse.T
        far = self.segments[..., 3].max(axis=1) + self.reach
        extent = np.linalg.norm(block.inverse, axis=1) * far[:, None]
        first = np.ceil(ends.min(axis=1) - extent)
        last = np.floor(ends.max(axis=1) + extent) + 1
        ranges: Integers = np.clip(np.stack([first, last], axis=1), 0, block.shape[::-1])
        return ranges.astype(np.int64)

    def distance_at(self, points: Points) -> Floats:
        """Signed distance at `points` (m, 3), shape (m,), mm; with no end to its reach."""
        return _sweep_at(np.ascontiguousarray(points), self.segments)


def sweep(nodes: Points, radii: Floats, *, reach: float = 4.0) -> Sweep:
    """A tube through `nodes` (m, 3) with `radii` (m,), both mm."""
    ends = np.column_stack([nodes, radii])
    return Sweep(np.stack([ends[:-1], ends[1:]], axis=1), reach)


def tree(tubes: list[Sweep]) -> Sweep:
    """Several tubes as one shape, with the reach of the first."""
    return Sweep(np.concatenate([tube.segments for tube in tubes]), tubes[0].reach)


@dataclass(frozen=True, eq=False)
class Union:
    """The smooth union of two shapes."""

    first: Shape
    second: Shape
    blend: float

    @property
    def box(self) -> Box:
        """Where it lies."""
        (low, high), (lower, higher) = self.first.box, self.second.box
        return np.minimum(low, lower), np.maximum(high, higher)

    def distance(self, block: Block) -> Grid:
        """Signed distance at the voxels, mm."""
        first, second = self.first.distance(block), self.second.distance(block)
        both = smooth_minimum(first.astype(float), second.astype(float), blend=self.blend)
        return both.astype(np.float32)


@dataclass(frozen=True, eq=False)
class Apart:
    """The part of a shape that keeps so many mm from another."""

    shape: Shape
    other: Shape
    gap: float

    @property
    def box(self) -> Box:
        """Where the whole shape lies."""
        return self.shape.box

    def distance(self, block: Block) -> Grid:
        """Signed distance at the voxels, mm."""
        whole = self.shape.distance(block)
        window = block.window(self.other.box, margin=self.gap + block.edge)
        if window is not None:
            near = self.gap - self.other.distance(block.part(window))
            whole[window] = np.maximum(whole[window], near)
        return whole


@dataclass(frozen=True, eq=False)
class Cut:
    """The part of a shape behind a plane.

    Attributes
    ----------
    shape
        What is cut.
    point, normal
        A point of the plane and the unit vector to the side that is cut off.
    """

    shape: Shape
    point: Points
    normal: Points

    @property
    def box(self) -> Box:
        """Where the whole shape lies."""
        return self.shape.box

    def distance(self, block: Block) -> Grid:
        """Signed distance at the voxels, mm."""
        whole = self.shape.distance(block)
        plane = half_space_distance(block.coordinates, self.point, self.normal)
        return np.maximum(whole, plane).astype(np.float32)


@compiled
def _sweep_at(points: Points, segments: Floats) -> Floats:
    out = np.full(len(points), FAR)
    for s in range(len(segments)):
        ax, ay, az, radius = segments[s, 0]
        u, v, w, growth = segments[s, 1] - segments[s, 0]
        scale = 1.0 / max(u * u + v * v + w * w, 1e-12)
        for m in range(len(points)):
            dx, dy, dz = points[m, 0] - ax, points[m, 1] - ay, points[m, 2] - az
            share = min(max((dx * u + dy * v + dz * w) * scale, 0.0), 1.0)
            dx, dy, dz = dx - share * u, dy - share * v, dz - share * w
            distance = sqrt(dx * dx + dy * dy + dz * dz) - radius - share * growth
            out[m] = min(out[m], distance)
    return out


@compiled
def _sweep(
    out: Grid, origin: Points, steps: Floats, segments: Floats, ranges: Integers, reach: float
) -> None:
    sx, sy, sz = steps[0, 0], steps[1, 0], steps[2, 0]
    for s in range(len(segments)):
        ax, ay, az, radius = segments[s, 0]
        u, v, w, growth = segments[s, 1] - segments[s, 0]
        scale = 1.0 / max(u * u + v * v + w * w, 1e-12)
        first, last = ranges[s, 0, 0], ranges[s, 1, 0]
        for k in range(ranges[s, 0, 2], ranges[s, 1, 2]):
            for j in range(ranges[s, 0, 1], ranges[s, 1, 1]):
                x = origin[0] + steps[0, 1] * j + steps[0, 2] * k - ax
                y = origin[1] + steps[1, 1] * j + steps[1, 2] * k - ay
                z = origin[2] + steps[2, 1] * j + steps[2, 2] * k - az
                row = out[k, j]
                for i in range(first, last):
                    dx, dy, dz = x + sx * i, y + sy * i, z + sz * i
                    share = min(max((dx * u + dy * v + dz * w) * scale, 0.0), 1.0)
                    dx, dy, dz = dx - share * u, dy - share * v, dz - share * w
                    distance = sqrt(dx * dx + dy * dy + dz * dz) - radius - share * growth
                    row[i] = min(row[i], np.float32(distance if distance < reach else FAR))


@compiled
def _ellipsoids(
    out: Grid, origin: Points, steps: Floats, centres: Points, shapes: Floats, blend: float
) -> None:
    """First-order distances, value over slope (Taubin 1994), and their smooth union.

    Along a row both the scaled position p and its pull-back g are linear in the index.
    """
    depth, rows, columns = out.shape
    seam = 0.25 / max(blend, 1e-12)
    for k in range(depth):
        for j in range(rows):
            row = out[k, j]
            row[:] = FAR
            start = origin + steps[:, 1] * j + steps[:, 2] * k
            for m in range(len(centres)):
                shape = shapes[m]
                p0, p1, p2 = _product(shape, start - centres[m])
                dp0, dp1, dp2 = _product(shape, steps[:, 0])
                g0, g1, g2 = _product(shape.T, np.array([p0, p1, p2]))
                dg0, dg1, dg2 = _product(shape.T, np.array([dp0, dp1, dp2]))
                for i in range(columns):
                    a, b, c = p0 + dp0 * i, p1 + dp1 * i, p2 + dp2 * i
                    d, e, f = g0 + dg0 * i, g1 + dg1 * i, g2 + dg2 * i
                    radius = sqrt(a * a + b * b + c * c) + 1e-9
                    slope = sqrt(d * d + e * e + f * f) + 1e-12
                    distance = np.divide(radius * (radius - 1.0), slope)
                    overlap = max(blend - abs(row[i] - distance), 0.0)
                    row[i] = min(row[i], distance) - overlap * overlap * seam


@compiled
def _product(matrix: Floats, column: Points) -> tuple[float, float, float]:
    x, y, z = column[0], column[1], column[2]
    return (
        matrix[0, 0] * x + matrix[0, 1] * y + matrix[0, 2] * z,
        matrix[1, 0] * x + matrix[1, 1] * y + matrix[1, 2] * z,
        matrix[2, 0] * x + matrix[2, 1] * y + matrix[2, 2] * z,
    )
