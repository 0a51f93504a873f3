"""Many nearly orthonormal rows made orthonormal, and how far from that they are."""

from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats
from auricle.spectral.workers import Workers, slices

_NEIGHBOURS = 96
"""Rows before and after each that it departs from orthogonal to by more than to others."""
_ORTHONORMAL = 5e-11
"""Departure from orthonormality that is left alone."""
_SINGLE = 1e-8
"""Departure that single precision suffices to correct for: its error is 1e-7 of that."""
_MOST_STEPS, _PARTS = 4, 4


@dataclass(frozen=True, eq=False)
class Orthonormal:
    """Orthonormal rows.

    Attributes
    ----------
    rows
        Shape (k, n).
    departure
        Largest of all entries of |rows·rowsᵀ − identity|, measured.
    """

    rows: Floats
    departure: float


def orthonormalized(rows: Floats, workers: Workers) -> Orthonormal:
    """The nearest orthonormal rows, by Newton-Schulz steps of the polar decomposition.

    Eigenvectors found of one symmetric matrix are the nearer to orthogonal the further apart
    their eigenvalues lie. So a first step is taken among neighbours, at a fraction of the price,
    and further ones among all; none where the departure, which is always measured, is small.

    Parameters
    ----------
    rows
        Nearly orthonormal, shape (k, n), in the order of their eigenvalues.
    workers
        Who share the products.

    References
    ----------
    Higham 2008, Functions of Matrices, § 8.3.
    """
    parts, reach = slices(len(rows), _NEIGHBOURS), 1
    lower = overlap(rows, workers)
    for _ in range(_MOST_STEPS):
        if np.abs(lower).max() <= _ORTHONORMAL:
            break
        rows = _step(rows, lower, parts, reach, workers)
        lower = overlap(rows, workers)
        parts, reach = _quarters(len(rows)), _PARTS
    return Orthonormal(rows, float(np.abs(lower).max()))


def overlap(rows: Floats, workers: Workers) -> Floats:
    """Inner products of all rows less those of orthonormal ones: the lower triangle, shape (k, k).

    Half the work of a general product, since it is symmetric.
    """
    products = np.zeros((len(rows), len(rows)))

    def fill(tile: tuple[slice, slice]) -> None:
        # Of an array and its own transpose the library computes one triangle and copies it.
        products[tile] = rows[tile[0]] @ rows[tile[1]].T

    parts = _quarters(len(rows))
    workers.each(fill, [(one, other) for i, one in enumerate(parts) for other in parts[: i + 1]])
    products[np.diag_indices_from(products)] -= 1.0
    return np.tril(products)


def _step(rows: Floats, lower: Floats, parts: list[slice], reach: int, workers: Workers) -> Floats:
    """Rows less half of their overlaps, with those at most `reach` parts before and after."""
    stepped = np.empty_like(rows)
    sources, factors = rows, 0.5 * (np.tril(lower, -1) + lower.T)
    if np.abs(factors).max() < _SINGLE:
        sources, factors = rows.astype(np.float32), factors.astype(np.float32)

    def fill(i: int) -> None:
        some = parts[i]
        near = slice(parts[max(i - reach, 0)].start, parts[min(i + reach, len(parts) - 1)].stop)
        np.subtract(rows[some], factors[some, near] @ sources[near], out=stepped[some])

    workers.each(fill, range(len(parts)))
    return stepped


def _quarters(count: int) -> list[slice]:
    return slices(count, max(-(-count // _PARTS), 1))
