"""Implicit shapes: distances to their surface, negative inside, and their smooth unions.

Coordinates come as three arrays that broadcast against each other (x, y, z of a grid, say), in mm.
"""

import numpy as np

from auricle.arrays import Floats, Points

Coordinates = tuple[Floats, Floats, Floats]


def smooth_minimum(first: Floats, second: Floats, *, blend: float) -> Floats:
    """Union of two shapes with the seam rounded off: equal to min where they differ by `blend`.

    The quadratic polynomial blend: never above min, and below it by blend/4 at most.

    Examples
    --------
    >>> smooth_minimum(np.array([0.0, 1.0]), np.array([0.0, 9.0]), blend=4.0).tolist()
    [-1.0, 1.0]
    """
    overlap = np.maximum(blend - np.abs(first - second), 0.0)
    lower: Floats = np.minimum(first, second) - overlap**2 / (4.0 * blend)
    return lower


def smooth_maximum(first: Floats, second: Floats, *, blend: float) -> Floats:
    """Intersection of two shapes with the edge rounded off, as `smooth_minimum` does a union."""
    return -smooth_minimum(-first, -second, blend=blend)


def sphere_distance(at: Coordinates, centre: Points, radius: float) -> Floats:
    """Signed distance to a sphere, mm; exact."""
    x, y, z = (coordinate - middle for coordinate, middle in zip(at, centre, strict=True))
    distance: Floats = np.sqrt(x**2 + y**2 + z**2) - radius
    return distance


def half_space_distance(at: Coordinates, point: Points, normal: Points) -> Floats:
    """Signed distance to the plane through `point`, positive on the unit normal's side; exact."""
    x, y, z = (
        (coordinate - middle) * slope
        for coordinate, middle, slope in zip(at, point, normal, strict=True)
    )
    distance: Floats = x + y + z
    return distance


def ellipsoid_distance(at: Coordinates, semi_axes: Points) -> Floats:
    """Distance to an ellipsoid about the origin, mm: exact on it, first order beside it.

    Examples
    --------
    >>> on_the_axis = (np.array([10.0]), np.array([0.0]), np.array([0.0]))
    >>> ellipsoid_distance(on_the_axis, np.array([10.0, 20.0, 30.0])).tolist()
    [0.0]
    """
    scaled = [coordinate / axis for coordinate, axis in zip(at, semi_axes, strict=True)]
    steep = [coordinate / axis for coordinate, axis in zip(scaled, semi_axes, strict=True)]
    value = np.sqrt(scaled[0] ** 2 + scaled[1] ** 2 + scaled[2] ** 2)
    slope = np.sqrt(steep[0] ** 2 + steep[1] ** 2 + steep[2] ** 2)
    at_centre = slope == 0
    distance: Floats = np.where(
        at_centre, -np.min(semi_axes), value * (value - 1.0) / np.where(at_centre, 1.0, slope)
    )
    return distance


def swept_distance(at: Coordinates, centres: Points, radii: Floats) -> Floats:
    """Distance to the union of spheres along a line, mm; exact outside.

    Parameters
    ----------
    at
        Where.
    centres
        Shape (m, 3), mm, much closer together than the radii.
    radii
        Shape (m,), mm.
    """
    distance = sphere_distance(at, centres[0], float(radii[0]))
    for centre, radius in zip(centres[1:], radii[1:], strict=True):
        np.minimum(distance, sphere_distance(at, centre, float(radius)), out=distance)
    return distance
