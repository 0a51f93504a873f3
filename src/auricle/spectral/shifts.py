"""Where along the spectrum a matrix is factored next."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy import sparse

from auricle.arrays import Floats
from auricle.spectral.factor_streams import Rooms
from auricle.spectral.factorization import (
    ShiftedFactorization,
    SymbolicFactorization,
    factorize,
)
from auricle.spectral.ladder import Ladder, end_of_cluster
from auricle.spectral.workers import Workers

AT_ONCE = 2
"""Neighbouring shifts that are searched around side by side."""
_REACH, _REACH_VERTICES = 40, 10_000
"""Eigenvalues a run is to find each way from its shift, and for a surface of how many vertices.

Factors cost more than vectors on larger ones, so that runs are worth being longer there.
"""
BEYOND = 6
"""Eigenvalues beyond those wanted that the last run is to reach: there the last count is made."""


@dataclass(frozen=True, eq=False)
class Factorable:
    """A symmetric matrix that is factored at many shifts, its pattern analysed once."""

    matrix: sparse.csc_array
    symbolic: SymbolicFactorization
    _rooms: Rooms = field(default_factory=Rooms, init=False)

    def at(self, shift: float) -> ShiftedFactorization:
        """Factors at a shift, or as near to it as can be."""
        return factorize(self.matrix, shift, symbolic=self.symbolic, rooms=self._rooms)

    @property
    def reach(self) -> int:
        """Eigenvalues a run is to find each way from its shift."""
        n_vertices = int(self.symbolic.plan.order.size)
        return round(float(_REACH * max(1.0, n_vertices / _REACH_VERTICES) ** 0.3))


@dataclass(frozen=True, eq=False)
class NextShifts:
    """The next shifts up.

    Attributes
    ----------
    searched
        Ascending; eigenpairs are to be found around each.
    wanted
        How many eigenvalues the last of them is to complete; None if others will be above it.
    ceiling
        Just above all that is wanted, where counting is enough, if all that is known already.
    """

    searched: Sequence[ShiftedFactorization]
    wanted: int | None = None
    ceiling: ShiftedFactorization | None = None


def next_shifts(
    factorable: Factorable, ladder: Ladder, *, count: int, density: float, workers: Workers
) -> NextShifts:
    """The next shifts up, to be searched around at one time, and how far that is to reach.

    What is left is shared out evenly among shifts, each in the middle of its share by the density
    of eigenvalues met so far; one that turns out much further up is left for another time.
    """
    known, low, n_low = len(ladder.values), ladder.certified, ladder.n_certified
    gap = gap_above(ladder.values, count, ladder.scale)
    if gap is not None:
        return NextShifts((), ceiling=factorable.at(gap))
    count = max(count, known)
    spacing, left = 1 / density, count + BEYOND - known
    n_runs = _shares(left, factorable.reach)
    heights = [known + left * (1 + 2 * i) / (2 * n_runs) for i in range(min(n_runs, AT_ONCE))]
    places = [low + (height - n_low) * spacing for height in heights]
    tried = workers.each(factorable.at, places)
    searched: list[ShiftedFactorization] = []
    for factors in tried:
        # A shift that could not be factored where it was wanted has moved up, past the next maybe.
        last = searched[-1] if searched else None
        needless = last is not None and (last.n_below > count or last.shift >= factors.shift)
        if needless or factors.n_below - known > 2 * factorable.reach:
            break
        searched.append(factors)
        known = factors.n_below + factorable.reach
    if not searched:
        searched.append(_nearer(factorable, ladder, tried[0]))
    to_the_end = len(searched) == n_runs and searched[-1].n_below <= count
    return NextShifts(searched, wanted=count if to_the_end else None)


def _shares(left: int, reach: int) -> int:
    """Among how many shifts so many eigenvalues are shared out: as many as go at once, or more."""
    if left <= reach:
        return 1
    return AT_ONCE * max(round(left / (2 * reach * AT_ONCE)), 1)


def gap_above(values: Floats, count: int, scale: float) -> float | None:
    """A number that separates the lowest `count` values, and those equal to them, from others.

    None where there are no others.

    >>> gap_above(np.array([0.0, 2.0, 2.0, 2.0, 6.0]), 2, 1.0)
    4.0
    """
    end = end_of_cluster(values, count, scale)
    return float(values[end - 1] + values[end]) / 2 if end < len(values) else None


def widest_gap(values: Floats) -> float:
    """The middle of the widest gap between neighbours."""
    widest = int(np.diff(values).argmax())
    return float(values[widest] + values[widest + 1]) / 2


def _nearer(
    factorable: Factorable, ladder: Ladder, factors: ShiftedFactorization
) -> ShiftedFactorization:
    """A shift with not many more eigenvalues under it than are known."""
    step, known = factors.shift - ladder.certified, len(ladder.values)
    while factors.n_below - known > 2 * factorable.reach:
        step /= 2
        nearer = factorable.at(ladder.certified + step)
        if nearer.n_below <= known:
            break  # a cluster wider than a slice: climb it whole
        factors = nearer
    return factors
