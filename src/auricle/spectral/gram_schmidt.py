"""Gram-Schmidt for blocks: vectors made orthogonal to a basis, and to each other.

Vectors are in groups, as `auricle.spectral.narrow_products` takes them.
"""

from typing import NamedTuple

import numpy as np

from auricle.arrays import Floats
from auricle.compiled import compiled
from auricle.spectral.lanes import zeros
from auricle.spectral.narrow_products import Groups, combine, project, subtract_and_measure

_CANCELLED = 1e-3
_DEPENDENT, _INDEPENDENT = 1e-5, 0.3
"""Of what of a row of length one is not in the span of those before: too little, and enough to be
right to rounding at the first attempt."""


class TakenOut(NamedTuple):
    """What was taken out of a block of vectors, and what that has left.

    Attributes
    ----------
    coefficients
        Of the block in the basis, shape (g·lanes, h·lanes).
    products
        Inner products of the vectors that are left with each other, shape (h·lanes, h·lanes).
    """

    coefficients: Floats
    products: Floats


def orthogonalize(basis: Groups, block: Groups) -> TakenOut:
    """Take out of `block`, in place, what lies in the span of `basis`; returns what that was.

    Parameters
    ----------
    basis
        Orthonormal vectors, and zeros maybe, shape (g, n, lanes); g may be 0.
    block
        Vectors, shape (h, n, lanes), changed in place.

    Examples
    --------
    >>> basis, block = np.zeros((1, 2, 4)), np.zeros((1, 2, 4))
    >>> basis[0, :, 0], block[0, :, 0] = [1.0, 0.0], [3.0, 4.0]
    >>> taken = orthogonalize(basis, block)
    >>> taken.coefficients[0].tolist(), block[0, :, 0].tolist(), float(taken.products[0, 0])
    ([3.0, 0.0, 0.0, 0.0], [0.0, 4.0], 16.0)
    """
    lanes = block.shape[2]
    size = len(block) * lanes
    taken = TakenOut(np.zeros((len(basis) * lanes, size)), np.zeros((size, size)))
    take_out(basis, block, *taken, (0.0,) * lanes)
    return taken


def orthonormalize(block: Groups, products: Floats) -> Floats:
    """Make the vectors of `block` orthonormal, in place; returns what they were made of.

    That is a lower triangle with old vectors = triangle·new vectors: Cholesky's factor of their
    inner products, once more where that was far from the identity; Householder's method where the
    vectors are too near to dependent for that.

    Parameters
    ----------
    block
        Shape (h, n, lanes).
    products
        Inner products of its vectors, shape (h·lanes, h·lanes); used up.

    Examples
    --------
    >>> block = np.array([[[3.0, 4.0, 0.0, 0.0], [0.0, 2.0, 0.0, 0.0], [0, 0, 1, 0], [0, 0, 0, 1]]])
    >>> orthonormalize(block, block[0].T @ block[0])[:2, :2].round(12).tolist()
    [[3.0, 0.0], [4.0, 2.0]]
    >>> block[0, :2, :2].round(12).T.tolist()
    [[1.0, 0.0], [0.0, 1.0]]
    """
    triangle = np.eye(len(products))
    is_made = make_orthonormal(block, products, triangle, (0.0,) * block.shape[2])
    return triangle if is_made else by_householder(block, triangle)


def by_householder(block: Groups, triangle: Floats) -> Floats:
    """Make vectors orthonormal that are near to dependent; returns triangle·what they were of."""
    lanes = block.shape[2]
    columns, upper = np.linalg.qr(np.concatenate(list(block), axis=1))
    for i, group in enumerate(block):
        group[:] = columns[:, i * lanes : (i + 1) * lanes]
    made_of: Floats = triangle @ upper.T
    return made_of


@compiled
def make_orthonormal(
    block: Groups, products: Floats, triangle: Floats, like: tuple[float, ...]
) -> bool:
    """Make vectors orthonormal; `triangle`, a lower one, is multiplied by what they were made of.

    False where they are too near to dependent, with as much done as could be. Here and below `like`
    has as many numbers as there are lanes.
    """
    zero = zeros(like)
    factor = np.zeros_like(triangle)
    for attempt in range(2):
        if attempt > 0:
            products[:] = 0.0
            project(block, block, products, zero)
        least = _fill_cholesky(products, factor)
        if not least >= _DEPENDENT:
            return False
        combine(_inverse(factor), block, zero)
        _multiply_triangle(triangle, factor)
        if least > _INDEPENDENT:
            break
    return True


@compiled
def _fill_cholesky(matrix: Floats, factor: Floats) -> float:
    """Fill the triangle of a small matrix of inner products.

    Returns the least part of a vector's length that is not in the span of those before, the
    diagonal of the triangle over that length; 0 where there is none.
    """
    least = 1.0
    for j in range(len(matrix)):
        for i in range(j, len(matrix)):
            rest = matrix[i, j]
            for k in range(j):
                rest -= factor[i, k] * factor[j, k]
            if i > j:
                factor[i, j] = rest / factor[j, j]
            elif rest > 0:
                factor[j, j] = np.sqrt(rest)
                least = min(least, np.sqrt(rest / matrix[j, j]))
            else:
                return 0.0
    return least


@compiled
def _multiply_triangle(triangle: Floats, factor: Floats) -> None:
    """Turn a small lower triangle into triangle·factor, another one."""
    for i in range(len(triangle)):
        for j in range(i + 1):
            total = 0.0
            for k in range(j, i + 1):
                total += triangle[i, k] * factor[k, j]
            triangle[i, j] = total


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
def take_out(
    basis: Groups, block: Groups, coefficients: Floats, products: Floats, like: tuple[float, ...]
) -> None:
    """Take the span of the basis out of `block`, and add what that was to `coefficients`.

    Sets `products` to the inner products of what is left.
    """
    zero = zeros(like)
    taken = np.empty_like(coefficients)
    for _ in range(2):
        taken[:] = 0.0
        products[:] = 0.0
        project(basis, block, taken, zero)
        subtract_and_measure(basis, taken, block, products, zero)
        coefficients += taken
        # Twice is enough (Kahan, Parlett), and once where little cancelled.
        if not _has_cancelled(taken, products):
            break


@compiled
def _has_cancelled(taken: Floats, products: Floats) -> bool:
    """Whether of some vector next to nothing is left.

    What was taken is orthogonal to what is left, so that their squares add up to those before.
    """
    for i in range(len(products)):
        gone = 0.0
        for k in range(len(taken)):
            gone += taken[k, i] ** 2
        if not products[i, i] >= _CANCELLED**2 * (products[i, i] + gone):
            return True
    return False
