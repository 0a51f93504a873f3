"""Spectrum slicing: the lowest eigenpairs of a sparse matrix, none missing.

The spectrum is climbed by shifts. At each the inertia of the factorisation tells how many
eigenvalues lie below, so that every pair has an absolute index and a missing one is noticed and
searched for again. ARPACK alone loses copies of repeated eigenvalues without a word.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from scipy import sparse

from auricle.arrays import Floats
from auricle.errors import SolverError
from auricle.spectral.factorization import (
    ShiftedFactorization,
    SymbolicFactorization,
    analyze,
    factorize,
)
from auricle.spectral.lanczos import VECTORS_PER_PAIR, Effort, LanczosRun
from auricle.spectral.memory import require_memory
from auricle.spectral.workers import Workers

_BLOCK, _SEARCH_BLOCK, _WIDEST_BLOCK = 4, 8, 32
"""Width of a run's block: of an ordinary one, and of searches for what is missing, which widens.

Clusters of equal eigenvalues wider than the block show one block's width of copies a run.
"""
_BLOCKS_UNTIL_FIRST = 15
"""Blocks before the first pair converges; each further one takes `VECTORS_PER_PAIR` vectors."""
_MOST_VECTORS = 800
_SEARCH_STEPS = 40
_REACH, _REACH_VERTICES = 40, 10_000
"""Eigenvalues a run is to find each way from its shift, and for a surface of how many vertices.

Factors cost more than vectors on larger ones, so that runs are worth being longer there.
"""
_AT_ONCE = 2
_MARGIN = 4
_TOLERANCE = 1e-11
_AGREEMENT = 1e-8
_TOO_NEAR, _AROUND = 0.03, 8
"""Share of the mean spacing within which a shift may not meet an eigenvalue, and how many of them
around it show the gap it moves to."""
_STEADY, _ASIDE = 1e-11, (0.0, 0.4, -0.4)
"""Backward error of solves that need no refinement, and where else to try, in mean spacings."""
_RETRIES, _FRUITLESS = 60, 4
"""Searches again for what is missing, and how many of the widest in a row may find nothing new."""
_LIKELY_VECTORS, _COPIES = 400, 4
"""For the estimate of memory: vectors of a long run, and copies of the result held at one time."""


@dataclass(eq=False)
class _Ladder:
    """Eigenpairs found so far, ascending, with what was retried on the way.

    Every eigenvalue under `certified` is on the ladder; above it some may still be missing.
    """

    values: Floats
    vectors: list[Floats]
    certified: float
    n_certified: int = 0
    retries: list[str] = field(default_factory=list)

    def add(self, values: Floats, vectors: Floats) -> None:
        """Take in new pairs, one a row of `vectors`."""
        together = np.concatenate([self.values, values])
        rows = [*self.vectors, *vectors]
        order = np.argsort(together, kind="stable")
        self.values = together[order]
        self.vectors = [rows[i] for i in order]

    def replace_above(self, kept: int, run: LanczosRun, first: int) -> None:
        """Keep `kept` pairs above the certified ones, then go on with the run's from `first`."""
        height = self.n_certified + kept
        self.values = np.concatenate([self.values[:height], run.values[first:]])
        self.vectors = [*self.vectors[:height], *run.vectors(first)]

    def certify(self, factors: ShiftedFactorization) -> None:
        """Note that every eigenvalue under the shift is on the ladder."""
        self.certified, self.n_certified = factors.shift, factors.n_below

    def from_value(self, low: float, n: int) -> Floats:
        """Eigenvectors with eigenvalues from `low` up, one a row, shape (c, n)."""
        rows = self.vectors[int(np.searchsorted(self.values, low)) :]
        return np.stack(rows) if rows else np.empty((0, n))

    def n_below(self, value: float) -> int:
        """How many eigenvalues on the ladder lie below `value`."""
        return int(np.searchsorted(self.values, value))


