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
    """A private, C-ordered copy of `array` that nobody can change; itself if it is `frozen`.

    An unbroken part of a frozen array counts as frozen.

    >>> once = read_only([1, 2], np.float64)
    >>> once.flags.writeable, read_only(once, np.float64) is once
    (False, True)
    """
    if isinstance(array, np.ndarray) and array.dtype == dtype and _is_frozen(array):
        return array
    return frozen(np.array(array, dtype=dtype, order="C", copy=True))


def frozen(array: NDArray[Scalar]) -> NDArray[Scalar]:
    """The array itself, made unchangeable: for who has just made it and keeps no view of it."""
    array.flags.writeable = False
    return array


def _is_frozen(array: NDArray[Any]) -> bool:
    if not array.flags.c_contiguous or array.flags.writeable:
        return False
    whole = array.base
    return whole is None or (isinstance(whole, np.ndarray) and not whole.flags.writeable)
