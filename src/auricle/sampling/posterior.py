"""The posterior of a map's coefficients: prior and samples, joined by Bayes' rule."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.linalg import cho_solve, cholesky, solve_triangular

from auricle.arrays import Floats, Modes, PerMode, PerVertex, read_only
from auricle.errors import InputError


@dataclass(frozen=True, eq=False)
class Covariance:
    """A covariance of coefficients: diag(diagonal) − removed·removedᵀ + added·addedᵀ.

    Attributes
    ----------
    diagonal
        Shape (k,), what the prior allows.
    removed
        Shape (k, r), what the samples took away.
    added
        Shape (k, s), what is left over.
    """

    diagonal: PerMode
    removed: Floats
    added: Floats

    def __post_init__(self) -> None:
        for name in ("diagonal", "removed", "added"):
            object.__setattr__(self, name, read_only(getattr(self, name), np.float64))

    @property
    def matrix(self) -> Floats:
        """The whole of it, shape (k, k)."""
        dense: Floats = self.added @ self.added.T - self.removed @ self.removed.T
        dense[np.diag_indices_from(dense)] += self.diagonal
        return dense

    @property
    def variances(self) -> PerMode:
        """Its diagonal, shape (k,)."""
        return self.seen_by(None)

    def seen_by(self, modes: Modes | None) -> PerVertex:
        """Variance of each linear form of the coefficients.

        Parameters
        ----------
        modes
            One form a row, shape (n, k): the modes at n places for the variance of the map there;
            None for the coefficients themselves.

        Returns
        -------
        PerVertex
            Shape (n,), not negative.
        """
        if modes is None:
            prior, removed, added = self.diagonal, self.removed, self.added
        else:
            prior = np.square(modes) @ self.diagonal if self.diagonal.any() else np.zeros(1)
            removed, added = modes @ self.removed, modes @ self.added
        variance = prior - np.square(removed).sum(axis=1) + np.square(added).sum(axis=1)
        return np.asarray(np.maximum(variance, 0.0))


@dataclass(frozen=True, eq=False)
class Posterior:
    """What samples at known places, with known noise, say of a map's coefficients.

    Attributes
    ----------
    at_samples
        The modes at the samples, shape (N, k).
    operator
        Shape (k, N): coefficient mean = operator·values. The reconstruction is linear.
    precision
        Shape (N, N): inverse covariance of the values with the free constant taken out, so that
        leave-one-out errors are (precision·values)ᵢ / precisionᵢᵢ.
    covariance
        Of the coefficients.
    prior_variances
        Shape (k,); 0 for the constant, whose prior is flat.
    noise_variances
        Shape (N,).
    remainder
        Covariance of what the map has at the samples beyond the modes: shape (N, N), or (N,) if
        independent; None for nothing.
    """

    at_samples: Modes
    operator: Floats
    precision: Floats
    covariance: Covariance
    prior_variances: PerMode
    noise_variances: Floats
    remainder: Floats | None = None

    @classmethod
    def of(
        cls,
        at_samples: Modes,
        prior_variances: PerMode,
        noise_variances: Floats,
        *,
        remainder: Floats | None = None,
    ) -> Self:
        """Condition the prior on samples at the places where the modes are `at_samples`.

        Costs O(N²·(N + k)) with fewer samples than modes, O(k²·(N + k)) otherwise.

        Parameters
        ----------
        at_samples
            Modes at the samples, shape (N, k); the first is the constant one, its prior flat.
        prior_variances
            Shape (k,), positive but for the first, which is not read.
        noise_variances
            Shape (N,), positive.
        remainder
            Covariance of the map at the samples beyond the modes, shape (N, N); O(N³) then. Of
            shape (N,) if independent from sample to sample.

        Raises
        ------
        InputError
            If there is no sample, or a noise is not positive.
        """
        if not len(at_samples):
            raise InputError("there is no sample: give one at least")
        if not (noise_variances > 0).all():
            raise InputError("the noise of a sample is not positive: give what it may be off by")
        prior = prior_variances.copy()
        prior[0] = 0.0
        own = _own(noise_variances, remainder)
        few = len(at_samples) < at_samples.shape[1] or own.ndim == 2
        condition = _among_samples if few else _among_modes
        operator, precision, covariance = condition(at_samples, prior, own)
        return cls(at_samples, operator, precision, covariance, prior, noise_variances, remainder)

    def leave_one_out(self, values: Floats) -> tuple[Floats, Floats]:
        """Each value minus its prediction from all the others, and that difference's deviation.

        Closed form (Rasmussen and Williams 2006, Eq. 5.12), hyper-parameters held.

        Returns
        -------
        residuals
            Shape of `values`: (N,) or (N, c).
        deviations
            Expected standard deviation of each, noise included, shape (N,); infinite for a value
            without which nothing would be known.
        """
        own = np.maximum(np.diag(self.precision), 0.0)
        known = own > np.finfo(float).eps / self.noise_variances
        own = np.where(known, own, np.nan)
        residuals = (self.precision @ values) / own.reshape(-1, *[1] * (values.ndim - 1))
        return np.nan_to_num(residuals), np.where(known, 1 / np.sqrt(own), np.inf)

    def draw(self, rng: np.random.Generator, count: int) -> Floats:
        """Deviations of `count` possible truths from the coefficient mean, shape (k, count).

        Draws from the prior, observed and corrected as the samples were (Matheron's rule).
        """
        prior = np.sqrt(self.prior_variances)[:, None] * rng.standard_normal(
            (len(self.prior_variances), count)
        )
        own = _own(self.noise_variances, self.remainder)
        noise = rng.standard_normal((len(own), count))
        noise = (
            cholesky(own, lower=True) @ noise if own.ndim == 2 else np.sqrt(own)[:, None] * noise
        )
        deviations: Floats = prior - self.operator @ (self.at_samples @ prior + noise)
        return deviations


def _own(noise_variances: Floats, remainder: Floats | None) -> Floats:
    """Covariance of what a sample has that the modes do not carry, (N, N) or its diagonal (N,)."""
    if remainder is None:
        return noise_variances
    if remainder.ndim == 1:
        return np.asarray(noise_variances + remainder)
    own = remainder.copy()
    own[np.diag_indices_from(own)] += noise_variances
    return own


def _among_samples(
    at_samples: Modes, prior: PerMode, own: Floats
) -> tuple[Floats, Floats, Covariance]:
    """By the covariance of the N values: for fewer samples than modes."""
    cross = prior[:, None] * at_samples.T
    among = at_samples @ cross
    if own.ndim == 2:
        among += own
    else:
        among[np.diag_indices_from(among)] += own
    factor = cholesky(among, lower=True)
    constant = at_samples[:, 0]
    seen = cho_solve((factor, True), constant)
    certainty = constant @ seen
    precision = cho_solve((factor, True), np.eye(len(among)))
    precision -= np.outer(seen, seen) / certainty
    operator = cross @ precision
    operator[0] += seen / certainty
    removed = solve_triangular(factor, cross.T, lower=True).T
    added = -(cross @ seen)
    added[0] += 1.0
    left = (added / np.sqrt(certainty))[:, None]
    return operator, precision, Covariance(prior, removed, left)


def _among_modes(
    at_samples: Modes, prior: PerMode, noise: Floats
) -> tuple[Floats, Floats, Covariance]:
    """By the precision of the k coefficients: for no fewer samples than modes."""
    scale = np.sqrt(prior)
    scale[0] = np.sqrt(noise.mean() / np.square(at_samples[:, 0]).mean())
    weighted = at_samples * scale / np.sqrt(noise)[:, None]
    information = weighted.T @ weighted
    information[np.diag_indices_from(information)] += prior > 0
    factor = cholesky(information, lower=True)
    root = solve_triangular(factor, np.diag(scale), lower=True).T
    operator = root @ (root.T @ (at_samples / noise[:, None]).T)
    precision = -(at_samples @ operator)
    precision[np.diag_indices_from(precision)] += 1.0
    precision /= noise[:, None]
    nothing = np.zeros((len(prior), 0))
    return operator, (precision + precision.T) / 2, Covariance(0 * prior, nothing, root)
