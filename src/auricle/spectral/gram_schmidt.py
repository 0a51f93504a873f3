"""Gram-Schmidt for blocks: columns made orthogonal to a basis, and to each other.

Tall and narrow products leave a matrix library waiting for memory. These kernels take four vectors
by four, whose sums fit into registers, and read the basis once a pass: as fast as it can be read.
"""

import numpy as np

from auricle.arrays import Floats
from auricle.compiled import compiled
from auricle.spectral.lanes import Lanes, added, added_product, eight, load, store, total

_STRIP, _LANES = 2048, 8
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


def orthonormal(block: Floats) -> tuple[Floats, Floats]:
    """Orthonormal rows and a lower triangle with block = triangle·rows.

    Cholesky's factor of the Gram matrix, once more where that was far from the identity;
    Householder's method where the rows are too near to dependent for that.
    """
    rows, triangle = block, np.eye(len(block))
    for _ in range(2):
        gram = np.zeros((len(rows), len(rows)))
        _project(rows, rows, gram)
        sizes = np.sqrt(np.diag(gram))
        if not sizes.all():
            return _by_householder(block)
        try:
            factor = np.linalg.cholesky(gram / np.outer(sizes, sizes))
        except np.linalg.LinAlgError:
            return _by_householder(block)
        least = np.diag(factor).min()
        if least < _DEPENDENT:
            return _by_householder(block)
        rows, triangle = (
            (np.linalg.inv(factor) / sizes) @ rows,
            triangle @ (sizes[:, None] * factor),
        )
        if least > _INDEPENDENT:
            break
    return rows, triangle


def _by_householder(block: Floats) -> tuple[Floats, Floats]:
    columns, triangle = np.linalg.qr(block.T)
    return np.ascontiguousarray(columns.T), triangle.T


@compiled
def _take_out(basis: Floats, block: Floats, coefficients: Floats) -> None:
    """Take the span of the basis out of `block`, and add what that was to `coefficients`."""
    before, taken = _squares(block), np.empty_like(coefficients)
    for _ in range(2):
        taken[:] = 0.0
        _project(basis, block, taken)
        _subtract(basis, taken, block)
        coefficients += taken
        # Twice is enough (Kahan, Parlett), and once where little cancelled.
        if (_squares(block) >= _CANCELLED**2 * before).all():
            break


@compiled
def _squares(rows: Floats) -> Floats:
    squares = np.empty(len(rows))
    for q in range(len(rows)):
        squares[q] = _product(rows[q], rows[q])
    return squares


@compiled
def _product(one: Floats, other: Floats) -> float:
    """Sum of products."""
    full, zero = len(one) - len(one) % _LANES, eight(0.0)
    a, b, i = zero, zero, 0
    while i + 2 * _LANES <= full:
        a = added_product(a, load(zero, one, i), load(zero, other, i))
        b = added_product(b, load(zero, one, i + _LANES), load(zero, other, i + _LANES))
        i += 2 * _LANES
    if i < full:
        a = added_product(a, load(zero, one, i), load(zero, other, i))
    sum_so_far = total(added(a, b))
    for j in range(full, len(one)):
        sum_so_far += one[j] * other[j]
    return sum_so_far


@compiled
def _project(basis: Floats, block: Floats, coefficients: Floats) -> None:
    """Add basis·blockᵀ to `coefficients`, in tiles of four vectors by four, strip by strip.

    A strip of the basis is read once for all of the block, which stays in the cache.
    """
    tiled, tiled_block = len(basis) - len(basis) % 4, len(block) - len(block) % 4
    n = basis.shape[1]
    for begin in range(0, n, _STRIP):
        strip = (begin, min(begin + _STRIP, n))
        for m in range(0, tiled, 4):
            for q in range(0, tiled_block, 4):
                _project_tile(basis, m, block, q, strip, coefficients)
    for m in range(len(basis)):
        for q in range(tiled_block if m < tiled else 0, len(block)):
            coefficients[m, q] += _product(basis[m], block[q])


