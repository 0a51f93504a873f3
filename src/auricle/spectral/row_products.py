"""Products of a sparse symmetric matrix with many vectors, one a row, and what they say of them."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from auricle.arrays import Floats, PerMode
from auricle.compiled import compiled, compiled_inline
from auricle.spectral.lanes import (
    added_multiple,
    added_product,
    eight,
    load,
    store,
    subtracted,
    width,
    zeros,
)
from auricle.spectral.side_by_side import set_side_by_side

Entries: TypeAlias = tuple[NDArray[np.int32], NDArray[np.int32], Floats]
"""Where each column begins, rows of its entries, and these: as a compressed matrix holds them."""
_NARROW, _WIDE = 4, 8
"""Vectors that are multiplied at a time: entries of that many lie side by side."""
_STRIP = 2_048
"""Numbers of all vectors that are worked on at a time and stay in the cache."""


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
        lanes = _NARROW if len(rows[some]) <= _NARROW else _WIDE
        _products(entries, rows[some], products[some], (0.0,) * lanes)
    return products


@dataclass(frozen=True, eq=False)
class RowQuotients:
    """What a symmetric matrix A makes of rows x, each shape (b,).

    Attributes
    ----------
    values
        Rayleigh quotients μ = x·A·x / x·x.
    norms, scaled_norms
        Of what is beyond these, A·x − μ·x, and of that times a diagonal scaling S.
    stretched
        Norms of S⁻¹·x.
    """

    values: PerMode
    norms: PerMode
    scaled_norms: PerMode
    stretched: PerMode


def row_quotients(
    matrix: sparse.csc_array, rows: Floats, guesses: PerMode, scaling: Floats
) -> RowQuotients:
    """Rayleigh quotients of rows, and the size of what the matrix makes of them beyond.

    Parameters
    ----------
    matrix
        Symmetric, both triangles stored, shape (n, n).
    rows
        Shape (b, n).
    guesses
        Of the quotients, shape (b,); what is beyond is right to rounding of what is beyond these.
    scaling
        The diagonal of S, positive, shape (n,).

    Examples
    --------
    >>> swap = sparse.csc_array(np.array([[0.0, 1.0], [1.0, 0.0]]))
    >>> rows, scaling = np.array([[3.0, 3.0], [1.0, 0.0]]), np.array([1.0, 0.5])
    >>> found = row_quotients(swap, rows, np.zeros(2), scaling)
    >>> found.values.tolist(), found.norms.tolist(), found.scaled_norms.tolist()
    ([1.0, 0.0], [0.0, 1.0], [0.0, 0.5])
    """
    columns = _columns(rows)
    entries = (matrix.indptr, matrix.indices, matrix.data)
    room = np.zeros(columns.shape[1])
    room[: len(rows)] = guesses
    weights = np.stack([scaling**2, scaling**-2])
    sums = _sums_beyond(entries, columns, room, weights)[:, : len(rows)]
    excess = sums[1] / np.where(sums[2] > 0, sums[2], 1.0)
    return RowQuotients(
        guesses + excess,
        _norms_less(excess, sums[0], sums[1], sums[2]),
        _norms_less(excess, sums[3], sums[4], sums[5]),
        np.sqrt(sums[6]),
    )


def _columns(rows: Floats) -> Floats:
    """Rows as columns, entries of all at one place side by side; at least eight, the others 0."""
    if len(rows) >= _WIDE and rows.strides[0] == rows.itemsize:
        return rows.T
    columns = np.zeros((rows.shape[1], max(len(rows), _WIDE)))
    columns[:, : len(rows)] = rows.T
    return columns


def _norms_less(excess: PerMode, beyond: PerMode, beside: PerMode, own: PerMode) -> PerMode:
    """Norms of y − excess·x, from y·y, x·y and x·x."""
    norms: PerMode = np.sqrt(np.maximum(beyond - excess * (2 * beside - excess * own), 0.0))
    return norms


@compiled
def _sums_beyond(entries: Entries, columns: Floats, guesses: PerMode, weights: Floats) -> Floats:
    """Of each column x and y = matrix·x − guess·x, eight or more, seven sums, shape (7, b).

    They are y·y, x·y and x·x, the same with the first weights, and x·x with the second. Columns
    are gone down together, strip by strip: neighbours' entries are near by then.
    """
    n, count = columns.shape
    step = columns.strides[0] // columns.itemsize
    n_eights, length = -(-count // _WIDE), max(_STRIP // count, 1)
    sums, room = np.zeros((7, count)), np.zeros((n_eights, 7 * _WIDE))
    for begin in range(0, n, length):
        some = (begin, min(begin + length, n))
        for k in range(n_eights):
            first = min(k * _WIDE, count - _WIDE)
            _add_sums(entries, (columns, step, first), guesses, weights, some, room[k])
    for k in range(n_eights):
        first = min(k * _WIDE, count - _WIDE)
        sums[:, first : first + _WIDE] = room[k].reshape((7, _WIDE))
    return sums


@compiled_inline
def _add_sums(
    entries: Entries,
    eights: tuple[Floats, int, int],
    guesses: PerMode,
    weights: Floats,
    some: tuple[int, int],
    sums: Floats,
) -> None:
    """Add to the sums what some rows of the matrix give for eight columns."""
    starts, neighbours, data = entries
    columns, step, first = eights
    zero = eight(0.0)
    guess, less, more = load(zero, guesses, first), weights[0], weights[1]
    a, b, c = load(zero, sums, 0), load(zero, sums, _WIDE), load(zero, sums, 2 * _WIDE)
    d, e = load(zero, sums, 3 * _WIDE), load(zero, sums, 4 * _WIDE)
    f, g = load(zero, sums, 5 * _WIDE), load(zero, sums, 6 * _WIDE)
    for i in range(some[0], some[1]):
        y, x = zero, load(zero, columns, i * step + first)
        for j in range(starts[i], starts[i + 1]):
            y = added_multiple(y, data, j, load(zero, columns, neighbours[j] * step + first))
        y = subtracted(y, added_product(zero, guess, x))
        a, b, c = added_product(a, y, y), added_product(b, x, y), added_product(c, x, x)
        small_y, small_x = added_multiple(zero, less, i, y), added_multiple(zero, less, i, x)
        d, e = added_product(d, small_y, y), added_product(e, small_x, y)
        f, g = added_product(f, small_x, x), added_product(g, added_multiple(zero, more, i, x), x)
    for k, found in enumerate((a, b, c, d, e, f, g)):
        store(found, sums, k * _WIDE)


@compiled
def _products(entries: Entries, rows: Floats, products: Floats, like: tuple[float, ...]) -> None:
    zero = zeros(like)
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
