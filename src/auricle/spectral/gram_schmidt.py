"""Gram-Schmidt for blocks: columns made orthogonal to a basis, and to each other.

Tall and narrow products leave a matrix library waiting for memory. These kernels take four vectors
by four, whose sums fit into registers, and read the basis once a pass: as fast as it can be read.
"""

import numpy as np

from auricle.arrays import Floats
from auricle.compiled import compiled
from auricle.spectral.lanes import (
    Lanes,
    added,
    added_product,
    eight,
    load,
    prefetch,
    store,
    total,
)

_STRIP, _LANES = 2048, 8
"""Numbers of a block that are worked on at a time and stay in the cache; of a register."""
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


def add_multiples(block: Floats, factors: Floats, vectors: Floats) -> None:
    """Add factors·vectors to `block` in place: few vectors, one a row, shape (m, n).

    `factors` has shape (b, m), `block` (b, n), contiguous.
    """
    _subtract(vectors, np.ascontiguousarray(-factors.T), block)


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
    for _ in range(2):
        gram = np.zeros((len(block), len(block)))
        _project(block, block, gram)
        sizes = np.sqrt(np.diag(gram))
        factor = _cholesky(gram, sizes)
        if factor is None:
            columns, upper = np.linalg.qr(block.T)
            block[:] = columns.T
            return np.asarray(triangle @ upper.T)
        _multiply_rows(np.linalg.inv(factor) / sizes, block)
        triangle = triangle @ (sizes[:, None] * factor)
        if np.diag(factor).min() > _INDEPENDENT:
            break
    return triangle


def _cholesky(gram: Floats, sizes: Floats) -> Floats | None:
    """Factor of the Gram matrix of rows as if of length one; None where they are dependent."""
    if not sizes.all():
        return None
    try:
        factor = np.asarray(np.linalg.cholesky(gram / np.outer(sizes, sizes)), np.float64)
    except np.linalg.LinAlgError:
        return None
    return factor if np.diag(factor).min() >= _DEPENDENT else None