@compiled
def _project_tile(
    basis: Floats, m: int, block: Floats, q: int, strip: tuple[int, int], coefficients: Floats
) -> None:
    """Four vectors' inner products with four others: sixteen registers' worth of sums."""
    n = basis.shape[1]
    numbers, others = basis.reshape(-1), block.reshape(-1)
    full = strip[1] - (strip[1] - strip[0]) % _LANES
    zero = eight(0.0)
    a0, a1, a2, a3 = zero, zero, zero, zero
    b0, b1, b2, b3 = zero, zero, zero, zero
    c0, c1, c2, c3 = zero, zero, zero, zero
    d0, d1, d2, d3 = zero, zero, zero, zero
    for i in range(strip[0], full, _LANES):
        x0, x1 = load(zero, others, q * n + i), load(zero, others, (q + 1) * n + i)
        x2, x3 = load(zero, others, (q + 2) * n + i), load(zero, others, (q + 3) * n + i)
        a, b = load(zero, numbers, m * n + i), load(zero, numbers, (m + 1) * n + i)
        c, d = load(zero, numbers, (m + 2) * n + i), load(zero, numbers, (m + 3) * n + i)
        a0, a1 = added_product(a0, a, x0), added_product(a1, a, x1)
        a2, a3 = added_product(a2, a, x2), added_product(a3, a, x3)
        b0, b1 = added_product(b0, b, x0), added_product(b1, b, x1)
        b2, b3 = added_product(b2, b, x2), added_product(b3, b, x3)
        c0, c1 = added_product(c0, c, x0), added_product(c1, c, x1)
        c2, c3 = added_product(c2, c, x2), added_product(c3, c, x3)
        d0, d1 = added_product(d0, d, x0), added_product(d1, d, x1)
        d2, d3 = added_product(d2, d, x2), added_product(d3, d, x3)
    _add_row(coefficients[m], q, (total(a0), total(a1), total(a2), total(a3)))
    _add_row(coefficients[m + 1], q, (total(b0), total(b1), total(b2), total(b3)))
    _add_row(coefficients[m + 2], q, (total(c0), total(c1), total(c2), total(c3)))
    _add_row(coefficients[m + 3], q, (total(d0), total(d1), total(d2), total(d3)))
    for k in range(full, strip[1]):
        for i in range(4):
            for j in range(4):
                coefficients[m + i, q + j] += basis[m + i, k] * block[q + j, k]


@compiled
def _add_row(row: Floats, first: int, numbers: tuple[float, float, float, float]) -> None:
    for j in range(4):
        row[first + j] += numbers[j]


@compiled
def _subtract(basis: Floats, coefficients: Floats, block: Floats) -> None:
    """Take coefficientsᵀ·basis out of `block`, a strip at a time that stays in the cache."""
    n = basis.shape[1]
    tiled, tiled_block = len(basis) - len(basis) % 4, len(block) - len(block) % 4
    for begin in range(0, n, _STRIP):
        end = min(begin + _STRIP, n)
        full = end - (end - begin) % _LANES
        for m in range(0, tiled, 4):
            for q in range(0, tiled_block, 4):
                _subtract_tile(basis, m, coefficients, block, q, (begin, full))
        for m in range(len(basis)):
            first = tiled_block if m < tiled else 0
            _subtract_plainly(basis, m, coefficients, block, first, (begin, end))
            if m < tiled:
                _subtract_plainly(basis, m, coefficients, block[:tiled_block], 0, (full, end))


@compiled
def _subtract_tile(
    basis: Floats, m: int, coefficients: Floats, block: Floats, q: int, strip: tuple[int, int]
) -> None:
    """Take four vectors' parts out of four others, along a strip of whole registers."""
    n = basis.shape[1]
    numbers, others = basis.reshape(-1), block.reshape(-1)
    a, b, c, d = coefficients[m], coefficients[m + 1], coefficients[m + 2], coefficients[m + 3]
    a0, a1, a2, a3 = eight(-a[q]), eight(-a[q + 1]), eight(-a[q + 2]), eight(-a[q + 3])
    b0, b1, b2, b3 = eight(-b[q]), eight(-b[q + 1]), eight(-b[q + 2]), eight(-b[q + 3])
    c0, c1, c2, c3 = eight(-c[q]), eight(-c[q + 1]), eight(-c[q + 2]), eight(-c[q + 3])
    d0, d1, d2, d3 = eight(-d[q]), eight(-d[q + 1]), eight(-d[q + 2]), eight(-d[q + 3])
    for i in range(strip[0], strip[1], _LANES):
        v0, v1 = load(a0, numbers, m * n + i), load(a0, numbers, (m + 1) * n + i)
        v2, v3 = load(a0, numbers, (m + 2) * n + i), load(a0, numbers, (m + 3) * n + i)
        _take_four(others, q * n + i, (v0, v1, v2, v3), (a0, b0, c0, d0))
        _take_four(others, (q + 1) * n + i, (v0, v1, v2, v3), (a1, b1, c1, d1))
        _take_four(others, (q + 2) * n + i, (v0, v1, v2, v3), (a2, b2, c2, d2))
        _take_four(others, (q + 3) * n + i, (v0, v1, v2, v3), (a3, b3, c3, d3))


@compiled
def _take_four(
    others: Floats,
    place: int,
    vectors: tuple[Lanes, Lanes, Lanes, Lanes],
    factors: tuple[Lanes, Lanes, Lanes, Lanes],
) -> None:
    x = added_product(load(vectors[0], others, place), vectors[0], factors[0])
    x = added_product(added_product(x, vectors[1], factors[1]), vectors[2], factors[2])
    store(added_product(x, vectors[3], factors[3]), others, place)


@compiled
def _subtract_plainly(
    basis: Floats, m: int, coefficients: Floats, block: Floats, first: int, strip: tuple[int, int]
) -> None:
    """Take one vector's part out of those from `first` on, along a strip."""
    for q in range(first, len(block)):
        for i in range(strip[0], strip[1]):
            block[q, i] -= basis[m, i] * coefficients[m, q]
