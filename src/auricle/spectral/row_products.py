"""Products of a sparse symmetric matrix with many vectors, one a row, and what they say of them."""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from auricle.arrays import Floats, PerMode
from auricle.compiled import compiled
from auricle.spectral.lanes import (
    Lanes,
    added_multiple,
    added_product,
    eight,
    four,
    load,
    store,
    subtracted,
    width,
)
from auricle.spectral.side_by_side import set_side_by_side

Entries: TypeAlias = tuple[NDArray[np.int32], NDArray[np.int32], Floats]
"""Where each column begins, rows of its entries, and these: as a compressed matrix holds them."""
_NARROW, _WIDE = 4, 8
"""Vectors that are multiplied at a time: entries of that many lie side by side."""


def row_products(matrix: sparse.csc_array, rows: Floats) -> Floats:
    """The matrix times each of the rows, shape (b, n) as they are.

    Parameters
    ----------
    matrix
        Symmetric, both triangles stored, shape (n, n).
    rows
        Shape (b, n).

    Examples
    --------
    >>> swap = sparse.csc_array(np.array([[0.0, 1.0], [1.0, 0.0]]))
    >>> row_products(swap, np.array([[3.0, 4.0]])).tolist()
    [[4.0, 3.0]]
    """
    products = np.empty(rows.shape)
    entries = (matrix.indptr, matrix.indices, matrix.data)
    for first in range(0, len(rows), _WIDE):
        some = slice(first, first + _WIDE)
        if len(rows[some]) <= _NARROW:
            _four_products(entries, rows[some], products[some])
        else:
            _eight_products(entries, rows[some], products[some])
    return products


def row_quotients(
    matrix: sparse.csc_array, rows: Floats, guesses: PerMode
) -> tuple[PerMode, PerMode]:
    """Rayleigh quotients of rows, and norms of what the matrix makes of them beyond, shape (b,).

    Parameters
    ----------
    matrix
        Symmetric, both triangles stored, shape (n, n).
    rows
        Shape (b, n).
    guesses
        Of the quotients, shape (b,); what is beyond is right to rounding of what is beyond these.

    Examples
    --------
    >>> swap = sparse.csc_array(np.array([[0.0, 1.0], [1.0, 0.0]]))
    >>> values, norms = row_quotients(swap, np.array([[3.0, 3.0], [1.0, 0.0]]), np.zeros(2))
    >>> values.tolist(), norms.tolist()
    ([1.0, 0.0], [0.0, 1.0])
    """
    values, norms = np.empty(len(rows)), np.empty(len(rows))
    entries = (matrix.indptr, matrix.indices, matrix.data)
    for first in range(0, len(rows), _WIDE):
        some = slice(first, first + _WIDE)
        beyond, beside, sizes = _sums_beyond(entries, rows[some], guesses[some])
        sizes = np.where(sizes > 0, sizes, 1.0)
        values[some] = guesses[some] + beside / sizes
        norms[some] = np.sqrt(np.maximum(beyond - beside**2 / sizes, 0.0))
    return values, norms


@compiled
def _sums_beyond(entries: Entries, rows: Floats, guesses: PerMode) -> tuple[Floats, Floats, Floats]:
    """Of each row x and y = matrix·x − guess·x, up to eight: y·y, x·y and x·x."""
    starts, neighbours, data = entries
    count, n = rows.shape
    zero, columns, room = eight(0.0), np.zeros(n * _WIDE), np.zeros(4 * _WIDE)
    set_side_by_side(rows, columns, _WIDE)
    room[:count] = guesses
    guess, beyond, beside, sizes = load(zero, room, 0), zero, zero, zero
    for i in range(n):
        total, own = zero, load(zero, columns, i * _WIDE)
        for e in range(starts[i], starts[i + 1]):
            total = added_multiple(total, data, e, load(zero, columns, neighbours[e] * _WIDE))
        total = subtracted(total, added_product(zero, guess, own))
        beyond = added_product(beyond, total, total)
        beside, sizes = added_product(beside, total, own), added_product(sizes, own, own)
    store(beyond, room, _WIDE)
    store(beside, room, 2 * _WIDE)
    store(sizes, room, 3 * _WIDE)
    sums = room.reshape((4, _WIDE))
    return sums[1, :count].copy(), sums[2, :count].copy(), sums[3, :count].copy()


@compiled
def _four_products(entries: Entries, rows: Floats, products: Floats) -> None:
    _products(entries, rows, products, four(0.0))


@compiled
def _eight_products(entries: Entries, rows: Floats, products: Floats) -> None:
    _products(entries, rows, products, eight(0.0))


@compiled
def _products(entries: Entries, rows: Floats, products: Floats, zero: Lanes) -> None:
    starts, neighbours, data = entries
    n_rows, n = rows.shape
    lanes = width(zero)
    columns, sums = np.zeros(n * lanes), np.empty(lanes)
    set_side_by_side(rows, columns, lanes)
    for i in range(n):
        total = zero
        for e in range(starts[i], starts[i + 1]):
            total = added_multiple(total, data, e, load(zero, columns, neighbours[e] * lanes))
        store(total, sums, 0)
        for j in range(n_rows):
            products[j, i] = sums[j]
