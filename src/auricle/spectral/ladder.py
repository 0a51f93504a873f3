"""Eigenpairs found so far along a spectrum, and where a run's join them with none missing."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from auricle.arrays import Floats
from auricle.spectral.factorization import ShiftedFactorization

_AGREEMENT = 1e-8
"""Share of a slice within which two runs' eigenvalues are the same."""
CLUSTER_GAP = 1e-7
"""Of an eigenvalue, or of the surface's scale if that is more: those no further apart are equal."""


@dataclass(eq=False)
class Ladder:
    """Eigenpairs found so far, ascending, with what was retried on the way.

    Every eigenvalue under `certified` is on the ladder; above it some may still be missing. `room`
    has columns for more vectors than there are values, and grows where these do not suffice.
    `scale` is that of the eigenvalues: differences far below it are rounding.
    """

    values: Floats
    room: Floats
    certified: float
    scale: float
    n_certified: int = 0
    retries: list[str] = field(default_factory=list)

    @property
    def vectors(self) -> Floats:
        """Eigenvectors, one a column, shape (n, c); they change with the ladder."""
        return self.room[:, : len(self.values)]

    def add(self, values: Floats, vectors: Floats) -> None:
        """Take in new pairs, one a column of `vectors`."""
        together = np.concatenate([self.values, values])
        columns = np.concatenate([self.vectors, vectors], axis=1)
        order = np.argsort(together, kind="stable")
        self._make_room(len(order))
        self.values, self.room[:, : len(order)] = together[order], columns[:, order]

    def replace_above(self, kept: int, values: Floats, fill: Callable[[Floats], object]) -> None:
        """Keep `kept` pairs above the certified ones, then go on with these.

        `fill` is to set the columns it is given to their vectors.
        """
        height = self.n_certified + kept
        self._make_room(height + len(values))
        fill(self.room[:, height : height + len(values)])
        self.values = np.concatenate([self.values[:height], values])

    def _make_room(self, count: int) -> None:
        n, n_columns = self.room.shape
        if count > n_columns:
            larger = np.empty((n, max(count, n_columns + n_columns // 4)))
            larger[:, : len(self.values)] = self.vectors
            self.room = larger

    def certify(self, factors: ShiftedFactorization) -> None:
        """Note that every eigenvalue under the shift is on the ladder."""
        self.certified, self.n_certified = factors.shift, factors.n_below

    def from_value(self, low: float) -> Floats:
        """Eigenvectors with eigenvalues from `low` up, one a column, shape (n, c)."""
        return self.vectors[:, int(np.searchsorted(self.values, low)) :]

    def n_below(self, value: float) -> int:
        """How many eigenvalues on the ladder lie below `value`."""
        return int(np.searchsorted(self.values, value))


def junction(
    ladder: Ladder, values: Floats, factors: ShiftedFactorization
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


def end_of_cluster(values: Floats, count: int, scale: float) -> int:
    """The least number from `count` up that does not cut through equal eigenvalues.

    >>> end_of_cluster(np.array([0.0, 2.0, 2.0, 2.0, 6.0]), 2, 1.0)
    4
    """
    apart = np.diff(values[count - 1 :])
    separate = apart > CLUSTER_GAP * np.maximum(values[count - 1 : -1], scale)
    return count + int(separate.argmax()) if separate.any() else len(values)
