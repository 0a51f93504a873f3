"""Cutters: balls and discs a user puts where blood must not be followed any further."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from auricle.arrays import Floats, Points, Truths, read_only
from auricle.errors import InputError

WALL_MM = 2.0
"""Thickness of a disc; on a lattice coarser than that, one step of it."""


class Cutter(Protocol):
    """A part of space that bars the growing of a region."""

    def bars(self, points: Points, *, step: float) -> Truths:
        """Which nodes, shape (n, 3), mm, of a lattice of spacing `step` are barred, shape (n,)."""


@dataclass(frozen=True, eq=False)
class BallCutter:
    """Everything within `radius` (mm) of `centre`, shape (3,), mm, LPS.

    Raises
    ------
    InputError
        If the centre is not three finite coordinates, or the radius not positive.
    """

    centre: Floats
    radius: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "centre", _place(self.centre, "a ball's centre"))
        _require_radius(self.radius)

    def bars(self, points: Points, *, step: float) -> Truths:
        """Which nodes lie in the ball; one smaller than a step holds at least its cell.

        Examples
        --------
        >>> nodes = np.array([[0.0, 0, 0], [0, 0, 3], [0, 0, 4]])
        >>> BallCutter([0, 0, 0], 3.5).bars(nodes, step=1.0).tolist()
        [True, True, False]
        """
        reach = max(self.radius, step)
        near: Truths = np.square(points - self.centre).sum(axis=1) <= reach**2
        return near


@dataclass(frozen=True, eq=False)
class DiscCutter:
    """A wall: the disc about `centre` across `normal`, thick enough that nothing grows through.

    Parameters
    ----------
    centre
        Shape (3,), mm, LPS.
    normal
        Shape (3,), of any length.
    radius
        Of the disc, mm.

    Raises
    ------
    InputError
        If a coordinate is not finite, the normal has no direction, or the radius is not positive.
    """

    centre: Floats
    normal: Floats
    radius: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "centre", _place(self.centre, "a disc's centre"))
        normal = _place(self.normal, "a disc's normal")
        length = float(np.linalg.norm(normal))
        if not length > 0:
            raise InputError("a disc's normal without direction: give one coordinate other than 0")
        object.__setattr__(self, "normal", read_only(normal / length, np.float64))
        _require_radius(self.radius)

    def bars(self, points: Points, *, step: float) -> Truths:
        """Which nodes lie in the wall: no path over faces of voxels leads through it.

        Examples
        --------
        >>> nodes = np.array([[0.0, 0, 0], [0, 0, 1], [0, 0, 3], [9, 0, 0]])
        >>> DiscCutter([0, 0, 0], [0, 0, 2], 5.0).bars(nodes, step=1.0).tolist()
        [True, True, False, False]
        """
        offset = points - self.centre
        height = offset @ self.normal
        aside = np.square(offset).sum(axis=1) - np.square(height)
        wall: Truths = (np.abs(height) <= 0.5 * max(WALL_MM, step)) & (aside <= self.radius**2)
        return wall


def _place(values: Floats, what: str) -> Floats:
    place = read_only(values, np.float64)
    if place.shape != (3,) or not np.isfinite(place).all():
        raise InputError(f"{what} is not three finite numbers: give x, y, z in mm, LPS")
    return place


def _require_radius(radius: float) -> None:
    if not (np.isfinite(radius) and radius > 0):
        raise InputError(f"a cutter with a radius of {radius} mm: give a positive number")
