"""Where along the spectrum a matrix is factored, and what is to be found from there."""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from scipy import sparse

from auricle.arrays import Floats
from auricle.spectral.factor_streams import Rooms
from auricle.spectral.factorization import (
    ShiftedFactorization,
    SymbolicFactorization,
    factorize,
)
from auricle.spectral.ladder import end_of_cluster

AT_ONCE = 2
"""Neighbouring shifts that are searched around side by side."""
_REACH, _REACH_VERTICES = 40, 10_000
"""Eigenvalues a run is to find each way from its shift, and for a surface of how many vertices.

Factors cost more than vectors on larger ones, so that runs are worth being longer there.
"""
BEYOND = 6
"""Eigenvalues beyond those wanted that the last run is to reach: there the last count is made."""
_MORE_AT_THE_BOTTOM, _LEAST_HALF = 18, 4
"""Eigenvalues more that the lowest share has, as a run is shorter where nothing lies further down;
and how many the half of a share has at least."""
_OFF, _TRIES, _MOST_TRIES = 0.2, 3, 20
"""How far from the middle of its share a shift may lie, of the share; after how many tries it may
be anywhere near that; and how many there are at most."""


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


class Share(NamedTuple):
    """Eigenvalues that are one run's to find.

    Attributes
    ----------
    first, end
        Index of the lowest, counted from 0, and of the one after the highest.
    """

    first: int
    end: int

    def settled(self, n_below: int, reach: int) -> "Share":
        """With as many eigenvalues above a shift as below it, `n_below` in all being below.

        A run finds as many either way. More than 2·`reach` are left to the next.

        >>> Share(84, 168).settled(131, 40)
        Share(first=84, end=178)
        """
        half = min(n_below - self.first, 2 * reach)
        return Share(self.first, n_below + half) if half > _LEAST_HALF else self


class _Counted(NamedTuple):
    """A height, and how many eigenvalues lie below."""

    height: float
    n_below: int


class Outlook(NamedTuple):
    """What is known when a share is laid.

    Attributes
    ----------
    end
        Index up to which eigenvalues are known, or in other shares.
    height, n_below
        Where eigenvalues were counted further down, and how many lie below.
    density
        Eigenvalues per unit of eigenvalue, as expected from there on.
    """

    end: int
    height: float
    n_below: int
    density: float

    def after(self, share: Share, factors: ShiftedFactorization) -> "Outlook":
        """The outlook beyond a share, from what is counted at its shift."""
        rise, n_met = factors.shift - self.height, factors.n_below - self.n_below
        density = n_met / rise if rise > 0 and n_met > 0 else self.density
        return Outlook(share.end, factors.shift, factors.n_below, density)

    def shares_left(self, n_expected: int, goal: int, reach: int) -> int:
        """How many shares are left up to a goal: as expected, unless these would be too large.

        >>> outlook = Outlook(end=90, height=0.5, n_below=45, density=100.0)
        >>> outlook.shares_left(2, 250, 40), outlook.shares_left(1, 250, 40)
        (2, 2)
        """
        left = goal - self.end
        return max(n_expected, -(-left // (3 * reach))) if left > 0 else 0


def number_of_shares(outlook: Outlook, goal: int, reach: int) -> int:
    """Among how many runs what lies below a goal is shared out: as many as go at once, or more."""
    left = goal - outlook.end
    return 1 if left <= reach else AT_ONCE * max(round(left / (2 * reach * AT_ONCE)), 1)


def next_share(outlook: Outlook, goal: int, n_shares: int) -> Share:
    """The lowest of so many shares that are expected to cost the same.

    >>> next_share(Outlook(100, 0.5, 80, 100.0), 160, 2), next_share(Outlook(0, 0, 0, 1), 160, 2)
    (Share(first=100, end=130), Share(first=0, end=89))
    """
    first = outlook.end
    more = _MORE_AT_THE_BOTTOM if first == 0 and n_shares > 1 else 0
    return Share(first, first + more + -(-(goal - first - more) // n_shares))


def factors_amid(factorable: Factorable, share: Share, outlook: Outlook) -> ShiftedFactorization:
    """Factors at a shift with about half of a share below it.

    Where what is expected misses that by too much, the shift moves by what has been counted.

    Parameters
    ----------
    factorable
        What is factored.
    share
        Which eigenvalues are to be found from there; some above the last count at least.
    outlook
        From which the shift is placed.

    Raises
    ------
    SolverError
        If no shift nearby can be factored.
    """
    size, middle = share.end - share.first, (max(share.first, outlook.n_below) + share.end) / 2
    low, high = _Counted(outlook.height, outlook.n_below), None
    density, nearest = outlook.density, np.inf
    for attempt in range(_MOST_TRIES):
        place = low.height + (middle - low.n_below) / density
        if high is not None:
            # By turns: counts do not tell where in a cluster of equal eigenvalues it is.
            met = (middle - low.n_below) / (high.n_below - low.n_below)
            place = low.height + (met if attempt % 2 else 0.5) * (high.height - low.height)
        factors = factorable.at(place)
        off = factors.n_below - middle
        if abs(off) < nearest:
            amid, nearest = factors, abs(off)
        if nearest <= _OFF * size or (attempt + 1 >= _TRIES and nearest <= size):
            break
        here = _Counted(factors.shift, factors.n_below)
        if off > 0:
            high = here
        else:
            density = max(here.n_below - low.n_below, 1) / (here.height - low.height)
            low = here
    return amid


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