@dataclass(frozen=True, eq=False)
class LowestPairs:
    """The lowest eigenpairs of a matrix, none missing.

    Attributes
    ----------
    values, vectors
        Eigenvalues, shape (c,), ascending, and nearly orthonormal eigenvectors, one a row, shape
        (c, n).
    complete_below
        No eigenvalue under this is missing; above the last of `values`.
    retries
        What had to be searched for again, one phrase each.
    """

    values: Floats
    vectors: Floats
    complete_below: float
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
    """More than `count` lowest eigenpairs of a symmetric positive semi-definite matrix.

    Parameters
    ----------
    matrix
        Sparse, symmetric, shape (n, n).
    count
        How many are wanted, well below n; a few more come back.
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
    ladder = _Ladder(np.empty(0), [], certified=-1 / density)
    workers.report("harmonics", 0, count)
    while ladder.n_certified <= count:
        shifts = _next_shifts(matrix, symbolic, ladder, count=count, density=density)
        found, width = shifts[-1].n_below - ladder.n_certified, shifts[-1].shift - ladder.certified
        density = max(found, 1) / width
        move = partial(factorize, matrix, symbolic=symbolic)
        _climb(shifts, ladder, move, rng=rng, workers=workers)
        workers.report("harmonics", min(ladder.n_certified, count), count)
    vectors = np.stack(ladder.vectors[: ladder.n_certified])
    values = ladder.values[: ladder.n_certified]
    return LowestPairs(values, vectors, ladder.certified, tuple(ladder.retries))


def needed_bytes(symbolic: SymbolicFactorization, count: int) -> int:
    """Memory that the search takes at its highest, with what is made of its result."""
    n = len(symbolic.plan.order)
    runs = _AT_ONCE * (symbolic.n_bytes + 8 * n * _LIKELY_VECTORS)
    return runs + 8 * count * (_COPIES * n + 2 * count)


def _next_shifts(
    matrix: sparse.csc_array,
    symbolic: SymbolicFactorization,
    ladder: _Ladder,
    *,
    count: int,
    density: float,
) -> tuple[ShiftedFactorization, ...]:
    """The next shifts up, to be searched around at one time; the last of all only just beyond."""
    known, low, n_low = len(ladder.values), ladder.certified, ladder.n_certified
    reach = _reach(matrix.shape[0])
    shifts: list[ShiftedFactorization] = []
    while len(shifts) < _AT_ONCE and n_low <= count:
        highest = min(count + 3, known + reach)
        factors = _next_shift(
            matrix, symbolic, (low, n_low, known), highest=highest, density=density
        )
        shifts.append(factors)
        density = max(factors.n_below - n_low, 1) / (factors.shift - low)
        low, n_low, known = factors.shift, factors.n_below, factors.n_below + reach
    return tuple(shifts)


def _steady(
    matrix: sparse.csc_array, symbolic: SymbolicFactorization, shift: float, density: float
) -> ShiftedFactorization:
    """Factors at a shift or just beside it, where solves are right without refinement.

    How much is lost to poor pivots changes from one shift to the next, by a hundred times.
    """
    tried: list[ShiftedFactorization] = []
    for aside in _ASIDE:
        tried.append(factorize(matrix, shift + aside / density, symbolic=symbolic))
        if tried[-1].backward_error <= _STEADY:
            return tried[-1]
    return min(tried, key=lambda factors: factors.backward_error)


def _reach(n_vertices: int) -> int:
    return round(_REACH * max(1.0, n_vertices / _REACH_VERTICES) ** 0.25)


def _next_shift(
    matrix: sparse.csc_array,
    symbolic: SymbolicFactorization,
    height: tuple[float, int, int],
    *,
    highest: int,
    density: float,
) -> ShiftedFactorization:
    """The next shift up: half a slice above what is known, and not many more than that.

    `height` is the shift below, the number of eigenvalues under it, and of those known; `highest`
    the number of eigenvalues that are to lie below.
    """
    low, n_low, known = height
    step = max(highest - n_low, 3) / density
    factors = _steady(matrix, symbolic, low + step, density)
    while factors.n_below - known > 2 * _reach(matrix.shape[0]):
        step /= 2
        nearer = _steady(matrix, symbolic, low + step, density)
        if nearer.n_below <= known:
            break  # a cluster wider than a slice: climb it whole
        factors = nearer
    return factors


def _climb(
    shifts: Sequence[ShiftedFactorization],
    ladder: _Ladder,
    move: Callable[[float], ShiftedFactorization],
    *,
    rng: np.random.Generator,
    workers: Workers,
) -> None:
    """Put every eigenpair under the shifts on the ladder, and those found on the way above them.

    A shift that turns out too near an eigenvalue is moved: `move` factors at another.
    """
    between = np.diff([ladder.n_certified, *(factors.n_below for factors in shifts)])
    runs = [
        workers.submit(
            _run,
            factors,
            own,
            partial(_lacks, ladder, n_below=n_here, n_above=n_above, first=not i),
            workers.pause,
            move,
        )
        for i, (factors, own, n_here, n_above) in enumerate(
            zip(shifts, rng.spawn(len(shifts)), between, [*between[1:], 0], strict=True)
        )
    ]
    for submitted in runs:
        run = workers.result(submitted)
        factors = run.factors
        workers.result(workers.submit(run.until, partial(_gap_left, ladder, factors)))
        junction = _junction(ladder, run.values, factors)
        if junction is None:
            _search(factors, ladder, rng=rng, workers=workers)
        else:
            ladder.replace_above(junction[0], run, junction[1])
        ladder.certify(factors)


def _run(
    factors: ShiftedFactorization,
    rng: np.random.Generator,
    criterion: Callable[[ShiftedFactorization], Callable[[Floats], int]],
    pause: Callable[[], None],
    move: Callable[[float], ShiftedFactorization],
) -> LanczosRun:
    nothing = np.empty((0, factors.size))
    missing = criterion(factors)
    effort = _effort(factors, missing(np.empty(0)))
    run = LanczosRun(factors, nothing, effort=effort, rng=rng, pause=pause)
    better = _better_shift(run.until(missing))
    if better is None:
        return run
    moved = move(better)
    again = LanczosRun(moved, nothing, effort=effort, rng=rng, pause=pause)
    return again.until(criterion(moved))


def _better_shift(run: LanczosRun) -> float | None:
    """The middle of the widest gap nearby, if the shift lies next to an eigenvalue; else None.

    Solves there are right to rounding of the nearest eigenvector's part, which swamps what
    belongs to eigenvalues far from the shift.
    """
    distances = np.abs(run.values - run.factors.shift)
    around = np.sort(run.values[np.argsort(distances)[:_AROUND]])
    if len(around) < _AROUND:
        return None
    spacing = np.ptp(run.values) / len(run.values)
    if distances.min() > _TOO_NEAR * spacing:
        return None
    widest = int(np.argmax(np.diff(around)))
    return float(around[widest] + around[widest + 1]) / 2


def _lacks(
    ladder: _Ladder, factors: ShiftedFactorization, *, n_below: int, n_above: int, first: bool
) -> Callable[[Floats], int]:
    """How much a run lacks of what lies next to its shift: all below, or half of it each way.

    The first of several joins the ladder; the others are searched before it has grown to them.
    """
    above = (n_above + _MARGIN) // 2
    known = len(ladder.values) - ladder.n_certified if first else n_below // 2
    below = max(n_below - known, 0) + _MARGIN // 2

    def missing(values: Floats) -> int:
        found_below = int(np.searchsorted(values, factors.shift))
        short = max(above - (len(values) - found_below), 0)
        if not (first and _joins(ladder, factors, values)):
            # What is found below may be enough by number and yet not join.
            short = max(short, below - found_below, 1 if first else 0)
        return 2 * short

    return missing


def _joins(ladder: _Ladder, factors: ShiftedFactorization, values: Floats) -> bool:
    return _junction(ladder, values, factors) is not None


def _gap_left(ladder: _Ladder, factors: ShiftedFactorization, values: Floats) -> int:
    return 0 if _joins(ladder, factors, values) else _MARGIN


def _junction(
    ladder: _Ladder, values: Floats, factors: ShiftedFactorization
) -> tuple[int, int] | None:
    """Where what two neighbouring shifts found between them joins, if together it is complete.

    Far from its shift a run finds some eigenvalues and misses others. Up to a gap the lower
    shift's pairs are taken and from there on the upper shift's; if their number is what inertia
    says, none is missing. Of several such gaps the widest is taken.

    Returns
    -------
    How many of the ladder's pairs above the certified ones to keep, and the index in `values` to
    go on from; None if something is missing.
    """
    low = np.concatenate([[ladder.certified], ladder.values[ladder.n_certified :]])
    close = _AGREEMENT * (factors.shift - ladder.certified)
    end = int(np.searchsorted(values, factors.shift))
    following = np.searchsorted(values, low + close)
    complete = np.arange(len(low)) + end - following == factors.n_below - ladder.n_certified
    gaps = np.append(values[:end], factors.shift)[np.minimum(following, end)] - low
    complete &= gaps > close
    if not complete.any():
        return None
    kept = int(np.argmax(np.where(complete, gaps, -np.inf)))
    return kept, int(following[kept])


def _search(
    factors: ShiftedFactorization,
    ladder: _Ladder,
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
        known = ladder.from_value(ladder.certified - reach, factors.size)
        effort = _search_effort(factors, block)
        run = LanczosRun(factors, known, effort=effort, rng=rng, pause=workers.pause)
        workers.result(workers.submit(run.until))
        # Under the certified height everything is known: what is met there again is left.
        fresh = int(np.searchsorted(run.values, ladder.certified, side="right"))
        ladder.add(run.values[fresh:], run.vectors(fresh))
        before, missing = missing, factors.n_below - ladder.n_below(factors.shift)
        fruitless = fruitless + 1 if missing >= before and block == _WIDEST_BLOCK else 0
        block, attempt = min(2 * block, _WIDEST_BLOCK), attempt + 1
    if missing:
        raise SolverError(
            f"{factors.n_below} eigenvalues counted below {factors.shift:.6g}/mm² but "
            f"{factors.n_below - missing} found: is the surface degenerate?"
        )


def _effort(factors: ShiftedFactorization, n_pairs: int) -> Effort:
    most = min(_MOST_VECTORS, factors.size // 2) // _BLOCK
    first = _BLOCKS_UNTIL_FIRST + int(VECTORS_PER_PAIR * n_pairs) // _BLOCK
    return Effort(_BLOCK, min(first, most), most, _TOLERANCE)


def _search_effort(factors: ShiftedFactorization, block: int) -> Effort:
    steps = min(_SEARCH_STEPS, factors.size // (2 * block))
    return Effort(block, steps, steps, _TOLERANCE)
