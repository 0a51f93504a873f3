"""Where along the spectrum a matrix is factored next."""

from collections.abc import Sequence
from dataclasses import dataclass

from scipy import sparse

from auricle.spectral.factorization import (
    ShiftedFactorization,
    SymbolicFactorization,
    factorize,
)
from auricle.spectral.ladder import Ladder
from auricle.spectral.workers import Workers

AT_ONCE = 2
"""Neighbouring shifts that are searched around side by side."""
_REACH, _REACH_VERTICES = 40, 10_000
"""Eigenvalues a run is to find each way from its shift, and for a surface of how many vertices.

Factors cost more than vectors on larger ones, so that runs are worth being longer there.
"""
_STEADY, _ASIDE = 1e-11, (0.0, 0.4, -0.4)
"""Backward error of solves that need no refinement, and where else to try, in mean spacings."""


@dataclass(frozen=True, eq=False)
class Factorable:
    """A symmetric matrix that is factored at many shifts, its pattern analysed once."""

    matrix: sparse.csc_array
    symbolic: SymbolicFactorization

    def at(self, shift: float) -> ShiftedFactorization:
        """Factors at a shift, or as near to it as can be."""
        return factorize(self.matrix, shift, symbolic=self.symbolic)

    def steadily_at(self, shift: float, spacing: float) -> ShiftedFactorization:
        """Factors at a shift or just beside it, where solves are right without refinement.

        How much is lost to poor pivots changes from one shift to the next, by a hundred times.
        """
        tried: list[ShiftedFactorization] = []
        for aside in _ASIDE:
            tried.append(self.at(shift + aside * spacing))
            if tried[-1].backward_error <= _STEADY:
                return tried[-1]
        return min(tried, key=lambda factors: factors.backward_error)

    @property
    def reach(self) -> int:
        """Eigenvalues a run is to find each way from its shift."""
        n_vertices = int(self.symbolic.plan.order.size)
        return round(float(_REACH * max(1.0, n_vertices / _REACH_VERTICES) ** 0.25))


def next_shifts(
    factorable: Factorable, ladder: Ladder, *, count: int, density: float, workers: Workers
) -> Sequence[ShiftedFactorization]:
    """The next shifts up, to be searched around at one time; the last of all only just beyond.

    Each is placed half a slice above what is known when it is its turn, by the density of
    eigenvalues met so far; one that turns out much further up is left for another time.
    """
    known, low, n_low = len(ladder.values), ladder.certified, ladder.n_certified
    reach, spacing = factorable.reach, 1 / density
    heights = [min(count + 3, known + reach * (1 + 2 * i)) for i in range(AT_ONCE)]
    places = [low + max(height - n_low, 3) * spacing for height in sorted(set(heights))]
    tried = workers.each(lambda place: factorable.steadily_at(place, spacing), places)
    shifts: list[ShiftedFactorization] = []
    for factors in tried:
        # A shift that could not be factored where it was wanted has moved up, past the next maybe.
        needless = shifts and (shifts[-1].n_below > count or shifts[-1].shift >= factors.shift)
        if needless or factors.n_below - known > 2 * reach:
            break
        shifts.append(factors)
        known = factors.n_below + reach
    return shifts or [_nearer(factorable, ladder, tried[0], spacing)]


def _nearer(
    factorable: Factorable, ladder: Ladder, factors: ShiftedFactorization, spacing: float
) -> ShiftedFactorization:
    """A shift with not many more eigenvalues under it than are known."""
    step, known = factors.shift - ladder.certified, len(ladder.values)
    while factors.n_below - known > 2 * factorable.reach:
        step /= 2
        nearer = factorable.steadily_at(ladder.certified + step, spacing)
        if nearer.n_below <= known:
            break  # a cluster wider than a slice: climb it whole
        factors = nearer
    return factors
