"""Runs of block Lanczos iteration that climb a spectrum side by side, share by share."""

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from itertools import cycle

import numpy as np

from auricle.arrays import Floats
from auricle.spectral.factorization import ShiftedFactorization
from auricle.spectral.lanczos import VECTORS_PER_PAIR, Effort, LanczosRun
from auricle.spectral.shifts import (
    AT_ONCE,
    Factorable,
    Outlook,
    Share,
    factors_amid,
    next_share,
    number_of_shares,
    widest_gap,
)
from auricle.spectral.workers import Workers

TOLERANCE = 1e-11
"""Of pairs that count as converged."""
MOST_VECTORS = 800
"""Length of a run, at most."""
_RUN, _LARGE_RUN, _LARGE = (4, 17, TOLERANCE), (8, 15, 1e-10), 60_000
"""Of a run: width of its block, blocks before the first pair converges, tolerance; and from how
many vertices on they are others. There factors are far from the processor, so that to read them
less often is worth more than to make few vectors; and rounding leaves as much as that tolerance.
"""
_AT_THE_BOTTOM, _FEW = 7, 4
"""Blocks before the first pair converges where nothing lies further down, or so little; each
further pair takes `VECTORS_PER_PAIR` vectors."""
_OVERLAP = 2
"""Eigenvalues of each neighbour's share that a run is to find too."""
_GLANCE, _TOO_NEAR, _AROUND = 8, 0.03, 8
"""Blocks after which a run is looked at for an eigenvalue next to its shift; share of the mean
spacing that is too near; and how many eigenvalues around it show the gap it moves to."""


@dataclass(frozen=True, eq=False)
class ShareRuns:
    """Runs that climb a spectrum, as many side by side as there are rooms for their bases.

    Who is done with one begins another. What goes into a run does not depend on who is done when:
    of those before it only counts are known, which are made before they run.

    Attributes
    ----------
    factorable
        The matrix.
    bases
        Each with room for `MOST_VECTORS` vectors.
    rng
        Source of the starting blocks.
    workers
        Who run.
    """

    factorable: Factorable
    bases: Sequence[Floats]
    rng: np.random.Generator
    workers: Workers

    def upwards(self, outlook: Outlook, goal: int) -> Iterator[tuple[LanczosRun, bool]]:
        """Runs that have found their shares, the lowest first, and whether each is the last.

        Together they find what lies between an outlook and a goal, the index of an eigenvalue. The
        basis of a run is used for another when the next is asked for.

        Raises
        ------
        SolverError
            If nowhere in a share the matrix can be factored.
        """
        n_left = number_of_shares(outlook, goal, self.factorable.reach)
        under_way: deque[tuple[Future[LanczosRun], bool]] = deque()
        for n_begun, numbers in enumerate(cycle(self.bases)):
            if n_left > 0:
                share, is_last = next_share(outlook, goal, n_left), n_left == 1
                # The first are begun together, so that where they meet is settled before.
                is_settled = is_last or n_begun + 1 < AT_ONCE
                run, beyond = self._begin(share, outlook, numbers, is_settled=is_settled)
                under_way.append((run, is_last))
                n_left -= 1
            elif not under_way:
                return
            if n_left == 0 or len(under_way) == len(self.bases):
                run, is_last = under_way.popleft()
                yield self.workers.result(run), is_last
            if n_left > 0:
                outlook = self.workers.result(beyond)
                n_left = outlook.shares_left(n_left, goal, self.factorable.reach)

    def _begin(
        self, share: Share, outlook: Outlook, numbers: Floats, *, is_settled: bool
    ) -> tuple[Future[LanczosRun], Future[Outlook]]:
        """A run that is begun, and the outlook beyond its share, to be had before it is done."""
        rng, beyond = self.rng.spawn(1)[0], Future[Outlook]()
        if is_settled:
            beyond.set_result(outlook._replace(end=share.end))

        def find() -> LanczosRun:
            try:
                factors, found = factors_amid(self.factorable, share, outlook), share
                if not is_settled:
                    found = share.settled(factors.n_below, self.factorable.reach)
                    beyond.set_result(outlook.after(found, factors))
            except BaseException as error:
                if not is_settled:
                    beyond.set_exception(error)
                raise
            return self._found(found, factors, rng, numbers)

        return self.workers.submit(find), beyond

    def _found(
        self, share: Share, factors: ShiftedFactorization, rng: np.random.Generator, numbers: Floats
    ) -> LanczosRun:
        """A run around a shift, which has found a share by number.

        A shift that turns out too near an eigenvalue is moved.
        """
        nothing, pause = np.empty((factors.size, 0)), self.workers.pause
        missing = _lacks(factors, share)
        effort = _effort(factors, missing(np.empty(0)))
        run = LanczosRun(factors, nothing, effort=effort, rng=rng, pause=pause, numbers=numbers)
        better = _better_shift(run.glance(_GLANCE), factors.shift)
        if better is not None:
            factors.let_go()
            factors = self.factorable.at(better)
            missing = _lacks(factors, share)
            run = LanczosRun(factors, nothing, effort=effort, rng=rng, pause=pause, numbers=numbers)
        return run.until(missing)


def _better_shift(nearest: Floats, shift: float) -> float | None:
    """The middle of the widest gap nearby, if the shift lies next to an eigenvalue; else None.

    Solves there are right to rounding of the nearest eigenvector's part, which swamps what
    belongs to eigenvalues far from the shift.
    """
    around = np.sort(nearest[:_AROUND])
    if len(around) < _AROUND:
        return None
    if np.abs(around - shift).min() > _TOO_NEAR * np.diff(around).mean():
        return None
    return widest_gap(around)


def _lacks(factors: ShiftedFactorization, share: Share) -> Callable[[Floats], int]:
    """How much a run lacks of a share, on either side of the shift as much as on the other."""
    below = min(max(factors.n_below - share.first, 0) + _OVERLAP, factors.n_below)
    above = max(share.end - factors.n_below, 0) + _OVERLAP

    def missing(values: Floats) -> int:
        found_below = int(np.searchsorted(values, factors.shift))
        return 2 * max(below - found_below, above - (len(values) - found_below), 0)

    return missing


def _effort(factors: ShiftedFactorization, n_pairs: int) -> Effort:
    block, until_first, tolerance = _RUN if factors.size < _LARGE else _LARGE_RUN
    most = min(MOST_VECTORS, factors.size // 2) // block
    at_the_bottom = factors.n_below <= n_pairs // 2 + _FEW
    first = _AT_THE_BOTTOM if at_the_bottom else until_first
    first += int(VECTORS_PER_PAIR * n_pairs) // block
    return Effort(block, min(first, most), most, tolerance)
