"""Inner products of many long vectors with each other where only some are wanted, tile by tile.

A matrix library multiplies whole ranges, and narrow ones slowly. Near the diagonal eight vectors
with eight others are as many as are wanted, and what keeps a processor's registers busy.
"""

import numpy as np
from numpy.typing import NDArray

from auricle.arrays import Floats, Integers
from auricle.compiled import compiled, compiled_inline
from auricle.spectral.lanes import added_multiple, eight, load, prefetch, store
from auricle.spectral.workers import Workers

TILE = 8
"""Vectors of a tile, each way."""
_STRIP = 65_536
"""Numbers of the vectors that are worked on at a time and stay in the cache."""


def tiles(count: int) -> Integers:
    """So many vectors in tiles of eight, shape (t, 8), the last two overlapping if they must.

    One tile of all of them where they are fewer than eight.

    Examples
    --------
    >>> tiles(18)[:, 0].tolist(), tiles(3).tolist()
    ([0, 8, 10], [[0, 1, 2]])
    """
    width = min(count, TILE)
    first = np.minimum(np.arange(0, count, TILE), count - width)
    return first[:, None] + np.arange(width)


def fill_products(
    rows: Floats, wanted: NDArray[np.bool_], products: Floats, workers: Workers
) -> None:
    """Set some of the inner products of all rows.

    Parameters
    ----------
    rows
        Shape (k, n), at their fastest where the entries of all rows at one place lie side by side.
    wanted
        Of which `tiles` of rows with which others, shape (t, t).
    products
        Shape (k, k); what is not wanted is left.
    workers
        Who share the work; the digits do not depend on them.
    """
    if len(rows) < TILE:
        products[:] = rows @ rows.T
        return
    entries = rows.T if rows.strides[0] == rows.itemsize else np.ascontiguousarray(rows.T)
    places = tiles(len(rows))[:, 0][np.argwhere(wanted)]
    # Each part reads its own columns, once: more parts would share more of them.
    parts = [part for part in np.array_split(places, workers.threads) if len(part)]
    workers.each(lambda part: _fill(entries, part, products), parts)


@compiled
def _fill(entries: Floats, places: Integers, products: Floats) -> None:
    """Set the products of the eight columns from places[i, 0] on with those from places[i, 1]."""
    n, step = len(entries), entries.strides[0] // entries.itemsize
    sums = np.zeros((len(places), TILE * TILE))
    columns = (places.min(), places.max() + TILE)
    length = max(_STRIP // (columns[1] - columns[0]), 1)
    for begin in range(0, n, length):
        end = min(begin + length, n)
        _ask_for(entries, columns, end, min(end + length, n))
        for i in range(len(places)):
            _add(entries, (begin * step, step, end - begin), places[i], sums[i])
    for i in range(len(places)):
        row, column = places[i]
        for j in range(TILE * TILE):
            products[row + j // TILE, column + j % TILE] = sums[i, j]


@compiled
def _ask_for(entries: Floats, columns: tuple[int, int], begin: int, end: int) -> None:
    """Have some columns of the next strip brought near, line by line of the cache."""
    step = entries.strides[0] // entries.itemsize
    for i in range(begin, end):
        for j in range(columns[0], columns[1], TILE):
            prefetch(entries, i * step + j)


@compiled_inline
def _add(entries: Floats, strip: tuple[int, int, int], place: Integers, sums: Floats) -> None:
    """Add a strip's products of eight columns with eight to as many registers of sums."""
    begin, step, count = strip
    zero = eight(0.0)
    a, b, c, d = (
        load(zero, sums, 0),
        load(zero, sums, 8),
        load(zero, sums, 16),
        load(zero, sums, 24),
    )
    e, f = load(zero, sums, 32), load(zero, sums, 40)
    g, h = load(zero, sums, 48), load(zero, sums, 56)
    p, q = begin + place[0], begin + place[1]
    for _ in range(count):
        x = load(zero, entries, q)
        a, b = added_multiple(a, entries, p, x), added_multiple(b, entries, p + 1, x)
        c, d = added_multiple(c, entries, p + 2, x), added_multiple(d, entries, p + 3, x)
        e, f = added_multiple(e, entries, p + 4, x), added_multiple(f, entries, p + 5, x)
        g, h = added_multiple(g, entries, p + 6, x), added_multiple(h, entries, p + 7, x)
        p, q = p + step, q + step
    for i, found in enumerate((a, b, c, d, e, f, g, h)):
        store(found, sums, i * TILE)
