"""The arrays that cross auricle's borders, named by what they index, and how they are frozen."""

from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Truths = NDArray[np.bool_]

Points = Floats
"""Positions, shape (n, 3), mm."""
Faces = Integers
"""Vertex indices of triangles, shape (f, 3)."""
PerVertex = Floats
"""One number a vertex, shape (n,)."""
PerFace = Floats
"""One number a face, shape (f,)."""
Modes = Floats
"""One harmonic a column, shape (n, k)."""
PerMode = Floats
"""One number a harmonic, shape (k,)."""

Scalar = TypeVar("Scalar", bound=np.generic)


def read_only(array: ArrayLike, dtype: DTypeLike) -> NDArray[Any]:
    """A private, C-ordered copy of `array` that nobody can change.

    >>> frozen = read_only([1, 2], np.float64)
    >>> frozen.flags.writeable
    False
    """
    copy = np.array(array, dtype=dtype, order="C", copy=True)
    copy.flags.writeable = False
    return copy
