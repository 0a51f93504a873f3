"""The marginal likelihood of samples: which correlation length, amplitude and noise they favour."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.linalg import eigh
from scipy.special import wrightomega
from scipy.stats import chi2

from auricle.arrays import Floats, Modes, PerMode
from auricle.errors import InputError

_RATIOS = np.geomspace(1e-8, 1e3, 45)
"""Noise variance over the map's variance, as searched."""
_FINER, _REFINEMENTS = 17, 3
"""Ratios tried about the best, and how often: to a thousandth of the ratio's logarithm."""
_NEGLIGIBLE = 1e-12


@dataclass(frozen=True)
class Belief:
    """What is thought of amplitude and noise before the samples are seen, in the map's unit.

    Attributes
    ----------
    amplitude
        A guess of the map's standard deviation that counts as much as one sample.
    noise
        Median of a log-normal prior on the noise; the noise itself if `noise_spread` is 0.
    noise_spread
        Standard deviation of the noise's logarithm; 0 fixes the noise.
    """

    amplitude: float
    noise: float
    noise_spread: float

    def __post_init__(self) -> None:
        if not (self.amplitude > 0 and self.noise > 0 and self.noise_spread >= 0):
            raise InputError(
                f"amplitude {self.amplitude:g}, noise {self.noise:g} and its spread "
                f"{self.noise_spread:g}: give positive numbers"
            )


@dataclass(frozen=True)
class Fit:
    """The best amplitude and noise at one correlation length.

    Attributes
    ----------
    amplitude, noise
        Standard deviations, in the map's unit.
    objective
        Negative logarithm of likelihood times priors there.
    log_likelihood
        Logarithm of the (restricted) marginal likelihood alone.
    """

    amplitude: float
    noise: float
    objective: float
    log_likelihood: float


@dataclass(frozen=True, eq=False)
class SampleSpectrum:
    """Eigendecomposition of the samples' prior covariance at one correlation length.

    With it, any values at the same places cost O(N²) once and O(N) for every noise. The constant
    is projected out of the samples (restricted likelihood, Patterson and Thompson 1971), which is
    exact for a flat prior on it.

    Attributes
    ----------
    length
        Correlation length, mm.
    eigenvalues
        Shape (m,), of the covariance at unit amplitude, those that are not negligible.
    vectors
        Shape (N, m): from whitened values to their coordinates, the constant projected out.
    constant
        Shape (N,): unit vector of the whitened constant.
    noise_shape
        Shape (N,): noise of each sample relative to the root mean square.
    floor
        Variance at unit amplitude that every sample has to itself.
    """

    length: float
    eigenvalues: Floats
    vectors: Floats
    constant: Floats
    noise_shape: Floats
    floor: float = 0.0

    @classmethod
    def of(
        cls,
        at_samples: Modes,
        prior_variances: PerMode,
        noise_shape: Floats,
        *,
        length: float,
        remainder: Floats | None = None,
    ) -> Self:
        """Decompose; O(min(N, k)³ + N·k·min(N, k)), or O(N³) with a remainder that is correlated.

        The remainder is the covariance of what the samples see beyond the modes, at unit
        amplitude: shape (N, N), or (N,) if independent from sample to sample.
        """
        whitened = at_samples / noise_shape[:, None]
        constant = whitened[:, 0] / np.linalg.norm(whitened[:, 0])
        varying = whitened[:, 1:] * np.sqrt(prior_variances[1:])
        varying -= np.outer(constant, constant @ varying)
        if remainder is not None and remainder.ndim == 2:
            beyond = remainder / np.outer(noise_shape, noise_shape)
            beyond -= np.outer(constant, constant @ beyond)
            beyond -= np.outer(beyond @ constant, constant)
            eigenvalues, vectors = _kept(*eigh(varying @ varying.T + beyond))
            return cls(length, eigenvalues, vectors, constant, noise_shape)
        eigenvalues, vectors = _left_singular(varying)
        # Where noises differ the floor is taken at its mean, so that one decomposition does.
        floor = 0.0 if remainder is None else float(np.mean(remainder / noise_shape**2))
        return cls(length, eigenvalues, vectors, constant, noise_shape, floor)

    @property
    def visible(self) -> float:
        """Mean variance that samples at these places show of a map of variance 1.

        About 1 for samples far apart, near 0 for samples all in one place.
        """
        freedom = len(self.constant) - 1
        return float(self.eigenvalues.sum() / freedom) if freedom else 0.0

    def fit(self, values: Floats, belief: Belief) -> Fit:
        """The most probable amplitude and noise for values of shape (N, c)."""
        profile = _Profile.of(self, values, belief)
        objectives = profile.at(np.log(_RATIOS))[0]
        best = int(objectives.argmin())
        at, reach = np.log(_RATIOS[[best]]), math.log(_RATIOS[1] / _RATIOS[0])
        for _ in range(_REFINEMENTS):
            around = at + np.linspace(-reach, reach, _FINER)
            at = around[[int(profile.at(around)[0].argmin())]]
            reach *= 2 / (_FINER - 1)
        objective, log_variance, log_likelihood = (float(each[0]) for each in profile.at(at))
        return Fit(
            math.exp(log_variance / 2),
            math.exp((log_variance + float(at[0])) / 2),
            objective,
            log_likelihood,
        )

    def typical_share(self, values: Floats, fit: Fit) -> float:
        """Typical over root mean square size of the standardised leave-one-out residuals.

        About 1 if they are normal, as noise makes them. Far below 1 if a few samples are missed
        by much and most by little: an edge, which a likelihood of normal noise takes for noise
        of all. By the squares of a sample's columns together, so that a turned phase has the same.

        Parameters
        ----------
        values
            Shape (N, c).
        fit
            Amplitude and noise.
        """
        alone = self.floor + (fit.noise / fit.amplitude) ** 2
        beside = 1 / (self.eigenvalues + alone) - 1 / alone
        whitened = values / self.noise_shape[:, None]
        whitened = whitened - np.outer(self.constant, self.constant @ whitened)
        seen = self.vectors @ (beside[:, None] * (self.vectors.T @ whitened)) + whitened / alone
        own = np.square(self.vectors) @ beside + (1 - self.constant**2) / alone
        squares = np.square(seen).sum(axis=1) / np.maximum(own, np.finfo(float).tiny)
        size = float(squares.mean())
        normal = float(chi2.median(values.shape[1])) / values.shape[1]
        return math.sqrt(float(np.median(squares)) / (normal * size)) if size > 0 else 1.0


