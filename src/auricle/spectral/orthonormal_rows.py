"""Many nearly orthonormal rows made orthonormal, and how far from that they are."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats, PerMode
from auricle.spectral.gram_tiles import fill_products, tiles
from auricle.spectral.separation import Separation
from auricle.spectral.workers import Workers, slices

_NEIGHBOURS = 96
"""Rows before each that it departs from orthogonal to by more than to others."""
_NEGLIGIBLE = 4e-11
"""Inner product that need not be measured where it is known not to exceed this."""
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
    separation
        Of these rows.
    departure
        Not less than the largest entry of |rows·rowsᵀ − identity|: measured, but for rows so far
        apart that it is known to be negligible.
    """

    rows: Floats
    separation: Separation
    departure: float


def orthonormalized(
    rows: Floats,
    separation: Separation,
    separated: Callable[[Floats, PerMode], Separation],
    workers: Workers,
) -> Orthonormal:
    """Orthonormal rows next to these, by steps of first order, which square the departure.

    What two rows share is taken out of that of the larger eigenvalue: the residual of the other,
    small against its own eigenvalue, tells that little of it lies there. Half of it taken out of
    each, as for the nearest orthonormal rows, would let residuals of the lowest grow.

    Only rows that depart from orthogonal to another take part. Eigenvectors found of one symmetric
    matrix are the nearer to orthogonal the further apart their eigenvalues lie. So a first step is
    taken among neighbours, at a fraction of the price, and further ones among all; none where the
    departure is small.

    Parameters
    ----------
    rows
        Nearly orthonormal, shape (k, n), in the order of their eigenvalues; changed in place.
    separation, separated
        Of these rows; and of rows that are nearly some of these, from nearly their eigenvalues.
    workers
        Who share the products.

    References
    ----------
    Parlett 1998, The Symmetric Eigenvalue Problem, § 11.
    """
    lower, unmeasured = overlap(rows, workers, separation)
    for step in range(_MOST_STEPS + 1):
        departure = float(np.abs(lower).max(initial=unmeasured))
        if departure <= _ORTHONORMAL or step == _MOST_STEPS:
            break
        departing = np.abs(lower) > _NEGLIGIBLE
        some = np.flatnonzero(departing.any(axis=0) | departing.any(axis=1))
        parts, reach = (_quarters(len(some)), _PARTS) if step else (_neighbours(len(some)), 1)
        pairs = np.ix_(some, some)
        stepped = _step(rows[some], lower[pairs], parts, reach, workers)
        rows[some] = stepped
        own = separated(stepped, separation.values[some])
        separation = separation.replaced(some, own)
        lower[pairs], beyond = overlap(stepped, workers, own)
        unmeasured = max(unmeasured, beyond)
    return Orthonormal(rows, separation, departure)


def overlap(rows: Floats, workers: Workers, separation: Separation) -> tuple[Floats, float]:
    """Inner products of all rows less those of orthonormal ones, and what others do not exceed.

    The lower triangle, shape (k, k). Tiles that by their `separation` are negligible are not
    measured and left 0; the second is the largest that any of these can be.
    """
    products = np.zeros((len(rows), len(rows)))
    bounds = separation.bounds(tiles(len(rows)))
    below = np.tri(len(bounds), dtype=bool)
    wanted = below & (bounds > _NEGLIGIBLE)
    fill_products(rows, wanted, products, workers)
    products[np.diag_indices_from(products)] -= 1.0
    return np.tril(products), float(bounds[below & ~wanted].max(initial=0.0))


def _step(rows: Floats, lower: Floats, parts: list[slice], reach: int, workers: Workers) -> Floats:
    """Rows made of length 1, less their overlaps with those up to `reach` parts before."""
    stepped = np.empty_like(rows)
    sources, factors = rows, np.tril(lower) - 0.5 * np.diag(np.diag(lower))
    if np.abs(factors).max() < _SINGLE:
        sources, factors = rows.astype(np.float32), factors.astype(np.float32)

    def fill(i: int) -> None:
        some = parts[i]
        near = slice(parts[max(i - reach, 0)].start, parts[i].stop)
        np.subtract(rows[some], factors[some, near] @ sources[near], out=stepped[some])

    workers.each(fill, range(len(parts)))
    return stepped


def _neighbours(count: int) -> list[slice]:
    return slices(count, _NEIGHBOURS)


def _quarters(count: int) -> list[slice]:
    return slices(count, max(-(-count // _PARTS), 1))
