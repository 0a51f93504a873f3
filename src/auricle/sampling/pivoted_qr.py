"""Sampling by pivoted QR: as many points as harmonics, as far from singular as greed gets."""

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from auricle.arrays import Floats, Integers, Truths
from auricle.errors import BandError
from auricle.sampling.candidates import candidates
from auricle.sampling.chamber import Chamber
from auricle.sampling.optimal_design import GreedySearch
from auricle.sampling.sites import Sites
from auricle.sampling.slepian import slepian_functions

_SPENT = 1e-20
"""Squared length, relative to the longest, below which nothing is left of a candidate's row."""


def pivoted_qr_sampling(
    chamber: Chamber,
    count: int,
    *,
    n_modes: int,
    allowed: Truths | None = None,
    existing: Sites | None = None,
) -> Integers:
    """Vertices that fix the first `n_modes` harmonics: QR pivots, then least noise gain.

    The pivots of the QR factorisation of the (transposed) Slepian functions at the candidates:
    each point is where most of the functions' values lies outside of what the points before fix.
    Once all functions are fixed, further points are those that lower the mean variance of the
    least-squares map most (greedy A-optimal without a prior). Nested in `count`.

    Parameters
    ----------
    chamber
        Where to sample.
    count
        How many points to add.
    n_modes
        Harmonics to fix. Where there are caps, fewer degrees of freedom than that.
    allowed
        Which vertices may be chosen, shape (n,); only accessible ones ever are.
    existing
        Points taken already.

    Returns
    -------
    Integers
        Vertex indices in the order chosen, shape (count,).

    Raises
    ------
    InputError
        If fewer than `count` vertices are allowed.
    BandError
        If there are not so many harmonics, or the allowed vertices cannot fix them.

    References
    ----------
    Businger and Golub 1965 (pivoting); Drmač and Gugercin 2016, "A new selection operator for the
    discrete empirical interpolation method" (its use for placing samples).
    """
    choice = np.flatnonzero(candidates(chamber, count, allowed=allowed, existing=existing))
    functions = slepian_functions(chamber, n_modes)
    modes = chamber.basis.modes[:, :n_modes]
    rows = modes[choice] @ functions.transform
    taken = np.empty((0, functions.n_free))
    if existing is not None:
        taken = existing.of(modes) @ functions.transform
    fixed = _span(taken)
    pivots = _pivots(rows, fixed, min(count, functions.n_free - len(fixed)))
    if len(pivots) < count:
        pivots = _extended(rows, taken, pivots, count)
    chosen: Integers = choice[pivots]
    return chosen


def _extended(rows: Floats, taken: Floats, pivots: Integers, count: int) -> Integers:
    """The pivots and, up to `count`, the rows that lower the noise gain most."""
    held = np.concatenate([taken, rows[pivots]])
    free = np.setdiff1d(np.arange(len(rows)), pivots)
    identity = np.eye(rows.shape[1])
    search = GreedySearch(rows[free], cho_solve(cho_factor(held.T @ held), identity), 1.0)
    return np.concatenate([pivots, free[search.a_optimal(count - len(pivots), identity)]])


def _span(rows: Floats) -> Floats:
    """Orthonormal rows that span what these rows do, shape (rank, r)."""
    if not len(rows):
        return rows
    _, singular, right = np.linalg.svd(rows, full_matrices=False)
    significant = singular > max(rows.shape) * np.finfo(float).eps * singular[0]
    span: Floats = right[significant]
    return span


def _pivots(rows: Floats, fixed: Floats, count: int) -> Integers:
    """Rows with most of their length outside of the rows before, one after the other."""
    directions = np.empty((len(fixed) + count, rows.shape[1]))
    directions[: len(fixed)] = fixed
    longest = float((rows**2).sum(axis=1).max())
    left = (rows**2).sum(axis=1) - ((rows @ fixed.T) ** 2).sum(axis=1)
    pivots = np.empty(count, dtype=np.int64)
    for i in range(count):
        pivots[i] = left.argmax()
        before = directions[: len(fixed) + i]
        residual = rows[pivots[i]]
        for _ in range(2):  # once more, for what rounding leaves of the first time
            residual = residual - before.T @ (before @ residual)
        length = residual @ residual
        if length <= _SPENT * longest:
            raise BandError(
                f"the allowed vertices fix {len(fixed) + i} of {rows.shape[1]} degrees of "
                "freedom: allow more of the surface or ask for fewer harmonics"
            )
        directions[len(fixed) + i] = residual / np.sqrt(length)
        left -= (rows @ directions[len(fixed) + i]) ** 2
        left[pivots[i]] = -np.inf
    return pivots
