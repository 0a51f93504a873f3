"""Spectrum slicing: the lowest eigenpairs of a sparse matrix, none missing.

The spectrum is climbed by shifts. At each the inertia of the factorisation tells how many
eigenvalues lie below, so that every pair has an absolute index and a missing one is noticed and
searched for again. ARPACK alone loses copies of repeated eigenvalues without a word.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy import sparse

from auricle.arrays import Floats
from auricle.errors import SolverError
from auricle.progress import Progress, silent
from auricle.spectral.factorization import (
    ShiftedFactorization,
    SymbolicFactorization,
    analyze,
    factorize,
)
from auricle.spectral.lanczos import RitzPairs, eigenpairs_near

_BLOCK, _WIDEST_BLOCK, _STEPS = 8, 32, 40
"""A Lanczos run of 40 steps with blocks of 8 finds 70 to 90 pairs of a generic surface.

Clusters of equal eigenvalues wider than the block show one block's width of copies a run; the
block widens from one search to the next and the number of steps, on which convergence rests, stays.
"""
_REACH = 34
"""Eigenvalues a run is trusted to find below its shift; it finds about as many above."""
_SLICE = 2 * _REACH
_TOLERANCE = 1e-11
_AGREEMENT = 1e-8
_RETRIES = 60


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
        """Take in new pairs, one a column of `vectors`."""
        together = np.concatenate([self.values, values])
        columns = [*self.vectors, *vectors.T]
        order = np.argsort(together, kind="stable")
        self.values = together[order]
        self.vectors = [columns[i] for i in order]

    def replace_above(self, kept: int, pairs: RitzPairs, first: int) -> None:
        """Keep `kept` pairs above the certified ones, then go on with `pairs` from `first`."""
        height = self.n_certified + kept
        self.values = np.concatenate([self.values[:height], pairs.values[first:]])
        self.vectors = [*self.vectors[:height], *pairs.vectors[:, first:].T]

    def from_value(self, low: float, n: int) -> Floats:
        """Eigenvectors with eigenvalues from `low` up, shape (n, c)."""
        columns = self.vectors[int(np.searchsorted(self.values, low)) :]
        return np.stack(columns, axis=1) if columns else np.empty((n, 0))

    def n_below(self, value: float) -> int:
        """How many eigenvalues on the ladder lie below `value`."""
        return int(np.searchsorted(self.values, value))


@dataclass(frozen=True, eq=False)
class LowestPairs:
    """The lowest eigenpairs of a matrix, none missing.

    Attributes
    ----------
    values, vectors
        Eigenvalues, shape (c,), ascending, and nearly orthonormal eigenvectors, shape (n, c).
    retries
        What had to be searched for again, one phrase each.
    """

    values: Floats
    vectors: Floats
    retries: tuple[str, ...]


def lowest_eigenpairs(
    matrix: sparse.csc_array,
    count: int,
    *,
    density: float,
    rng: np.random.Generator,
    progress: Progress = silent,
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
    progress
        Told the number of eigenvalues certified.

    Raises
    ------
    SolverError
        If eigenvalues that inertia counts cannot be found after many restarts.
    """
    symbolic = analyze(matrix)
    ladder = _Ladder(np.empty(0), [], certified=-1 / density)
    while ladder.n_certified <= count:
        factors = _next_shift(matrix, symbolic, ladder, count=count, density=density)
        _climb(factors, ladder, rng=rng)
        found, width = factors.n_below - ladder.n_certified, factors.shift - ladder.certified
        density = max(found, 1) / width
        ladder.certified, ladder.n_certified = factors.shift, factors.n_below
        progress("harmonics", min(ladder.n_certified, count), count)
    vectors = np.stack(ladder.vectors[: ladder.n_certified], axis=1)
    values = ladder.values[: ladder.n_certified]
    return LowestPairs(values, vectors, tuple(ladder.retries))


