"""Greedy optimal designs: each point where it takes most uncertainty away."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from auricle.arrays import Floats, Integers, Modes, PerMode, Truths
from auricle.errors import InputError
from auricle.sampling.candidates import candidates
from auricle.sampling.chamber import Chamber
from auricle.sampling.sites import Sites

_LEAST_VARIANCE = 1e-14
"""Of a coefficient relative to the largest: what rounding leaves of one that is known."""


@dataclass(frozen=True)
class Prior:
    """What is believed of a map before any sample.

    Attributes
    ----------
    variances
        Of the harmonics' coefficients, shape (k,), the map's unit squared times mm².
    noise
        Standard deviation of a sample, the map's unit.

    Raises
    ------
    InputError
        If a variance is negative or not finite, all are 0, or the noise is not positive.
    """

    variances: PerMode
    noise: float

    def __post_init__(self) -> None:
        variances = np.asarray(self.variances)
        if variances.ndim != 1 or not np.isfinite(variances).all() or (variances < 0).any():
            raise InputError("prior variances must be one number a harmonic, not negative")
        if not variances.any():
            raise InputError("every prior variance is 0: there is nothing to find out")
        if not 0 < self.noise < np.inf:
            raise InputError(f"noise of {self.noise}: give a positive standard deviation")


def a_optimal_sampling(
    chamber: Chamber,
    count: int,
    *,
    prior: Prior,
    allowed: Truths | None = None,
    existing: Sites | None = None,
) -> Integers:
    """Vertices chosen greedily for the least posterior variance over the accessible area.

    A sample at x lowers the integrated variance by φᵀCGCφ/(σ² + φᵀCφ), with C the posterior
    covariance of the coefficients so far and G the harmonics' products over the accessible area.
    Nested; N points of n candidates and k harmonics cost O(N·n·k), by rank-one updates.

    Parameters
    ----------
    chamber
        Where to sample.
    count
        How many points to add.
    prior
        Variances of the first k harmonics' coefficients, and the noise.
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
        If fewer than `count` vertices are allowed or the prior has more variances than there are
        harmonics.
    """
    choice = np.flatnonzero(candidates(chamber, count, allowed=allowed, existing=existing))
    covariance = _posterior(chamber, prior, existing)
    search = GreedySearch(_modes(chamber, prior)[choice], covariance, prior.noise**2)
    n_modes = len(prior.variances)
    gram = chamber.accessible_gram[:n_modes, :n_modes]
    return choice[search.a_optimal(count, gram)]


def d_optimal_sampling(
    chamber: Chamber,
    count: int,
    *,
    prior: Prior,
    allowed: Truths | None = None,
    existing: Sites | None = None,
) -> Integers:
    """Vertices chosen greedily for the least determinant of the posterior covariance.

    That is where the posterior variance is largest. Otherwise as `a_optimal_sampling`.
    """
    choice = np.flatnonzero(candidates(chamber, count, allowed=allowed, existing=existing))
    covariance = _posterior(chamber, prior, existing)
    search = GreedySearch(_modes(chamber, prior)[choice], covariance, prior.noise**2)
    return choice[search.d_optimal(count)]


class GreedySearch:
    """A search among candidates that keeps every one's variance up to date.

    Parameters
    ----------
    modes
        Harmonics at the candidates, shape (m, k).
    covariance
        Of the coefficients before the search, shape (k, k).
    noise_variance
        Of a sample.
    """

    def __init__(self, modes: Modes, covariance: Floats, noise_variance: float) -> None:
        self._modes = modes
        self._covariance = covariance.copy()
        self._noise = noise_variance
        self._variances = np.einsum("mk,mk->m", modes @ covariance, modes)
        self._free = np.ones(len(modes), dtype=np.bool_)

    def d_optimal(self, count: int) -> Integers:
        """Candidates by largest variance, shape (count,)."""
        return self._chosen(count, lambda: self._variances, lambda _step, _along: None)

    def a_optimal(self, count: int, gram: Floats) -> Integers:
        """Candidates by largest drop of the variance integrated under `gram`, shape (count,)."""
        weighted = self._modes @ self._covariance
        squares = np.einsum("mk,mk->m", weighted @ gram, weighted)

        def gains() -> Floats:
            drops: Floats = squares / (self._noise + self._variances)
            return drops

        def update(step: Floats, along: Floats) -> None:
            measured = gram @ step
            across = self._modes @ (self._covariance @ measured)
            np.subtract(squares, along * (2 * across - (step @ measured) * along), out=squares)

        return self._chosen(count, gains, update)

    def _chosen(
        self, count: int, gains: Callable[[], Floats], update: Callable[[Floats, Floats], None]
    ) -> Integers:
        chosen = np.empty(count, dtype=np.int64)
        for i in range(count):
            best = int(np.where(self._free, gains(), -np.inf).argmax())
            chosen[i] = best
            self._free[best] = False
            row = self._modes[best]
            weighted = self._covariance @ row
            step = weighted / np.sqrt(self._noise + row @ weighted)
            along = self._modes @ step
            update(step, along)
            self._variances -= along**2
            self._covariance -= np.outer(step, step)
        return chosen


def _modes(chamber: Chamber, prior: Prior) -> Modes:
    n_modes = len(prior.variances)
    if n_modes > chamber.basis.n_modes:
        raise InputError(
            f"{n_modes} prior variances and {chamber.basis.n_modes} harmonics: solve for more"
        )
    return chamber.basis.modes[:, :n_modes]


def _posterior(chamber: Chamber, prior: Prior, existing: Sites | None) -> Floats:
    """Covariance of the coefficients once the existing points are sampled, shape (k, k)."""
    variances = np.asarray(prior.variances, dtype=np.float64)
    if existing is None or not len(existing):
        return np.diag(variances)
    roots = np.sqrt(np.maximum(variances, _LEAST_VARIANCE * variances.max()))
    scaled = existing.of(_modes(chamber, prior)) * (roots / prior.noise)
    precision = np.eye(len(roots)) + scaled.T @ scaled
    covariance: Floats = roots[:, None] * cho_solve(cho_factor(precision), np.diag(roots))
    return covariance
