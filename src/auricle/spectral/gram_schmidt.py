"""Gram-Schmidt for blocks: vectors made orthogonal to a basis, and to each other.

Vectors are in groups, as `auricle.spectral.narrow_products` takes them.
"""

import numpy as np

from auricle.arrays import Floats
from auricle.compiled import compiled
from auricle.spectral.lanes import Lanes, eight, four
from auricle.spectral.narrow_products import Groups, combine, project, squares, subtract

_CANCELLED = 1e-3
_DEPENDENT, _INDEPENDENT = 1e-5, 0.3
"""Of what of a row of length one is not in the span of those before: too little, and enough to be
right to rounding at the first attempt."""


def orthogonalize(basis: Groups, block: Groups) -> Floats:
    """Take out of `block`, in place, what lies in the span of `basis`; returns what that was.

    Parameters
    ----------
    basis
        Orthonormal vectors, and zeros maybe, shape (g, n, lanes); g may be 0.
    block
        Vectors, shape (h, n, lanes), changed in place.

    Returns
    -------
    Floats
        Coefficients of `block` in the basis, shape (g·lanes, h·lanes).

    Examples
    --------
    >>> basis, block = np.zeros((1, 2, 4)), np.zeros((1, 2, 4))
    >>> basis[0, :, 0], block[0, :, 0] = [1.0, 0.0], [3.0, 4.0]
    >>> orthogonalize(basis, block)[0].tolist(), block[0, :, 0].tolist()
    ([3.0, 0.0, 0.0, 0.0], [0.0, 4.0])
    """
    lanes = block.shape[2]
    coefficients = np.zeros((len(basis) * lanes, len(block) * lanes))
    if len(basis):
        (_take_out_fours if lanes == 4 else _take_out_eights)(basis, block, coefficients)
    return coefficients


def lengths(block: Groups) -> Floats:
    """Of vectors, shape (b,)."""
    return np.asarray(np.sqrt((_squares_fours if block.shape[2] == 4 else _squares_eights)(block)))


def orthonormalize(block: Groups) -> Floats:
    """Make the vectors of `block` orthonormal, in place; returns what they were made of.

    That is a lower triangle with old vectors = triangle·new vectors: Cholesky's factor of the Gram
    matrix, once more where that was far from the identity; Householder's method where the vectors
    are too near to dependent for that.

    Examples
    --------
    >>> block = np.array([[[3.0, 4.0, 0.0, 0.0], [0.0, 2.0, 0.0, 0.0], [0, 0, 1, 0], [0, 0, 0, 1]]])
    >>> orthonormalize(block)[:2, :2].round(12).tolist(), block[0, :2, :2].round(12).T.tolist()
    ([[3.0, 0.0], [4.0, 2.0]], [[1.0, 0.0], [0.0, 1.0]])
    """
    lanes = block.shape[2]
    triangle = np.eye(len(block) * lanes)
    make = _make_fours_orthonormal if lanes == 4 else _make_eights_orthonormal
    if not make(block, triangle):
        columns, upper = np.linalg.qr(np.concatenate(list(block), axis=1))
        for i, group in enumerate(block):
            group[:] = columns[:, i * lanes : (i + 1) * lanes]
        triangle = triangle @ upper.T
    return triangle


# Either width is compiled where it is used and not before.


@compiled
def _take_out_fours(basis: Groups, block: Groups, coefficients: Floats) -> None:
    _take_out(basis, block, coefficients, four(0.0))


@compiled
def _take_out_eights(basis: Groups, block: Groups, coefficients: Floats) -> None:
    _take_out(basis, block, coefficients, eight(0.0))


@compiled
def _make_fours_orthonormal(block: Groups, triangle: Floats) -> bool:
    return _make_orthonormal(block, triangle, four(0.0))


@compiled
def _make_eights_orthonormal(block: Groups, triangle: Floats) -> bool:
    return _make_orthonormal(block, triangle, eight(0.0))


@compiled
def _squares_fours(block: Groups) -> Floats:
    return squares(block, four(0.0))


@compiled
def _squares_eights(block: Groups) -> Floats:
    return squares(block, eight(0.0))


@compiled
def _make_orthonormal(block: Groups, triangle: Floats, zero: Lanes) -> bool:
    """Make vectors orthonormal; what they were made of is put into `triangle`.

    False where they are too near to dependent, with as much done as could be.
    """
    for _ in range(2):
        gram = np.zeros_like(triangle)
        project(block, block, gram, zero)
        sizes = np.sqrt(np.diag(gram))
        if not sizes.min() > 0:
            return False
        factor = _cholesky(gram / np.outer(sizes, sizes))
        least = np.diag(factor).min()
        if least < _DEPENDENT:
            return False
        combine(_inverse(factor) / sizes, block, zero)
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


@compiled
def _take_out(basis: Groups, block: Groups, coefficients: Floats, zero: Lanes) -> None:
    """Take the span of the basis out of `block`, and add what that was to `coefficients`."""
    taken = np.empty_like(coefficients)
    for _ in range(2):
        taken[:] = 0.0
        project(basis, block, taken, zero)
        subtract(basis, taken, block, zero)
        coefficients += taken
        # Twice is enough (Kahan, Parlett), and once where little cancelled. What was taken is
        # orthogonal to what is left, so that their squares add up to those before.
        left = squares(block, zero)
        if (left >= _CANCELLED**2 * (left + (taken**2).sum(axis=0))).all():
            break