@dataclass(frozen=True, eq=False)
class _Profile:
    """Minus log likelihood and prior of values against the noise ratio, amplitude at its best."""

    eigenvalues: Floats
    energies: Floats
    rest: float
    freedom: int
    n_columns: int
    log_jacobian: float
    belief: Belief
    floor: float

    @classmethod
    def of(cls, spectrum: SampleSpectrum, values: Floats, belief: Belief) -> Self:
        whitened = values / spectrum.noise_shape[:, None]
        whitened = whitened - np.outer(spectrum.constant, spectrum.constant @ whitened)
        coordinates = spectrum.vectors.T @ whitened
        energies = np.square(coordinates).sum(axis=1)
        rest = np.square(whitened - spectrum.vectors @ coordinates).sum()
        n_columns = values.shape[1]
        log_jacobian = n_columns * float(np.log(spectrum.noise_shape).sum())
        freedom = len(values) - 1
        return cls(
            spectrum.eigenvalues,
            energies,
            float(rest),
            freedom,
            n_columns,
            log_jacobian,
            belief,
            spectrum.floor,
        )

    def at(self, log_ratios: Floats) -> tuple[Floats, Floats, Floats]:
        """Objective, log of the amplitude's square, log likelihood, at each noise ratio."""
        ratios = np.exp(log_ratios)
        alone = self.floor + ratios
        spread = self.eigenvalues + alone[:, None]
        empty = self.freedom - len(self.eigenvalues)
        log_determinant = np.log(spread).sum(axis=1) + empty * np.log(alone)
        misfit = (self.energies / spread).sum(axis=1) + self.rest / alone
        log_variance = self._log_variance(misfit, log_ratios)
        n_values = self.n_columns * self.freedom
        log_likelihood = -0.5 * (
            n_values * (math.log(2 * math.pi) + log_variance)
            + self.n_columns * log_determinant
            + misfit * np.exp(-log_variance)
        )
        return (
            self._penalty(log_variance, log_ratios) - log_likelihood,
            log_variance,
            log_likelihood - self.log_jacobian,
        )

    def _log_variance(self, misfit: Floats, log_ratios: Floats) -> Floats:
        """Log of the most probable squared amplitude: in closed form, by Lambert's function."""
        belief = self.belief
        log_noise = 2 * math.log(belief.noise)
        if belief.noise_spread == 0:
            return log_noise - log_ratios
        pull = 1 / (4 * belief.noise_spread**2)
        push = 0.5 * (self.n_columns * self.freedom + 1)
        weight = 0.5 * (misfit + belief.amplitude**2)
        drift = push / pull + log_ratios - log_noise
        return np.asarray(wrightomega(np.log(weight / pull) + drift).real - drift)

    def _penalty(self, log_variance: Floats, log_ratios: Floats) -> Floats:
        belief = self.belief
        amplitude = 0.5 * (log_variance + belief.amplitude**2 * np.exp(-log_variance))
        if belief.noise_spread == 0:
            return amplitude
        off = 0.5 * (log_variance + log_ratios) - math.log(belief.noise)
        return amplitude + np.square(off / belief.noise_spread) / 2


def _left_singular(matrix: Floats) -> tuple[Floats, Floats]:
    """Squared singular values that are not negligible, and their left vectors."""
    n_rows, n_columns = matrix.shape
    if n_rows <= n_columns:
        squares, vectors = eigh(matrix @ matrix.T)
    else:
        squares, right = eigh(matrix.T @ matrix)
        vectors = (matrix @ right) / np.sqrt(np.maximum(squares, np.finfo(float).tiny))
    return _kept(squares, vectors)


def _kept(squares: Floats, vectors: Floats) -> tuple[Floats, Floats]:
    """Eigenvalues that are not negligible, and their vectors."""
    kept = squares > max(_NEGLIGIBLE, _NEGLIGIBLE * squares[-1])
    return squares[kept], vectors[:, kept]