def _next_shift(
    matrix: sparse.csc_array,
    symbolic: SymbolicFactorization,
    ladder: _Ladder,
    *,
    count: int,
    density: float,
) -> ShiftedFactorization:
    """The next shift up: half a slice above what is known, and not many more than that."""
    known = len(ladder.values)
    wanted = min(count + 3, known + _REACH) - ladder.n_certified
    step = max(wanted, 3) / density
    factors = factorize(matrix, ladder.certified + step, symbolic=symbolic)
    while factors.n_below - known > _SLICE:
        step /= 2
        nearer = factorize(matrix, ladder.certified + step, symbolic=symbolic)
        if nearer.n_below <= known:
            break  # a cluster wider than a slice: climb it whole
        factors = nearer
    return factors


def _climb(factors: ShiftedFactorization, ladder: _Ladder, *, rng: np.random.Generator) -> None:
    """Put every eigenpair under the shift on the ladder, and those found on the way above it."""
    alone = np.empty((factors.size, 0))
    pairs = _nearest(factors, alone, _BLOCK, rng)
    if not _splice(ladder, pairs, factors):
        _search(factors, ladder, rng=rng)


def _splice(ladder: _Ladder, pairs: RitzPairs, factors: ShiftedFactorization) -> bool:
    """Join what two neighbouring shifts found between them, if together it is complete.

    The lower shift's pairs are taken up to a gap and the upper shift's from there on. The number
    must be what inertia says, and where both reach over the gap their eigenvalues must agree.
    """
    low = ladder.values[ladder.n_certified :]
    high = pairs.values[pairs.values > ladder.certified]
    close = _AGREEMENT * (factors.shift - ladder.certified)
    n_between = factors.n_below - ladder.n_certified
    n_high = int(np.searchsorted(high, factors.shift))
    first = n_between - n_high  # how many the upper shift did not reach
    if not (len(high) and 0 <= first <= len(low)):
        return False
    overlap = min(len(low), n_between) - first
    if np.abs(low[first : first + overlap] - high[:overlap]).max(initial=0.0) > close:
        return False
    joined = np.concatenate([[ladder.certified], low[:first], high])
    gaps = np.diff(joined)[first : first + overlap + 1]
    cut = int(np.argmax(gaps))
    if gaps[cut] < close:
        return False
    ladder.replace_above(first + cut, pairs, len(pairs.values) - len(high) + cut)
    return True


def _search(factors: ShiftedFactorization, ladder: _Ladder, *, rng: np.random.Generator) -> None:
    """Look for what is missing under the shift among all that is orthogonal to what is known."""
    reach = factors.shift - ladder.certified
    block, attempt = _BLOCK, 0
    missing = factors.n_below - ladder.n_below(factors.shift)
    while missing > 0 and attempt < _RETRIES:
        ladder.retries.append(f"{missing} eigenvalues below {factors.shift:.6g}/mm²")
        known = ladder.from_value(ladder.certified - reach, factors.size)
        pairs = _nearest(factors, known, block, rng)
        # Under the certified height everything is known: what is met there again is left.
        fresh = pairs.values > ladder.certified
        ladder.add(pairs.values[fresh], pairs.vectors[:, fresh])
        missing = factors.n_below - ladder.n_below(factors.shift)
        block, attempt = min(2 * block, _WIDEST_BLOCK), attempt + 1
    if missing:
        raise SolverError(
            f"{factors.n_below} eigenvalues counted below {factors.shift:.6g}/mm² but "
            f"{factors.n_below - missing} found: is the surface degenerate?"
        )


def _nearest(
    factors: ShiftedFactorization, known: Floats, block: int, rng: np.random.Generator
) -> RitzPairs:
    return eigenpairs_near(
        factors,
        known,
        block=block,
        n_steps=min(_STEPS, factors.size // (2 * block)),
        tolerance=_TOLERANCE,
        rng=rng,
    )
