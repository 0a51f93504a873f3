"""Regions of interest: a box, or a polygon drawn on a slice and extruded."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from auricle.arrays import Floats, Points, Truths, read_only
from auricle.errors import InputError

_PLANAR_MM = 1.0


class RegionOfInterest(Protocol):
    """A part of space, mm, LPS."""

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Opposite corners of the smallest box around it, each of shape (3,), mm."""

    def contains(self, points: Points) -> Truths:
        """Which of the points, shape (n, 3), mm, lie in it, shape (n,)."""


@dataclass(frozen=True, eq=False)
class BoxRegion:
    """The box along the axes of LPS between two opposite corners.

    Parameters
    ----------
    low, high
        Corners, shape (3,), mm.

    Raises
    ------
    InputError
        If a coordinate is not finite, or `high` is not above `low` on each axis.
    """

    low: Floats
    high: Floats

    def __post_init__(self) -> None:
        object.__setattr__(self, "low", read_only(self.low, np.float64))
        object.__setattr__(self, "high", read_only(self.high, np.float64))
        if self.low.shape != (3,) or self.high.shape != (3,):
            raise InputError("a box needs two corners of three coordinates: give x, y, z in mm")
        if not np.isfinite(self.high - self.low).all() or not (self.high > self.low).all():
            raise InputError("a box without inside: give the low corner first, then the high one")

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """The two corners."""
        return self.low, self.high

    def contains(self, points: Points) -> Truths:
        """Which points lie in the box, shape (n,).

        Examples
        --------
        >>> BoxRegion([0, 0, 0], [1, 2, 3]).contains(np.array([[0.5, 1, 3], [0.5, 1, 4]])).tolist()
        [True, False]
        """
        return np.asarray(((points >= self.low) & (points <= self.high)).all(axis=1))


@dataclass(frozen=True, eq=False)
class PolygonRegion:
    """The prism over a polygon drawn on a slice.

    Parameters
    ----------
    corners
        Shape (n, 3), n ≥ 3, mm, LPS, in one plane (to 1 mm), in order around the polygon.
    depth
        How far the prism reaches to either side of the plane, mm.

    Raises
    ------
    InputError
        If there are fewer than three corners, they are not finite, not in a plane, in a line,
        or the depth is not positive.
    """

    corners: Points
    depth: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "corners", read_only(self.corners, np.float64))
        if self.corners.ndim != 2 or self.corners.shape[1] != 3 or len(self.corners) < 3:
            raise InputError("a polygon needs three corners or more: give x, y, z of each in mm")
        if not np.isfinite(self.corners).all() or not self.depth > 0:
            raise InputError("a polygon with infinite corners or no depth: give positive mm")
        _, sizes, axes = np.linalg.svd(self.corners - self.corners.mean(axis=0))
        if sizes[1] < _PLANAR_MM:
            raise InputError("the polygon's corners lie in a line: draw it around the atrium")
        if np.abs((self.corners - self.corners.mean(axis=0)) @ axes[2]).max() > _PLANAR_MM:
            raise InputError("the polygon's corners do not lie in a plane: draw it on one slice")

    @property
    def _frame(self) -> Floats:
        """Two axes in the plane and its normal, one a row, shape (3, 3)."""
        axes: Floats = np.linalg.svd(self.corners - self.corners.mean(axis=0))[2]
        return axes

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """The smallest box along the axes of LPS around the prism."""
        reach = self.depth * np.abs(self._frame[2])
        return self.corners.min(axis=0) - reach, self.corners.max(axis=0) + reach

    def contains(self, points: Points) -> Truths:
        """Which points lie in the prism, shape (n,), by the even-odd rule.

        Examples
        --------
        >>> square = PolygonRegion([[0, 0, 5], [9, 0, 5], [9, 9, 5], [0, 9, 5]], depth=2.0)
        >>> square.contains(np.array([[4.0, 4, 6.5], [4, 4, 8], [10, 4, 5]])).tolist()
        [True, False, False]
        """
        middle = self.corners.mean(axis=0)
        u, v, height = ((points - middle) @ self._frame.T).T
        around = (self.corners - middle) @ self._frame[:2].T
        inside = np.zeros(len(points), dtype=bool)
        for (u0, v0), (u1, v1) in zip(around, np.roll(around, -1, axis=0), strict=True):
            if v0 == v1:
                continue
            crosses = (v0 > v) != (v1 > v)
            inside ^= crosses & (u < u0 + (v - v0) * (u1 - u0) / (v1 - v0))
        within: Truths = inside & (np.abs(height) <= self.depth)
        return within
