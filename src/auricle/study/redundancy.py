"""Redundancy: which samples a map could have done without, and how many would have sufficed."""

from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats, Integers, PerVertex
from auricle.sampling.reconstruction import Reconstruction

FEWEST = 5
"""Samples that are always left: with fewer a map's own spread is unknown."""
SAME_ERROR = 1.05
"""How many times the error of all samples still counts as the same."""
_BATCH = 100
"""One in so many of the samples left is taken out at a time."""
_APART = 0.1
"""Partial correlation up to which samples are taken out at the same time."""


@dataclass(frozen=True, eq=False)
class Redundancy:
    """How the expected error rises as the least useful samples are taken out.

    Attributes
    ----------
    removed
        Samples in the order they are taken out, least useful first, shape (m,).
    counts
        Numbers of samples left, falling from all N, shape (c,).
    nrmse
        Expected error with so many where it counts, relative to the map's expected deviation
        there; rising, shape (c,).
    """

    removed: Integers
    counts: Integers
    nrmse: Floats

    def enough_for(self, nrmse: float) -> int | None:
        """Least number of samples left with which the error is within `nrmse`.

        None if all of them do not reach it.
        """
        within = np.flatnonzero(self.nrmse <= nrmse * (1 + 1e-12))
        return int(self.counts[within[-1]]) if len(within) else None

    @property
    def n_redundant(self) -> int:
        """Samples that can be left out with the error up to `SAME_ERROR` times as large."""
        kept = self.enough_for(SAME_ERROR * float(self.nrmse[0]))
        return 0 if kept is None else int(self.counts[0]) - kept

    @property
    def redundant(self) -> Integers:
        """Those samples, in the order of `removed`."""
        found: Integers = self.removed[: self.n_redundant]
        return found


def redundancy(found: Reconstruction, areas: PerVertex, *, detail: float = 0.0) -> Redundancy:
    """Take samples out of a reconstruction, each time those whose loss is felt least.

    Hyper-parameters are held, so that the error does not depend on the values. With wᵢ(x) the
    weight of sample i at x and P the inverse covariance of the values, the variance at x rises by
    wᵢ(x)²/Pᵢᵢ when i is taken out, in the mean over an area by (WᵀGW)ᵢᵢ/(A·Pᵢᵢ); P and WᵀGW of
    the others then follow by elimination. This is greedy removal by posterior error: exact at
    every step, though another choice of as many may be better. Samples taken out in one step (a
    hundredth of those left) are nearly independent of one another.

    Parameters
    ----------
    found
        The map from all samples; about N³ operations.
    areas
        Of the vertices where the error counts, 0 elsewhere, shape (n,), mm².
    detail
        Standard deviation of detail too fine for the samples, which counts as error whatever
        their number, in the unit of `found`.
    """
    posterior = found.posterior
    modes = found.chamber.basis.modes[:, : len(posterior.prior_variances)]
    shares = areas / areas.sum()
    gram = modes.T @ (shares[:, None] * modes)
    worth = posterior.operator.T @ gram @ posterior.operator
    precision = posterior.precision.copy()
    left = np.arange(len(precision))
    removed: list[int] = []
    counts, errors = [len(left)], [float(shares @ found.variance)]
    while len(left) > FEWEST:
        batch = _batch(worth, precision)
        rest = np.setdiff1d(np.arange(len(left)), batch)
        rise, worth, precision = _eliminated(worth, precision, batch, rest)
        removed += left[batch].tolist()
        left = left[rest]
        counts.append(len(left))
        errors.append(errors[-1] + rise)
    variation = _variation(found, shares) + detail**2
    nrmse = np.sqrt((np.array(errors) + detail**2) / variation)
    return Redundancy(np.array(removed, dtype=np.int64), np.array(counts), nrmse)


def _variation(found: Reconstruction, shares: PerVertex) -> float:
    """Expected square deviation of the map from its mean, both over the shares of an area."""
    columns = found.mean.reshape(len(found.mean), -1)
    seen = float((shares @ np.square(columns - shares @ columns)).mean())
    covariance = found.posterior.covariance
    modes = found.chamber.basis.modes[:, : len(found.posterior.prior_variances)]
    of_mean = float(covariance.seen_by((shares @ modes)[None, :])[0])
    return seen + float(shares @ found.variance) - of_mean


def _batch(worth: Floats, precision: Floats) -> Integers:
    """Samples to take out next: of least loss, nearly independent of one another."""
    own = np.maximum(np.diag(precision), np.finfo(float).tiny)
    loss = np.diag(worth) / own
    wanted = min(max(1, len(own) // _BATCH), len(own) - FEWEST)
    order = np.argsort(loss, kind="stable")[: 4 * wanted]
    chosen = [int(order[0])]
    for candidate in order[1:].tolist():
        if len(chosen) == wanted:
            break
        related = np.abs(precision[candidate, chosen]) / np.sqrt(own[candidate] * own[chosen])
        if related.max() <= _APART:
            chosen.append(candidate)
    return np.array(chosen, dtype=np.int64)


def _eliminated(
    worth: Floats, precision: Floats, batch: Integers, rest: Integers
) -> tuple[float, Floats, Floats]:
    """Rise of the error without `batch`, and both matrices of the `rest`."""
    block = precision[np.ix_(batch, batch)]
    rise = float(np.trace(np.linalg.solve(block, worth[np.ix_(batch, batch)])))
    shares = np.linalg.solve(block, precision[np.ix_(batch, rest)])
    across = worth[np.ix_(rest, batch)] @ shares
    own = shares.T @ worth[np.ix_(batch, batch)] @ shares
    left = worth[np.ix_(rest, rest)] - across - across.T + own
    kept = precision[np.ix_(rest, rest)] - precision[np.ix_(rest, batch)] @ shares
    return max(rise, 0.0), left, kept
