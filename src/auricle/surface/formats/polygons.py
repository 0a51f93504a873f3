"""Polygons and strips cut into triangles, each triangle knowing the cell it was cut from."""

from collections.abc import Sequence
from itertools import pairwise
from typing import TypeVar

import numpy as np

from auricle.arrays import Faces, Integers

Corner = TypeVar("Corner")


def fans(starts: Integers, lengths: Integers, connectivity: Integers) -> tuple[Faces, Integers]:
    """Triangles that share the first corner of their polygon.

    Right for convex polygons; the fan of another one folds over itself.

    Parameters
    ----------
    starts, lengths
        Shape (p,): polygon i has the corners ``connectivity[starts[i]:starts[i] + lengths[i]]``,
        three or more.
    connectivity
        Vertex indices of all polygons in a row.

    Returns
    -------
    faces
        Shape (f, 3).
    owner
        Polygon of each triangle, shape (f,), ascending.

    Examples
    --------
    >>> corners = np.array([0, 1, 2, 2, 1, 4, 5])
    >>> faces, owner = fans(np.array([0, 3]), np.array([3, 4]), corners)
    >>> faces.tolist(), owner.tolist()
    ([[0, 1, 2], [2, 1, 4], [2, 4, 5]], [0, 1, 1])
    """
    owner, place = _triangles_of(lengths)
    first = starts[owner]
    corners = np.stack([first, first + place + 1, first + place + 2], axis=1)
    return connectivity[corners], owner


def strips(starts: Integers, lengths: Integers, connectivity: Integers) -> tuple[Faces, Integers]:
    """Triangles of strips, every second one turned so that all face the same way.

    Parameters and results as of `fans`.

    Examples
    --------
    >>> strips(np.array([0]), np.array([4]), np.array([7, 8, 9, 10]))[0].tolist()
    [[7, 8, 9], [10, 9, 8]]
    """
    owner, place = _triangles_of(lengths)
    first = starts[owner] + place
    turned = place % 2
    corners = np.stack([first + 2 * turned, first + 1, first + 2 - 2 * turned], axis=1)
    return connectivity[corners], owner


def fan(corners: Sequence[Corner]) -> list[tuple[Corner, Corner, Corner]]:
    """Triangles that share the first corner of one polygon.

    Examples
    --------
    >>> fan("abcd")
    [('a', 'b', 'c'), ('a', 'c', 'd')]
    """
    first, *others = corners
    return [(first, second, third) for second, third in pairwise(others)]


def fanned_remark(polygons: int) -> str:
    """Tell the user of polygons cut by `fans`."""
    return f"{polygons} polygons of more than three corners were cut into triangles, fan-wise"


def _triangles_of(lengths: Integers) -> tuple[Integers, Integers]:
    """Cell of each triangle, and its place among that cell's."""
    counts = lengths - 2
    owner = np.repeat(np.arange(len(counts)), counts)
    place = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    return owner, place
