"""Block Lanczos iteration on a shifted inverse: the eigenpairs nearest to one shift."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy import linalg

from auricle.arrays import Floats
from auricle.spectral.factorization import ShiftedFactorization
from auricle.spectral.gram_schmidt import orthogonalize, orthonormalize
from auricle.spectral.lanczos_steps import LEAST_LOST, Lost, Recurrence, take_steps
from auricle.spectral.narrow_products import aligned_groups
from auricle.spectral.ritz_vectors import Combinations, fill_combinations
from auricle.spectral.workers import Workers, slices

VECTORS_PER_PAIR = 2.2
"""By which the basis grows for each further pair that converges, where eigenvalues lie evenly."""
_MOST_LEFT = 2e-11
"""How far from orthogonal to the basis a block may be that is left as it is."""
_ROUGH = 0.1
"""Residual, relative to the inverse eigenvalue, of those that are told at a glance."""
_FEWEST_MORE = 2
"""Blocks between two looks at convergence."""
_ENTRIES_AT_ONCE = 400_000
"""Entries of the vectors that are made between two pauses, some thousandths of a second apart."""
_PARTS = 8
"""Into which the entries of what is found are cut: who is done with a run takes part at once."""


@dataclass(frozen=True)
class Effort:
    """How much a run may take.

    Attributes
    ----------
    block
        Width of the block, 4 or a multiple of 8: the most copies of one eigenvalue that are sure to
        be found.
    first, most
        Numbers of blocks after which convergence is first looked at, and that a run ends with.
    tolerance
        A pair counts as converged when the residual of its inverse eigenproblem, relative to its
        inverse eigenvalue, is below this.
    """

    block: int
    first: int
    most: int
    tolerance: float

    @property
    def lanes(self) -> int:
        """Vectors in a group of the basis."""
        return min(self.block, 8)

    def room(self, n_known: int) -> int:
        """Groups that a run may take beside so many known vectors."""
        return -(-n_known // self.lanes) + self.block // self.lanes * (self.most + 1)


class LanczosRun:
    """A search for the eigenpairs nearest to a shift, apart from those already known.

    Block Lanczos with partial reorthogonalisation, on the inverse of (matrix − shift·I), started
    at random and kept orthogonal to what is known, so what it finds is new, also within a cluster
    of equal eigenvalues. It can be taken up again where it ended.

    Parameters
    ----------
    factors
        Of the shifted matrix.
    known
        Orthonormal eigenvectors to stay orthogonal to, one a column, shape (n, c); c may be 0.
    effort
        Width and length of the run.
    rng
        Source of the starting block.
    pause
        Called before every step; may raise to end the run.
    numbers
        Room for the basis, of whatever content, at least `effort.room` groups; the run's own unless
        given. Vectors can be had until it is used for something else.

    Attributes
    ----------
    factors
        As given.
    values
        Eigenvalues that have converged, ascending.

    References
    ----------
    Grimes, Lewis & Simon 1994, "A shifted block Lanczos algorithm …".
    """

    def __init__(
        self,
        factors: ShiftedFactorization,
        known: Floats,
        *,
        effort: Effort,
        rng: np.random.Generator,
        pause: Callable[[], None],
        numbers: Floats | None = None,
    ) -> None:
        self._pause = pause
        self.factors, self.values = factors, np.empty(0)
        self._effort, self._n_steps = effort, 0
        lanes, n, n_groups = effort.lanes, factors.size, effort.room(known.shape[1])
        # Filled as the run grows: what is never reached takes no memory.
        if numbers is None:
            numbers = aligned_groups(n_groups, n, lanes)
        basis = numbers.reshape(-1)[: n_groups * n * lanes].reshape(n_groups, n, lanes)
        self._n_known = -(-known.shape[1] // lanes)
        basis[: self._n_known] = 0.0
        for group, first in zip(basis, range(0, known.shape[1], lanes), strict=False):
            some = known[:, first : first + lanes]
            group[:, : some.shape[1]] = some
        self._weights = np.empty((0, 0))
        start = basis[self._n_known : self._n_known + effort.block // lanes]
        start[:] = rng.standard_normal((n, len(start), lanes)).swapaxes(0, 1)
        left = orthogonalize(basis[: self._n_known], start).products
        projected = np.zeros((effort.block * effort.most, effort.block * effort.most))
        self._recurrence = Recurrence(basis, projected, orthonormalize(start, left))
        self._lost = Lost(0.0, LEAST_LOST, _MOST_LEFT, LEAST_LOST, LEAST_LOST, 0)

    def until(self, missing: Callable[[Floats], int] | None = None) -> Self:
        """Go on until no converged eigenvalue is missing, or the effort is spent.

        `missing` is told `values` whenever convergence is looked at, and how soon that is next
        depends on what it says; without it all the effort is spent.
        """
        n_missing = missing(self.values) if missing else 1
        while n_missing and self._n_steps < self._effort.most:
            more = -(-int(VECTORS_PER_PAIR * n_missing) // self._effort.block)
            n_steps = max(self._n_steps + max(more, _FEWEST_MORE), self._effort.first)
            self._extend(min(n_steps if missing else self._effort.most, self._effort.most))
            self._converge()
            n_missing = missing(self.values) if missing else 0
        return self

    def glance(self, n_steps: int) -> Floats:
        """Rough eigenvalues after so few steps, those that are nearest to the shift first."""
        self._extend(min(n_steps, self._effort.most))
        inverses, _, leftover = self._ritz()
        rough = inverses[np.linalg.norm(leftover, axis=0) <= _ROUGH * np.abs(inverses)]
        nearest_first: Floats = rough[np.argsort(-np.abs(rough))]
        return self.factors.shift + 1 / nearest_first

    def vectors(self, first: int, workers: Workers) -> Floats:
        """Orthonormal eigenvectors of `values` from index `first` on, as columns, shape (n, c)."""
        found = np.empty((self.factors.size, len(self.values) - first))
        self.fill_vectors(first, found, workers=workers)
        return found

    def fill_vectors(self, first: int, columns: Floats, *, workers: Workers) -> None:
        """Set columns to the first of what `vectors` returns, in parts made side by side."""
        n_groups = len(self._weights) // self._effort.lanes
        own = self._recurrence.basis[self._n_known : self._n_known + n_groups]
        weights = self._weights[:, first : first + columns.shape[1]]
        combinations = Combinations.of(np.ascontiguousarray(weights.T))

        def fill(some: slice) -> None:
            fill_combinations(own, combinations, columns, some)

        workers.each(fill, slices(len(columns), -(-len(columns) // _PARTS)))

    def _extend(self, n_steps: int) -> None:
        """Lengthen the basis to `n_steps` blocks and the one that follows them."""
        at_once = max(_ENTRIES_AT_ONCE // (self.factors.size * self._effort.block), 1)
        solver = self.factors.solver()
        for begin in range(self._n_steps, n_steps, at_once):
            self._pause()
            steps = (begin, min(begin + at_once, n_steps))
            self._lost = take_steps(solver, self._recurrence, self._lost, self._n_known, steps)
        self._n_steps = max(n_steps, self._n_steps)

    def _ritz(self) -> tuple[Floats, Floats, Floats]:
        """Ritz values of the inverse, weights in the basis, and what couples these onwards."""
        size = self._n_steps * self._effort.block
        inverses, rotations = _eigenpairs(self._recurrence.projected[:size, :size])
        leftover = self._recurrence.coupling.T @ rotations[-self._effort.block :]
        return inverses, rotations, leftover

    def _converge(self) -> None:
        """Look at which eigenvalues have converged, and their weights in the basis."""
        inverses, rotations, leftover = self._ritz()
        good = np.linalg.norm(leftover, axis=0) <= self._effort.tolerance * np.abs(inverses)
        values = self.factors.shift + 1 / inverses[good]
        chosen = np.flatnonzero(good)[np.argsort(values)]
        # One more step of inverse iteration costs nothing here: it is the basis's next block.
        weights = np.concatenate([rotations[:, chosen], leftover[:, chosen] / inverses[chosen]])
        self.values, self._weights = np.sort(values), weights / np.linalg.norm(weights, axis=0)


def _eigenpairs(matrix: Floats) -> tuple[Floats, Floats]:
    """Of a small symmetric matrix, ascending, vectors as columns.

    LAPACK divides and conquers, which once in very many matrices does not come to an end; then the
    slower method of old takes its place.
    """
    try:
        values, vectors = np.linalg.eigh(matrix)
    except np.linalg.LinAlgError:
        values, vectors = linalg.eigh(matrix, driver="ev")
    return values, vectors