def aligned_rows(count: int, length: int) -> Floats:
    """Room for so many rows of at least that length: each begins with a line of the cache.

    Reading them takes a fifth less time than where registers straddle two lines.
    """
    stride = length + -length % _LANES
    room = np.empty(count * stride + _LANES)
    first = -(room.ctypes.data // room.itemsize) % _LANES
    return room[first : first + count * stride].reshape(count, stride)


@compiled
def _multiply_rows(triangle: Floats, rows: Floats) -> None:
    """Rows turned into lower triangle·rows."""
    zero, numbers, n = eight(0.0), rows.reshape(-1), rows.shape[1]
    full = n - n % _LANES
    for i in range(0, full, _LANES):
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
    full, length = n - n % _LANES, _strip_length(block)
    sums = np.zeros(tiled * tiled_block * _LANES)
    vectors = (basis.reshape(-1), block.reshape(-1), n)
    for begin in range(0, full, length):
        end = min(begin + length, full)
        for m in range(0, tiled, 4):
            for q in range(0, tiled_block, 4):
                places = (m * n + begin, q * n + begin, end - begin)
                ahead = _ahead((m, q), (tiled, tiled_block), n, length)
                place = (m * tiled_block + 4 * q) * _LANES
                _project_tile(vectors, places, ahead, sums, place)
    _add_tiles(sums, coefficients[:tiled, :tiled_block])
    for m in range(len(basis)):
        for q in range(tiled_block if m < tiled else 0):
            for k in range(full, n):
                coefficients[m, q] += basis[m, k] * block[q, k]
        for q in range(tiled_block if m < tiled else 0, len(block)):
            coefficients[m, q] += _product(basis[m], block[q])


@compiled
def _strip_length(block: Floats) -> int:
    """Whole registers of each row of a block that stay in the cache together."""
    return max(_STRIP // max(len(block), 4) // _LANES, 1) * _LANES


@compiled
def _ahead(tile: tuple[int, int], tiles: tuple[int, int], n: int, length: int) -> int:
    """How far on in memory the vectors lie that come after this tile's; 0 if these remain.

    The processor is told while it still works on those at hand, and need not wait for them.
    """
    (m, q), (n_basis, n_block) = tile, tiles
    if q + 4 < n_block:
        return 0
    return 4 * n if m + 4 < n_basis else length - m * n


@compiled
def _project_tile(
    vectors: tuple[Floats, Floats, int],
    places: tuple[int, int, int],
    ahead: int,
    sums: Floats,
    place: int,
) -> None:
    """Add four vectors' products with four others to sixteen registers' worth of sums."""
    numbers, others, n = vectors
    i, k, length = places
    zero = eight(0.0)
    a0, a1, a2, a3 = zero, zero, zero, zero
    b0, b1, b2, b3 = zero, zero, zero, zero
    c0, c1, c2, c3 = zero, zero, zero, zero
    d0, d1, d2, d3 = zero, zero, zero, zero
    for _ in range(0, length, _LANES):
        if ahead:
            _prefetch_four(numbers, i + ahead, n)
        x0, x1 = load(zero, others, k), load(zero, others, k + n)
        x2, x3 = load(zero, others, k + 2 * n), load(zero, others, k + 3 * n)
        a, b = load(zero, numbers, i), load(zero, numbers, i + n)
        c, d = load(zero, numbers, i + 2 * n), load(zero, numbers, i + 3 * n)
        a0, a1 = added_product(a0, a, x0), added_product(a1, a, x1)
        a2, a3 = added_product(a2, a, x2), added_product(a3, a, x3)
        b0, b1 = added_product(b0, b, x0), added_product(b1, b, x1)
        b2, b3 = added_product(b2, b, x2), added_product(b3, b, x3)
        c0, c1 = added_product(c0, c, x0), added_product(c1, c, x1)
        c2, c3 = added_product(c2, c, x2), added_product(c3, c, x3)
        d0, d1 = added_product(d0, d, x0), added_product(d1, d, x1)
        d2, d3 = added_product(d2, d, x2), added_product(d3, d, x3)
        i, k = i + _LANES, k + _LANES
    _add_four(sums, place, (a0, a1, a2, a3))
    _add_four(sums, place + 4 * _LANES, (b0, b1, b2, b3))
    _add_four(sums, place + 8 * _LANES, (c0, c1, c2, c3))
    _add_four(sums, place + 12 * _LANES, (d0, d1, d2, d3))


@compiled
def _prefetch_four(numbers: Floats, place: int, apart: int) -> None:
    prefetch(numbers, place)
    prefetch(numbers, place + apart)
    prefetch(numbers, place + 2 * apart)
    prefetch(numbers, place + 3 * apart)


@compiled
def _add_four(sums: Floats, place: int, lanes: tuple[Lanes, Lanes, Lanes, Lanes]) -> None:
    for part in lanes:
        store(added(load(part, sums, place), part), sums, place)
        place += _LANES


@compiled
def _add_tiles(sums: Floats, coefficients: Floats) -> None:
    """Add up the lanes of sums, sixteen a tile, and add these to the coefficients."""
    zero, place = eight(0.0), 0
    for m in range(0, len(coefficients), 4):
        for q in range(0, coefficients.shape[1], 4):
            for entry in range(16):
                coefficients[m + entry // 4, q + entry % 4] += total(load(zero, sums, place))
                place += _LANES


@compiled
def _subtract(basis: Floats, coefficients: Floats, block: Floats) -> None:
    """Take coefficientsᵀ·basis out of `block`, a strip at a time that stays in the cache."""
    n = basis.shape[1]
    full, length = n - n % _LANES, _strip_length(block)
    tiled, tiled_block = len(basis) - len(basis) % 4, len(block) - len(block) % 4
    vectors = (basis.reshape(-1), block.reshape(-1), n)
    for begin in range(0, full, length):
        end = min(begin + length, full)
        for m in range(0, tiled, 4):
            for q in range(0, tiled_block, 4):
                places = (m * n + begin, q * n + begin, end - begin)
                ahead = _ahead((m, q), (tiled, tiled_block), n, length)
                _subtract_tile(vectors, places, ahead, coefficients, (m, q))
        for m in range(tiled if tiled_block == len(block) else 0, len(basis)):
            first = tiled_block if m < tiled else 0
            _subtract_plainly(basis, m, coefficients, block, first, (begin, end))
    for m in range(len(basis) if full < n else 0):
        _subtract_plainly(basis, m, coefficients, block, 0, (full, n))


@compiled
def _subtract_tile(
    vectors: tuple[Floats, Floats, int],
    places: tuple[int, int, int],
    ahead: int,
    coefficients: Floats,
    tile: tuple[int, int],
) -> None:
    """Take four vectors' parts out of four others, along a strip of whole registers."""
    numbers, others, n = vectors
    (i, k, length), (m, q) = places, tile
    a0, a1, a2, a3 = _minus_four(coefficients, m, q)
    b0, b1, b2, b3 = _minus_four(coefficients, m + 1, q)
    c0, c1, c2, c3 = _minus_four(coefficients, m + 2, q)
    d0, d1, d2, d3 = _minus_four(coefficients, m + 3, q)
    for _ in range(0, length, _LANES):
        if ahead:
            _prefetch_four(numbers, i + ahead, n)
        v0, v1 = load(a0, numbers, i), load(a0, numbers, i + n)
        v2, v3 = load(a0, numbers, i + 2 * n), load(a0, numbers, i + 3 * n)
        _take_four(others, k, (v0, v1, v2, v3), (a0, b0, c0, d0))
        _take_four(others, k + n, (v0, v1, v2, v3), (a1, b1, c1, d1))
        _take_four(others, k + 2 * n, (v0, v1, v2, v3), (a2, b2, c2, d2))
        _take_four(others, k + 3 * n, (v0, v1, v2, v3), (a3, b3, c3, d3))
        i, k = i + _LANES, k + _LANES


@compiled
def _minus_four(coefficients: Floats, m: int, q: int) -> tuple[Lanes, Lanes, Lanes, Lanes]:
    a, b = eight(-coefficients[m, q]), eight(-coefficients[m, q + 1])
    return a, b, eight(-coefficients[m, q + 2]), eight(-coefficients[m, q + 3])


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
        factor = coefficients[m, q]
        for i in range(strip[0], strip[1]):
            block[q, i] -= basis[m, i] * factor
