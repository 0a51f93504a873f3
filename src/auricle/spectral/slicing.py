"""Spectrum slicing: the lowest eigenpairs of a sparse matrix, none missing.

The spectrum is climbed by shifts. At each the inertia of the factorisation tells how many
eigenvalues lie below, so that every pair has an absolute index and a missing one is noticed and
searched for again. ARPACK alone loses copies of repeated eigenvalues without a word.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy import sparse

from auricle.arrays import Floats
from auricle.errors import SolverError
from auricle.spectral.factorization import ShiftedFactorization, SymbolicFactorization, analyze
from auricle.spectral.ladder import Ladder, junction
from auricle.spectral.lanczos import Effort, LanczosRun
from auricle.spectral.memory import require_memory
from auricle.spectral.narrow_products import aligned_groups
from auricle.spectral.share_runs import MOST_VECTORS, TOLERANCE, ShareRuns
from auricle.spectral.shifts import AT_ONCE, BEYOND, Factorable, Outlook, gap_above
from auricle.spectral.workers import Workers

_SEARCH_BLOCK, _WIDEST_BLOCK = 8, 32
"""Width in searches for what is missing, which widens.

Clusters of equal eigenvalues wider than the block show one block's width of copies a run.
"""
_SEARCH_STEPS = 40
"""Length of a search, in blocks."""
_MORE = 4
"""Pairs more that a run is to find whose values do not join those below."""
_RETRIES, _FRUITLESS = 60, 4
"""Searches again for what is missing, and how many of the widest in a row may find nothing new."""
_LIKELY_VECTORS, _COPIES = 400, 3
"""For the estimate of memory: vectors of a long run, and copies of the result held at one time."""


@dataclass(frozen=True, eq=False)
class LowestPairs:
    """The lowest eigenpairs of a matrix, none missing.

    Attributes
    ----------
    values
        Eigenvalues, shape (c,), ascending.
    room
        Nearly orthonormal eigenvectors, one a column, the first c of shape (n, c or more).
    complete_below, n_counted
        No eigenvalue under this is missing; above the last of `values`. How many inertia counts
        there.
    retries
        What had to be searched for again, one phrase each.
    """

    values: Floats
    room: Floats
    complete_below: float
    n_counted: int
    retries: tuple[str, ...]


def lowest_eigenpairs(
    matrix: sparse.csc_array,
    count: int,
    *,
    density: float,
    rng: np.random.Generator,
    workers: Workers,
    symbolic: SymbolicFactorization | None = None,
) -> LowestPairs:
    """At least `count` lowest eigenpairs of a symmetric positive semi-definite matrix.

    Parameters
    ----------
    matrix
        Sparse, symmetric, shape (n, n).
    count
        How many are wanted, well below n; more come back where that would cut through equal
        eigenvalues.
    density
        Expected number of eigenvalues per unit of eigenvalue (Weyl: area / 4π), for the first
        shift; later shifts follow the density met.
    rng
        Source of the starting blocks.
    workers
        Who search neighbouring slices at the same time, and are told the number of eigenvalues
        certified. The digits do not depend on how many there are.
    symbolic
        The analysis of the matrix's pattern, where there is one at hand.

    Raises
    ------
    InputError
        If the memory that is left does not suffice.
    SolverError
        If eigenvalues that inertia counts cannot be found after many restarts.
    """
    symbolic = symbolic or analyze(matrix)
    require_memory(
        needed_bytes(symbolic, count), f"{count} harmonics of {len(matrix.indptr) - 1} vertices"
    )
    factorable = Factorable(matrix, symbolic)
    n = len(matrix.indptr) - 1
    ladder = Ladder(np.empty(0), np.empty((n, count)), certified=-1 / density, scale=1 / density)
    # Used by one run after another: a system sets new pages to zero, or has to ask for them.
    n_groups = MOST_VECTORS // _SEARCH_BLOCK + 1
    bases = [aligned_groups(n_groups, n, _SEARCH_BLOCK) for _ in range(workers.threads)]
    workers.report("harmonics", 0, count)
    ended = False
    while not ended:
        low, n_low = ladder.certified, ladder.n_certified
        climb = _Climb(factorable, ladder, count, density, rng, workers)
        ended = climb.to_the_gap() or climb.by_shares(bases) or ladder.n_certified > count
        density = max(ladder.n_certified - n_low, 1) / (ladder.certified - low)
    return LowestPairs(
        ladder.values[: ladder.n_certified],
        ladder.room,
        ladder.certified,
        ladder.n_certified,
        tuple(ladder.retries),
    )


def needed_bytes(symbolic: SymbolicFactorization, count: int) -> int:
    """Memory that the search takes at its highest, with what is made of its result."""
    n = len(symbolic.plan.order)
    runs = AT_ONCE * (symbolic.n_bytes + 8 * n * _LIKELY_VECTORS)
    return runs + 8 * count * (_COPIES * n + 2 * count)


@dataclass(frozen=True, eq=False)
class _Climb:
    """A way up the spectrum: what is found is put on the ladder.

    Attributes
    ----------
    factorable, ladder, count, rng, workers
        As `lowest_eigenpairs` has them.
    density
        Expected number of eigenvalues per unit of eigenvalue above what is certified.
    """

    factorable: Factorable
    ladder: Ladder
    count: int
    density: float
    rng: np.random.Generator
    workers: Workers

    def to_the_gap(self) -> bool:
        """Count where what is wanted ends, if that is known already; returns whether it is."""
        gap = gap_above(self.ladder.values, self.count, self.ladder.scale)
        if gap is not None:
            self._end_at(self.factorable.at(gap))
        return gap is not None

    def by_shares(self, bases: Sequence[Floats]) -> bool:
        """Find what is wanted, share by share; returns whether all of it is certified."""
        ladder, known, ended = self.ladder, len(self.ladder.values), False
        outlook = Outlook(known, ladder.certified, ladder.n_certified, self.density)
        goal = max(known, self.count) + BEYOND
        runs = ShareRuns(self.factorable, bases, self.rng, self.workers)
        for run, is_last in runs.upwards(outlook, goal):
            ended = self._take_in(run, is_last=is_last)
            found = min(ladder.n_certified, self.count)
            self.workers.report("harmonics", found, self.count)
        return ended

    def _take_in(self, run: LanczosRun, *, is_last: bool) -> bool:
        """Put on the ladder what a run found, and what it missed; returns whether that is all."""
        factors, ladder, workers = run.factors, self.ladder, self.workers
        if factors.shift <= ladder.certified:
            # A shift that had to move up past the one after it.
            factors.let_go()
            return False
        workers.result(workers.submit(run.until, partial(_gap_left, ladder, factors)))
        joint, ceiling = junction(ladder, run.values, factors), None
        if joint is None:
            _search(factors, ladder, rng=self.rng, workers=workers)
        elif is_last:
            ceiling = _completed(run, ladder, joint, (self.count, self.factorable.at), workers)
        else:
            _put(run, ladder, joint, None, workers)
        ladder.certify(factors)
        factors.let_go()
        if ceiling is not None:
            self._end_at(ceiling)
        return ceiling is not None

    def _end_at(self, ceiling: ShiftedFactorization) -> None:
        _search(ceiling, self.ladder, rng=self.rng, workers=self.workers)
        self.ladder.certify(ceiling)


def _gap_left(ladder: Ladder, factors: ShiftedFactorization, values: Floats) -> int:
    return _MORE if junction(ladder, values, factors) is None else 0


def _put(
    run: LanczosRun, ladder: Ladder, joint: tuple[int, int], end: int | None, workers: Workers
) -> None:
    """Put on the ladder what a run found from where it joins up to an index."""
    kept, first = joint
    fill = partial(run.fill_vectors, first, workers=workers)
    ladder.replace_above(kept, run.values[first:end], fill)


def _completed(
    run: LanczosRun,
    ladder: Ladder,
    joint: tuple[int, int],
    goal: tuple[int, Callable[[float], ShiftedFactorization]],
    workers: Workers,
) -> ShiftedFactorization | None:
    """Put on the ladder what a run found, up to just above all that is wanted.

    `goal` is how many are wanted, and what factors at a shift. Returns factors there, which are
    made while vectors are; None where the run does not reach as high. If more is counted there than
    it has found it goes on, and its vectors are made once more.
    """
    (kept, first), (wanted, at) = joint, goal
    low = ladder.values[: ladder.n_certified + kept]
    gap = gap_above(np.concatenate([low, run.values[first:]]), wanted, ladder.scale)
    if gap is None:
        _put(run, ladder, joint, None, workers)
        return None
    counting, end = workers.submit(at, gap), int(np.searchsorted(run.values, gap))
    _put(run, ladder, joint, end, workers)
    ceiling, shift = workers.result(counting), run.factors.shift

    def missing(values: Floats) -> int:
        below, above = np.searchsorted(values, [shift, ceiling.shift])
        return max(ceiling.n_below - run.factors.n_below - int(above - below), 0)

    if missing(run.values) or np.searchsorted(run.values, ceiling.shift) != end:
        below = float(low[-1]) if kept else ladder.certified
        seam = (below + min(float(run.values[first]), shift)) / 2
        workers.result(workers.submit(run.until, missing))
        first, end = (int(i) for i in np.searchsorted(run.values, [seam, ceiling.shift]))
        _put(run, ladder, (kept, first), end, workers)
    return ceiling


def _search(
    factors: ShiftedFactorization,
    ladder: Ladder,
    *,
    rng: np.random.Generator,
    workers: Workers,
) -> None:
    """Look for what is missing under the shift among all that is orthogonal to what is known."""
    reach = factors.shift - ladder.certified
    block, attempt, fruitless = _SEARCH_BLOCK, 0, 0
    missing = factors.n_below - ladder.n_below(factors.shift)
    while missing > 0 and attempt < _RETRIES and fruitless < _FRUITLESS:
        ladder.retries.append(f"{missing} eigenvalues below {factors.shift:.6g}/mm²")
        known = ladder.from_value(ladder.certified - reach)
        effort = _search_effort(factors, block)
        run = LanczosRun(factors, known, effort=effort, rng=rng, pause=workers.pause)
        workers.result(workers.submit(run.until))
        # Under the certified height everything is known: what is met there again is left.
        fresh = int(np.searchsorted(run.values, ladder.certified, side="right"))
        ladder.add(run.values[fresh:], run.vectors(fresh, workers))
        before, missing = missing, factors.n_below - ladder.n_below(factors.shift)
        fruitless = fruitless + 1 if missing >= before and block == _WIDEST_BLOCK else 0
        block, attempt = min(2 * block, _WIDEST_BLOCK), attempt + 1
    if missing:
        raise SolverError(
            f"{factors.n_below} eigenvalues counted below {factors.shift:.6g}/mm² but "
            f"{factors.n_below - missing} found: is the surface degenerate?"
        )


def _search_effort(factors: ShiftedFactorization, block: int) -> Effort:
    steps = min(_SEARCH_STEPS, factors.size // (2 * block))
    return Effort(block, steps, steps, TOLERANCE)
