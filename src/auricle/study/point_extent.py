"""The extent of points in space: what can be said of them without a surface."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull, QhullError, cKDTree

from auricle.arrays import Points


@dataclass(frozen=True)
class PointExtent:
    """How points lie in space; distances are straight, mm.

    Attributes
    ----------
    n_places
        Places that differ.
    sides_mm
        Of the box along the axes that holds them.
    spacing_mm
        Median distance to the nearest other place; NaN for a single one.
    largest_gap_mm
        Largest of those distances; NaN for a single one.
    hull_area_mm2
        Area of their convex hull, which cuts across every hollow of the wall: a scale, not an
        area of wall. NaN if they lie in a plane.
    """

    n_places: int
    sides_mm: tuple[float, float, float]
    spacing_mm: float
    largest_gap_mm: float
    hull_area_mm2: float

    @property
    def per_cm2_of_hull(self) -> float:
        """Places per cm² of the hull."""
        return 100 * self.n_places / self.hull_area_mm2


def point_extent(positions: Points) -> PointExtent | None:
    """Extent of positions, shape (m, 3), mm; None if there are none.

    Examples
    --------
    >>> corners = [[x, y, z] for x in (0, 10) for y in (0, 10) for z in (0, 10)]
    >>> found = point_extent(np.array(corners, dtype=float))
    >>> found.spacing_mm, found.hull_area_mm2
    (10.0, 600.0)
    """
    if not len(positions):
        return None
    places = np.unique(positions, axis=0)
    near = np.array([math.nan])
    if len(places) > 1:
        near = np.asarray(cKDTree(places).query(places, k=2)[0])[:, 1]
    wide, deep, high = np.ptp(places, axis=0).tolist()
    return PointExtent(
        len(places), (wide, deep, high), float(np.median(near)), float(near.max()), _hull(places)
    )


def _hull(places: Points) -> float:
    if len(places) < 4:
        return math.nan
    try:
        return float(ConvexHull(places).area)
    except QhullError:  # all in a plane
        return math.nan
