"""Products of many long vectors with few, one a row: taken together, and taken from each other.

Tall and narrow products leave a matrix library waiting for memory. These kernels take four vectors
by four, whose sums fit into registers, and read the many once a pass: as fast as they can be read.
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

_STRIP, LANES = 3072, 8
"""Numbers of the few that are worked on at a time and stay in the cache; of a register."""


@compiled
def squares(rows: Floats) -> Floats:
    """Sums of squares of the rows, shape (b,)."""
    sums = np.empty(len(rows))
    for q in range(len(rows)):
        sums[q] = _product(rows[q], rows[q])
    return sums


@compiled
def _product(one: Floats, other: Floats) -> float:
    """Sum of products."""
    full, zero = len(one) - len(one) % LANES, eight(0.0)
    a, b, i = zero, zero, 0
    while i + 2 * LANES <= full:
        a = added_product(a, load(zero, one, i), load(zero, other, i))
        b = added_product(b, load(zero, one, i + LANES), load(zero, other, i + LANES))
        i += 2 * LANES
    if i < full:
        a = added_product(a, load(zero, one, i), load(zero, other, i))
    sum_so_far = total(added(a, b))
    for j in range(full, len(one)):
        sum_so_far += one[j] * other[j]
    return sum_so_far


@compiled
def project(basis: Floats, block: Floats, coefficients: Floats) -> None:
    """Add basis·blockᵀ to `coefficients`, in tiles of four vectors by four, strip by strip.

    A strip of the basis is read once for all of the block, which stays in the cache.
    """
    tiled, tiled_block = len(basis) - len(basis) % 4, len(block) - len(block) % 4
    n = basis.shape[1]
    full, length = n - n % LANES, _strip_length(block)
    sums = np.zeros(tiled * tiled_block * LANES)
    vectors = (basis.reshape(-1), block.reshape(-1), n)
    for begin in range(0, full, length):
        end = min(begin + length, full)
        for m in range(0, tiled, 4):
            for q in range(0, tiled_block, 4):
                places = (m * n + begin, q * n + begin, end - begin)
                ahead = _ahead((m, q), (tiled, tiled_block), n, length)
                place = (m * tiled_block + 4 * q) * LANES
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
    return max(_STRIP // max(len(block), 4) // LANES, 1) * LANES


@compiled
def _ahead(tile: tuple[int, int], tiles: tuple[int, int], n: int, length: int) -> tuple[int, int]:
    """How far on in memory vectors lie that come after this tile's, and how many are to be read.

    The processor is told while it still works on those at hand, and need not wait for them. The
    next four are shared out among the tiles that have these, since not many reads wait at a time.
    """
    (m, q), (n_basis, n_block) = tile, tiles
    n_each = -(-4 // (n_block // 4))
    first = n_each * (q // 4)
    if first >= 4:
        return 0, 0
    return (4 * n if m + 4 < n_basis else length - m * n) + first * n, n_each


@compiled
def _project_tile(
    vectors: tuple[Floats, Floats, int],
    places: tuple[int, int, int],
    ahead: tuple[int, int],
    sums: Floats,
    place: int,
) -> None:
    """Add four vectors' products with four others to sixteen registers' worth of sums."""
    numbers, others, n = vectors
    (i, k, length), (distance, n_each) = places, ahead
    zero = eight(0.0)
    a0, a1, a2, a3 = zero, zero, zero, zero
    b0, b1, b2, b3 = zero, zero, zero, zero
    c0, c1, c2, c3 = zero, zero, zero, zero
    d0, d1, d2, d3 = zero, zero, zero, zero
    for _ in range(0, length, LANES):
        _prefetch_some(numbers, i + distance, n, n_each)
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
        i, k = i + LANES, k + LANES
    _add_four(sums, place, (a0, a1, a2, a3))
    _add_four(sums, place + 4 * LANES, (b0, b1, b2, b3))
    _add_four(sums, place + 8 * LANES, (c0, c1, c2, c3))
    _add_four(sums, place + 12 * LANES, (d0, d1, d2, d3))


@compiled
def _prefetch_some(numbers: Floats, place: int, apart: int, count: int) -> None:
    """Of one, two or four vectors, or none."""
    if count > 0:
        prefetch(numbers, place)
    if count > 1:
        prefetch(numbers, place + apart)
    if count > 2:
        prefetch(numbers, place + 2 * apart)
        prefetch(numbers, place + 3 * apart)


@compiled
def _add_four(sums: Floats, place: int, lanes: tuple[Lanes, Lanes, Lanes, Lanes]) -> None:
    for part in lanes:
        store(added(load(part, sums, place), part), sums, place)
        place += LANES


@compiled
def _add_tiles(sums: Floats, coefficients: Floats) -> None:
    """Add up the lanes of sums, sixteen a tile, and add these to the coefficients."""
    zero, place = eight(0.0), 0
    for m in range(0, len(coefficients), 4):
        for q in range(0, coefficients.shape[1], 4):
            for entry in range(16):
                coefficients[m + entry // 4, q + entry % 4] += total(load(zero, sums, place))
                place += LANES


@compiled
def subtract(basis: Floats, coefficients: Floats, block: Floats) -> None:
    """Take coefficientsᵀ·basis out of `block`, a strip at a time that stays in the cache."""
    n = basis.shape[1]
    full, length = n - n % LANES, _strip_length(block)
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
    ahead: tuple[int, int],
    coefficients: Floats,
    tile: tuple[int, int],
) -> None:
    """Take four vectors' parts out of four others, along a strip of whole registers."""
    numbers, others, n = vectors
    (i, k, length), (m, q), (distance, n_each) = places, tile, ahead
    a0, a1, a2, a3 = _minus_four(coefficients, m, q)
    b0, b1, b2, b3 = _minus_four(coefficients, m + 1, q)
    c0, c1, c2, c3 = _minus_four(coefficients, m + 2, q)
    d0, d1, d2, d3 = _minus_four(coefficients, m + 3, q)
    for _ in range(0, length, LANES):
        _prefetch_some(numbers, i + distance, n, n_each)
        v0, v1 = load(a0, numbers, i), load(a0, numbers, i + n)
        v2, v3 = load(a0, numbers, i + 2 * n), load(a0, numbers, i + 3 * n)
        _take_four(others, k, (v0, v1, v2, v3), (a0, b0, c0, d0))
        _take_four(others, k + n, (v0, v1, v2, v3), (a1, b1, c1, d1))
        _take_four(others, k + 2 * n, (v0, v1, v2, v3), (a2, b2, c2, d2))
        _take_four(others, k + 3 * n, (v0, v1, v2, v3), (a3, b3, c3, d3))
        i, k = i + LANES, k + LANES


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
