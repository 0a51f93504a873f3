"""Products of a sparse symmetric matrix with many vectors, one a row."""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from auricle.arrays import Floats
from auricle.compiled import compiled
from auricle.spectral.lanes import Lanes, added_multiple, eight, four, load, store, width

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
    rows = np.ascontiguousarray(rows, dtype=np.float64)
    entries = (matrix.indptr, matrix.indices, matrix.data)
    for first in range(0, len(rows), _WIDE):
        some = slice(first, first + _WIDE)
        if len(rows[some]) <= _NARROW:
            _four_products(entries, rows[some], products[some])
        else:
            _eight_products(entries, rows[some], products[some])
    return products


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
    for i in range(n):
        for j in range(n_rows):
            columns[i * lanes + j] = rows[j, i]
    for i in range(n):
        total = zero
        for e in range(starts[i], starts[i + 1]):
            total = added_multiple(total, data, e, load(zero, columns, neighbours[e] * lanes))
        store(total, sums, 0)
        for j in range(n_rows):
            products[j, i] = sums[j]
