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
from auricle.spectral.lanczos import VECTORS_PER_PAIR, Effort, LanczosRun
from auricle.spectral.memory import require_memory
from auricle.spectral.narrow_products import aligned_groups
from auricle.spectral.shifts import (
    AT_ONCE,
    BEYOND,
    Factorable,
    NextShifts,
    gap_above,
    next_shifts,
    widest_gap,
)
from auricle.spectral.workers import Workers

_TOLERANCE = 1e-11
"""Of pairs that count as converged."""
_RUN, _LARGE_RUN, _LARGE = (4, 17, _TOLERANCE), (8, 15, 1e-10), 60_000
"""Of a run: width of its block, blocks before the first pair converges, tolerance; and from how
many vertices on they are others. There factors are far from the processor, so that to read them
less often is worth more than to make few vectors; and rounding leaves as much as that tolerance.
"""
_SEARCH_BLOCK, _WIDEST_BLOCK = 8, 32
"""Width in searches for what is missing, which widens.

Clusters of equal eigenvalues wider than the block show one block's width of copies a run.
"""
_AT_THE_BOTTOM = 7
"""Blocks before the first pair converges where nothing lies further down; each further pair takes
`VECTORS_PER_PAIR` vectors."""
_MOST_VECTORS, _SEARCH_STEPS = 800, 40
"""Length of a run: at most, in vectors; and of a search, in blocks."""
_MARGIN = 4
"""Pairs more than needed, half of them each way, that let neighbouring runs overlap."""
_GLANCE, _TOO_NEAR, _AROUND = 8, 0.03, 8
"""Blocks after which a run is looked at for an eigenvalue next to its shift; share of the mean
spacing that is too near; and how many eigenvalues around it show the gap it moves to."""
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
    n_groups = _MOST_VECTORS // _SEARCH_BLOCK + 1
    bases = [aligned_groups(n_groups, n, _SEARCH_BLOCK) for _ in range(workers.threads)]
    workers.report("harmonics", 0, count)
    ended = False
    while not ended:
        low, n_low = ladder.certified, ladder.n_certified
        # Not named: factors are let go before the next are made.
        ended = _climb(
            next_shifts(factorable, ladder, count=count, density=density, workers=workers),
            ladder,
            factorable.at,
            bases=bases,
            rng=rng,
            workers=workers,
        )
        ended = ended or ladder.n_certified > count
        density = max(ladder.n_certified - n_low, 1) / (ladder.certified - low)
        workers.report("harmonics", min(ladder.n_certified, count), count)
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


def _climb(
    shifts: NextShifts,
    ladder: Ladder,
    move: Callable[[float], ShiftedFactorization],
    *,
    bases: Sequence[Floats],
    rng: np.random.Generator,
    workers: Workers,
) -> bool:
    """Put every eigenpair under the shifts on the ladder, and those found on the way above them.

    A shift that turns out too near an eigenvalue is moved: `move` factors at another. Returns
    whether all that is wanted is certified.
    """
    searched = shifts.searched
    following: list[ShiftedFactorization | None] = [*searched[1:], None]
    jobs = [
        partial(
            _run,
            factors,
            own,
            partial(_lacks, ladder, lower=lower, higher=higher, wanted=shifts.wanted),
            workers.pause,
            move,
            bases[i % len(bases)],
        )
        for i, (factors, own, lower, higher) in enumerate(
            zip(searched, rng.spawn(len(searched)), [None, *searched], following, strict=False)
        )
    ]
    begun = [workers.submit(job) for job in jobs[: len(bases)]]
    ceiling = shifts.ceiling
    for i in range(len(jobs)):
        run = workers.result(begun[i])
        factors = run.factors
        workers.result(workers.submit(run.until, partial(_gap_left, ladder, factors)))
        joint = junction(ladder, run.values, factors)
        if joint is None:
            _search(factors, ladder, rng=rng, workers=workers)
        elif shifts.wanted is not None and i == len(jobs) - 1:
            ceiling = _completed(run, ladder, joint, (shifts.wanted, move), workers)
        else:
            _put(run, ladder, joint, None, workers)
        ladder.certify(factors)
        if i < len(jobs) - 1:
            # Neighbours ask for its count only, and the next factors have its room.
            factors.let_go()
        # Not before its basis is free.
        begun.extend(workers.submit(job) for job in jobs[len(begun) : i + 1 + len(bases)])
    if ceiling is not None:
        _search(ceiling, ladder, rng=rng, workers=workers)
        ladder.certify(ceiling)
    return ceiling is not None


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


def _run(
    factors: ShiftedFactorization,
    rng: np.random.Generator,
    criterion: Callable[[ShiftedFactorization], Callable[[Floats], int]],
    pause: Callable[[], None],
    move: Callable[[float], ShiftedFactorization],
    numbers: Floats,
) -> LanczosRun:
    nothing = np.empty((factors.size, 0))
    missing = criterion(factors)
    effort = _effort(factors, missing(np.empty(0)))
    run = LanczosRun(factors, nothing, effort=effort, rng=rng, pause=pause, numbers=numbers)
    better = _better_shift(run.glance(_GLANCE), factors.shift)
    if better is not None:
        factors = move(better)
        missing = criterion(factors)
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


def _lacks(
    ladder: Ladder,
    factors: ShiftedFactorization,
    *,
    lower: ShiftedFactorization | None,
    higher: ShiftedFactorization | None,
    wanted: int | None,
) -> Callable[[Floats], int]:
    """How much a run lacks of what lies next to its shift.

    Half of what lies between it and a neighbour is its part, and all that is wanted and a few more
    if it is the last. The first of several joins the ladder; the others are searched before it has
    grown to them.
    """
    first = lower is None
    known = len(ladder.values) - ladder.n_certified
    n_below = factors.n_below - (ladder.n_certified if lower is None else lower.n_below)
    below = max(n_below - known if first else -(-n_below // 2), 0) + _MARGIN // 2
    above = _MARGIN // 2
    if higher is not None:
        above += (higher.n_below - factors.n_below) // 2
    elif wanted is not None:
        above = wanted + BEYOND - factors.n_below

    def missing(values: Floats) -> int:
        found_below = int(np.searchsorted(values, factors.shift))
        short = max(above - (len(values) - found_below), 0)
        if not (first and _joins(ladder, factors, values)):
            # What is found below may be enough by number and yet not join.
            short = max(short, below - found_below, 1 if first else 0)
        return 2 * short

    return missing


def _joins(ladder: Ladder, factors: ShiftedFactorization, values: Floats) -> bool:
    return junction(ladder, values, factors) is not None


def _gap_left(ladder: Ladder, factors: ShiftedFactorization, values: Floats) -> int:
    return 0 if _joins(ladder, factors, values) else _MARGIN


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


def _effort(factors: ShiftedFactorization, n_pairs: int) -> Effort:
    block, until_first, tolerance = _RUN if factors.size < _LARGE else _LARGE_RUN
    most = min(_MOST_VECTORS, factors.size // 2) // block
    at_the_bottom = factors.n_below <= n_pairs // 2 + _MARGIN
    first = _AT_THE_BOTTOM if at_the_bottom else until_first
    first += int(VECTORS_PER_PAIR * n_pairs) // block
    return Effort(block, min(first, most), most, tolerance)


def _search_effort(factors: ShiftedFactorization, block: int) -> Effort:
    steps = min(_SEARCH_STEPS, factors.size // (2 * block))
    return Effort(block, steps, steps, _TOLERANCE)
