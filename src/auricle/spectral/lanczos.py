"""Block Lanczos iteration on a shifted inverse: the eigenpairs nearest to one shift."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

import numpy as np

from auricle.arrays import Floats
from auricle.spectral.factorization import ShiftedFactorization
from auricle.spectral.gram_schmidt import aligned_rows, lengths, orthogonalize, orthonormalize
from auricle.spectral.workers import Workers

VECTORS_PER_PAIR = 2.2
"""By which the basis grows for each further pair that converges, where eigenvalues lie evenly."""
_LEAST_LOST, _MOST_LOST, _MOST_LEFT = 1e-15, 1e-7, 5e-12
"""How far a block is from orthogonal to the basis once it was made so; how far one may be before
that; and how far one that is left as it is."""
_ROUGH = 0.1
"""Residual, relative to the inverse eigenvalue, of those that are told at a glance."""
_FEWEST_MORE = 2
"""Blocks between two looks at convergence."""


@dataclass(frozen=True)
class Effort:
    """How much a run may take.

    Attributes
    ----------
    block
        Width of the block: the most copies of one eigenvalue that are sure to be found.
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
        Orthonormal eigenvectors to stay orthogonal to, one a row, shape (c, n); c may be 0.
    effort
        Width and length of the run.
    rng
        Source of the starting block.
    pause
        Called before every step; may raise to end the run.

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
    ) -> None:
        self._pause = pause
        self._scale, self._least, self._lost = 0.0, _LEAST_LOST, (_LEAST_LOST, _LEAST_LOST)
        self.factors, self.values = factors, np.empty(0)
        self._effort, self._n_known, self._n_steps = effort, len(known), 0
        block, most_steps = effort.block, effort.most
        # Filled as the run grows: what is never reached takes no memory.
        self._basis = aligned_rows(len(known) + block * (most_steps + 1), factors.size)
        self._put(0, known)
        self._projected = np.zeros((block * most_steps, block * most_steps))
        self._weights = np.empty((0, 0))
        start = self._put(len(known), rng.standard_normal((factors.size, block)).T)
        orthogonalize(self._basis[: len(known)], start)
        self._coupling = orthonormalize(start)

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
        """Orthonormal eigenvectors of `values` from index `first` on, one a row, shape (c, n)."""
        found = np.empty((len(self.values) - first, self.factors.size))
        self.fill_vectors(first, found, workers=workers)
        return found

    def fill_vectors(self, first: int, rows: Floats, *, workers: Workers) -> None:
        """Set rows to what `vectors` returns, in two halves that are made side by side."""
        own = self._basis[self._n_known : self._n_known + len(self._weights)]
        weights = np.ascontiguousarray(self._weights[:, first:].T)
        half = self.factors.size // 2

        def fill(some: slice) -> None:
            np.matmul(weights, own[:, some], out=rows[:, some])

        workers.each(fill, [slice(0, half), slice(half, self.factors.size)])

    def _extend(self, n_steps: int) -> None:
        """Lengthen the basis to `n_steps` blocks and the one that follows them."""
        for step in range(self._n_steps, n_steps):
            self._pause()
            end = self._n_known + (step + 1) * self._effort.block
            last = self._basis[end - self._effort.block : end]
            image = self._basis[end : end + self._effort.block]
            image[:, self.factors.size :] = 0.0
            self.factors.solve_rows(last, image)
            diagonal = self._orthogonalized(end)
            here = slice(step * self._effort.block, (step + 1) * self._effort.block)
            self._projected[here, here] = (diagonal + diagonal.T) / 2
            if step:
                before = slice(here.start - self._effort.block, here.start)
                self._projected[before, here] = self._coupling
                self._projected[here, before] = self._coupling.T
            self._coupling = orthonormalize(image)
        self._n_steps = max(n_steps, self._n_steps)

    def _put(self, place: int, rows: Floats) -> Floats:
        """Set rows of the basis from a place on, and what fills them up to 0; returns them."""
        target = self._basis[place : place + len(rows)]
        target[:, : self.factors.size], target[:, self.factors.size :] = rows, 0.0
        return target

    def _orthogonalized(self, end: int) -> Floats:
        """Make the image of a block orthogonal to the basis; returns its part in that block.

        In exact arithmetic the last two blocks would do. Rounding leaves some of the others behind,
        and every step that looks at the last two only enlarges that, by the ratio of the operator
        to what is left of the image. All are taken out of the last block and the image, which is
        what goes into the steps that follow (Simon 1984, partial reorthogonalisation), as soon as
        the last block has more of them than may stay in the basis, or the image far more.
        """
        block = self._effort.block
        image = self._basis[end : end + block]
        inside = orthogonalize(self._basis[max(end - 2 * block, 0) : end], image)
        if self._n_known:
            inside[-block:] += orthogonalize(self._basis[:end], image)[-block:]
            return inside[-block:]
        self._scale = max(self._scale, float(np.linalg.norm(inside)))
        sizes = lengths(image)
        before, last = self._lost
        self._lost = (last, last * self._scale / sizes.min() + before)
        if not (self._lost[1] < _MOST_LOST and last < _MOST_LEFT):
            pair = self._basis[end - block : end + block]
            found = np.abs(orthogonalize(self._basis[: end - block], pair)[:, block:])
            orthogonalize(self._basis[end - block : end], image)
            # What was found tells how much rounding leaves in this run.
            excess = float((found.max(axis=0, initial=0.0) / sizes).max()) / self._lost[1]
            self._least = min(max(self._least * excess, _LEAST_LOST), _MOST_LEFT)
            self._lost = (self._least, self._least)
        return inside[-block:]

    def _ritz(self) -> tuple[Floats, Floats, Floats]:
        """Ritz values of the inverse, weights in the basis, and what couples these onwards."""
        size = self._n_steps * self._effort.block
        inverses, rotations = np.linalg.eigh(self._projected[:size, :size])
        return inverses, rotations, self._coupling.T @ rotations[-self._effort.block :]

    def _converge(self) -> None:
        """Look at which eigenvalues have converged, and their weights in the basis."""
        inverses, rotations, leftover = self._ritz()
        good = np.linalg.norm(leftover, axis=0) <= self._effort.tolerance * np.abs(inverses)
        values = self.factors.shift + 1 / inverses[good]
        chosen = np.flatnonzero(good)[np.argsort(values)]
        # One more step of inverse iteration costs nothing here: it is the basis's next block.
        weights = np.concatenate([rotations[:, chosen], leftover[:, chosen] / inverses[chosen]])
        self.values, self._weights = np.sort(values), weights / np.linalg.norm(weights, axis=0)
