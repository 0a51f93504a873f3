"""Many nearly orthonormal rows made orthonormal, and how far from that they are."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from auricle.arrays import Floats, Integers, PerMode
from auricle.spectral.workers import Workers, slices

_NEIGHBOURS = 96
"""Rows before and after each that it departs from orthogonal to by more than to others."""
_NEGLIGIBLE = 2e-11
"""Inner product that need not be measured where it is known not to exceed this."""
_ORTHONORMAL = 5e-11
"""Departure from orthonormality that is left alone."""
_SINGLE = 1e-8
"""Departure that single precision suffices to correct for: its error is 1e-7 of that."""
_MOST_STEPS, _PARTS = 4, 4
_Block: TypeAlias = tuple[slice, slice]
"""Of a matrix: rows and columns."""


@dataclass(frozen=True, eq=False)
class Separation:
    """What keeps approximate eigenvectors of one symmetric matrix apart.

    Attributes
    ----------
    values
        Approximate eigenvalues, ascending, shape (k,).
    residuals
        Norms of what the matrix makes of the vectors beyond these multiples, shape (k,).
    hidden
        What rounding may hide of each.
    """

    values: PerMode
    residuals: PerMode
    hidden: float

    def relative_residuals(self, least: float) -> PerMode:
        """Residuals over eigenvalues; over `least` where these are smaller."""
        relative: PerMode = self.residuals / np.maximum(self.values, least)
        return relative

    def replaced(self, some: Integers, own: "Separation") -> "Separation":
        """The same with that of some of the vectors, found anew, in place of theirs."""
        values, residuals = self.values.copy(), self.residuals.copy()
        values[some], residuals[some] = own.values, own.residuals
        return replace(self, values=values, residuals=residuals)

    def most(self, some: slice, lower: slice) -> float:
        """Largest inner product that vectors of two ranges can have; ∞ where nothing is known.

        With A·u = μ·u + r and A·v = ν·v + s the product (μ − ν)·u·v is u·s − v·r, so that for
        vectors of length one |u·v| is not more than (‖r‖ + ‖s‖) / |μ − ν|.

        Examples
        --------
        >>> apart = Separation(np.array([1.0, 2.0, 4.0]), np.array([1e-9, 3e-9, 1e-9]), 0.0)
        >>> apart.most(slice(2, 3), slice(0, 2))
        2e-09
        """
        distance = float(self.values[some].min() - self.values[lower].max())
        beyond = float(self.residuals[some].max() + self.residuals[lower].max())
        return (beyond + 2 * self.hidden) / distance if distance > 0 else np.inf


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
    """The nearest orthonormal rows, by Newton-Schulz steps of the polar decomposition.

    Only those that depart from orthogonal to another take part. Eigenvectors found of one symmetric
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
    Higham 2008, Functions of Matrices, § 8.3; Parlett 1998, The Symmetric Eigenvalue Problem, § 11.
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

    The lower triangle, shape (k, k). Those that by their `separation` are negligible are not
    measured and left 0; the second is the largest that any of these can be.
    """
    products = np.zeros((len(rows), len(rows)))
    blocks, unmeasured = _blocks(separation, 0, len(rows))

    def fill(block: _Block) -> None:
        some, others = block
        np.matmul(rows[some], rows[others].T, out=products[block])

    # The largest first, so that threads end together.
    workers.each(fill, sorted(blocks, key=_size, reverse=True))
    products[np.diag_indices_from(products)] -= 1.0
    return np.tril(products), unmeasured


def _blocks(separation: Separation, begin: int, end: int) -> tuple[list[_Block], float]:
    """What is to be measured among some rows, as few blocks, and what others do not exceed.

    The triangle is cut into two of half the size, each a product of rows with themselves that
    takes half the time, and what is between them.
    """
    middle = (begin + end) // 2
    blocks, unmeasured = _between(separation, slice(middle, end), slice(begin, middle))
    for half in (slice(begin, middle), slice(middle, end)):
        if half.stop - half.start <= _NEIGHBOURS or not _any_apart(separation, half, half):
            within, most = [(half, half)], 0.0
        else:
            within, most = _blocks(separation, half.start, half.stop)
        blocks, unmeasured = blocks + within, max(unmeasured, most)
    return blocks, unmeasured


def _between(separation: Separation, some: slice, lower: slice) -> tuple[list[_Block], float]:
    """The same among the products of some rows with lower ones."""
    if some.start == some.stop or lower.start == lower.stop:
        return [], 0.0
    most = separation.most(some, lower)
    if most <= _NEGLIGIBLE:
        return [], most
    if _size((some, lower)) <= _NEIGHBOURS**2 or not _any_apart(separation, some, lower):
        return [(some, lower)], 0.0
    blocks: list[_Block] = []
    unmeasured = 0.0
    for part in _halves(some):
        for other in _halves(lower):
            here, most = _between(separation, part, other)
            blocks, unmeasured = blocks + here, max(unmeasured, most)
    return blocks, unmeasured


def _any_apart(separation: Separation, some: slice, lower: slice) -> bool:
    """Whether those of two ranges that are furthest apart need not be measured."""
    last = slice(max(some.stop - _NEIGHBOURS, some.start), some.stop)
    first = slice(lower.start, min(lower.start + _NEIGHBOURS, lower.stop))
    return separation.most(last, first) <= _NEGLIGIBLE


def _halves(some: slice) -> tuple[slice, slice]:
    middle = (some.start + some.stop) // 2
    return slice(some.start, middle), slice(middle, some.stop)


def _size(block: _Block) -> int:
    some, others = block
    return int((some.stop - some.start) * (others.stop - others.start))


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


def _neighbours(count: int) -> list[slice]:
    return slices(count, _NEIGHBOURS)


def _quarters(count: int) -> list[slice]:
    return slices(count, max(-(-count // _PARTS), 1))
