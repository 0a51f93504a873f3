"""Gram-Schmidt for blocks: vectors made orthogonal to a basis, and to each other."""

import numpy as np

from auricle.arrays import Floats
from auricle.compiled import compiled
from auricle.spectral.lanes import added_product, eight, load, store
from auricle.spectral.narrow_products import LANES, project, squares, subtract

_CANCELLED = 1e-3
_DEPENDENT, _INDEPENDENT = 1e-5, 0.3
"""Of what of a row of length one is not in the span of those before: too little, and enough to be
right to rounding at the first attempt."""


def orthogonalize(basis: Floats, block: Floats) -> Floats:
    """Take out of `block`, in place, what lies in the span of `basis`; returns what that was.

    Parameters
    ----------
    basis
        Orthonormal vectors, one a row, shape (m, n); m may be 0.
    block
        Vectors, one a row, shape (b, n), changed in place.

    Returns
    -------
    Floats
        Coefficients of `block` in the basis, shape (m, b).

    Examples
    --------
    >>> block = np.array([[3.0, 4.0]])
    >>> orthogonalize(np.array([[1.0, 0.0]]), block).tolist(), block.tolist()
    ([[3.0]], [[0.0, 4.0]])
    """
    coefficients = np.zeros((len(basis), len(block)))
    if len(basis):
        _take_out(basis, block, coefficients)
    return coefficients


@compiled
def lengths(rows: Floats) -> Floats:
    """Of vectors, one a row, shape (b,)."""
    return np.asarray(np.sqrt(squares(rows)))


def add_multiples(block: Floats, factors: Floats, vectors: Floats) -> None:
    """Add factors·vectors to `block` in place: few vectors, one a row, shape (m, n).

    `factors` has shape (b, m), `block` (b, n), contiguous.
    """
    subtract(vectors, np.ascontiguousarray(-factors.T), block)


def orthonormalize(block: Floats) -> Floats:
    """Make the rows of `block` orthonormal, in place; returns what they were made of.

    That is a lower triangle with old rows = triangle·new rows: Cholesky's factor of the Gram
    matrix, once more where that was far from the identity; Householder's method where the rows
    are too near to dependent for that.

    Examples
    --------
    >>> block = np.array([[3.0, 0.0], [4.0, 2.0]])
    >>> orthonormalize(block).round(12).tolist(), block.round(12).tolist()
    ([[3.0, 0.0], [4.0, 2.0]], [[1.0, 0.0], [0.0, 1.0]])
    """
    triangle = np.eye(len(block))
    if not _make_orthonormal(block, triangle):
        columns, upper = np.linalg.qr(block.T)
        block[:] = columns.T
        triangle = triangle @ upper.T
    return triangle


@compiled
def _make_orthonormal(block: Floats, triangle: Floats) -> bool:
    """Make rows orthonormal; what they were made of is put into `triangle`.

    False where they are too near to dependent, with as much done as could be.
    """
    for _ in range(2):
        gram = np.zeros_like(triangle)
        project(block, block, gram)
        sizes = np.sqrt(np.diag(gram))
        if not sizes.min() > 0:
            return False
        factor = _cholesky(gram / np.outer(sizes, sizes))
        least = np.diag(factor).min()
        if least < _DEPENDENT:
            return False
        _multiply_rows(_inverse(factor) / sizes, block)
        triangle[:] = triangle @ (sizes.reshape((-1, 1)) * factor)
        if least > _INDEPENDENT:
            break
    return True


@compiled
def _cholesky(matrix: Floats) -> Floats:
    """The triangle of a small matrix of few rows; a diagonal entry is 0 where there is none."""
    factor = np.zeros_like(matrix)
    for j in range(len(matrix)):
        for i in range(j, len(matrix)):
            rest = matrix[i, j]
            for k in range(j):
                rest -= factor[i, k] * factor[j, k]
            if i > j:
                factor[i, j] = rest / factor[j, j]
            elif rest > 0:
                factor[j, j] = np.sqrt(rest)
            else:
                return factor
    return factor


@compiled
def _inverse(triangle: Floats) -> Floats:
    """The inverse of a small lower triangle."""
    inverse = np.zeros_like(triangle)
    for j in range(len(triangle)):
        inverse[j, j] = 1 / triangle[j, j]
        for i in range(j + 1, len(triangle)):
            for k in range(j, i):
                inverse[i, j] -= triangle[i, k] * inverse[k, j]
            inverse[i, j] /= triangle[i, i]
    return inverse


def aligned_rows(count: int, length: int) -> Floats:
    """Room for so many rows of at least that length: each begins with a line of the cache.

    Reading them takes a fifth less time than where registers straddle two lines.
    """
    stride = length + -length % LANES
    room = np.empty(count * stride + LANES)
    first = -(room.ctypes.data // room.itemsize) % LANES
    return room[first : first + count * stride].reshape(count, stride)


@compiled
def _multiply_rows(triangle: Floats, rows: Floats) -> None:
    """Rows turned into lower triangle·rows."""
    zero, numbers, n = eight(0.0), rows.reshape(-1), rows.shape[1]
    full = n - n % LANES
    for i in range(0, full, LANES):
        for q in range(len(rows) - 1, -1, -1):
            new = zero
            for p in range(q + 1):
                new = added_product(new, eight(triangle[q, p]), load(zero, numbers, p * n + i))
            store(new, numbers, q * n + i)
    for i in range(full, n):
        for q in range(len(rows) - 1, -1, -1):
            rest = 0.0
            for p in range(q + 1):
                rest += triangle[q, p] * rows[p, i]
            rows[q, i] = rest


@compiled
def _take_out(basis: Floats, block: Floats, coefficients: Floats) -> None:
    """Take the span of the basis out of `block`, and add what that was to `coefficients`."""
    taken = np.empty_like(coefficients)
    for _ in range(2):
        taken[:] = 0.0
        project(basis, block, taken)
        subtract(basis, taken, block)
        coefficients += taken
        # Twice is enough (Kahan, Parlett), and once where little cancelled. What was taken is
        # orthogonal to what is left, so that their squares add up to those before.
        left = squares(block)
        if (left >= _CANCELLED**2 * (left + (taken**2).sum(axis=0))).all():
            break
