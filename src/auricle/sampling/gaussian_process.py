"""Gaussian-process reconstruction: a map from scattered samples, and how sure it is."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.spatial.distance import cdist

from auricle.arrays import Floats, Integers, Modes, PerMode, read_only
from auricle.errors import InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.marginal_likelihood import Belief, Fit, SampleSpectrum
from auricle.sampling.matern import matern_variances, split_prior
from auricle.sampling.mixture import mixed
from auricle.sampling.neighbourhoods import neighbourhoods
from auricle.sampling.noise_shape import relative_noise, weighted_deviation
from auricle.sampling.posterior import Posterior
from auricle.sampling.prior_average import BEFOREHAND, averaged
from auricle.sampling.reconstruction import Hyperparameters, Reconstruction
from auricle.sampling.remainder import Remainder, Term
from auricle.sampling.samples import PlacedSamples
from auricle.sampling.sites import Sites
from auricle.sampling.splines import Spline

FEWEST_SAMPLES = 5
"""With fewer, the samples' own spread says nothing of the map's."""
LEAST_VISIBLE = 0.05
"""Share of the map's variance that samples must span before their spread says anything of it."""
NOISE_SHARE = 0.05
"""Median of the default noise prior, relative to the samples' standard deviation."""
NOISE_SPREAD = 1.0
"""Standard deviation of the logarithm of the noise in that prior: a factor of 2.7 either way."""
LENGTH_SHARE = 0.5
"""Median of the prior on the correlation length, relative to the diameter √(A/π)."""
LENGTH_SPREAD = math.log(2)
"""Standard deviation of the logarithm of the length in that prior: a factor of 2 either way."""
SMOOTHNESSES = tuple(BEFOREHAND)
"""ν of the Matérn priors that are averaged over."""
EDGED = 0.8
"""`SampleSpectrum.typical_share` below which edges are taken to be among the residuals."""
EDGED_SPREAD = 0.25
"""Spread of the logarithm of the noise about what typical samples show of it, then."""
_FEWEST_TYPICAL = 20
MOST_CORRELATED = 1000
"""Number of samples up to which the prior's detail beyond the harmonics is correlated among them,
and splines share in the map; with more it counts as independent, since both cost O(N³)."""
_LENGTHS_PER_OCTAVE = 2
_LONGEST_OCTAVE, _SHORTEST_OCTAVE = 1, -3
_SMALLEST_NOISE = 1e-4


@dataclass(frozen=True)
class NoisePrior:
    """What is thought of the noise before the samples are seen: log-normal.

    Attributes
    ----------
    median
        Of a typical sample (the median of several that differ), in the map's unit: an
        annotation's error, say 3 to 5 ms.
    spread
        Standard deviation of the noise's logarithm.
    """

    median: float
    spread: float = NOISE_SPREAD


class GaussianProcess:
    """A Matérn prior on a chamber and one set of sites: ready for any values measured there.

    What does not depend on the values (one eigendecomposition a correlation length) is done once,
    when first needed, and kept: further values on the same sites cost little.

    Parameters
    ----------
    chamber
        Where the map lives.
    sites
        Where it was sampled; those in the same place are best merged first (`place`).
    noise_shape
        Noise of each sample relative to the others, shape (N,), positive; None for all alike.
    smoothness
        ν of the Matérn prior, whose most probable length is then taken, on the harmonics alone.
        None: the prior is averaged over `SMOOTHNESSES` and lengths by their probability, and what
        it holds beyond the harmonics counts as map.
    n_modes
        How many harmonics carry the map; None for min(n/4, max(300, 2N)) of what there are.

    Raises
    ------
    InputError
        If there is no site, the noise shape is not one positive number a site, or fewer than two
        modes are left.
    """

    def __init__(
        self,
        chamber: Chamber,
        sites: Sites,
        *,
        noise_shape: Floats | None = None,
        smoothness: float | None = None,
        n_modes: int | None = None,
    ) -> None:
        if not len(sites):
            raise InputError("there is no sample: give one at least")
        self.chamber = chamber
        self.sites = sites
        self.smoothness = smoothness
        self.n_modes = min(n_modes or default_modes(chamber, len(sites)), chamber.basis.n_modes)
        if self.n_modes < 2:
            raise InputError(f"{self.n_modes} harmonics cannot carry a map: ask for 2 at least")
        self.noise_shape = relative_noise(noise_shape, len(sites))
        self.at_samples: Modes = sites.of(chamber.basis.modes[:, : self.n_modes])
        self._spectra: dict[tuple[float, float], SampleSpectrum] = {}
        self._splines: dict[float, Spline] = {}

    @property
    def diameter(self) -> float:
        """√(A/π) mm: of the sphere of the chamber's area."""
        return math.sqrt(self.chamber.basis.area / math.pi)

    @property
    def lengths(self) -> tuple[float, ...]:
        """Correlation lengths searched, mm: from an eighth of the diameter to twice it."""
        steps = range(
            _SHORTEST_OCTAVE * _LENGTHS_PER_OCTAVE, _LONGEST_OCTAVE * _LENGTHS_PER_OCTAVE + 1
        )
        return tuple(self.diameter * 2 ** (step / _LENGTHS_PER_OCTAVE) for step in steps)

    def fit(
        self,
        values: Floats,
        *,
        noise: float | None = None,
        noise_prior: NoisePrior | None = None,
    ) -> Reconstruction:
        """The map, with the hyper-parameters by penalised marginal likelihood.

        Without a stated smoothness the covariance (and the noise) is the mean of those of every
        smoothness and length, each with its own best amplitude and noise, weighted by their
        probability: one Gaussian prior, so that the reconstruction stays linear. Where the
        samples tell lengths and smoothness it is that of the best. Noise is on all samples; where
        a few are missed by much and most by little (`SampleSpectrum.typical_share`), and nothing
        is stated of the noise, the map has edges: then the noise is fitted about what typical
        samples show of it, and the likelihoods count for less. Splines of the same noise share in
        the map (`mixture.shares`): their errors and the process' are not the same, so that the
        mean of all is nearer the truth than each; by how much they differ counts as uncertainty.

        Priors, all weak: log-normal on length (`LENGTH_SHARE`, `LENGTH_SPREAD`) and noise
        (`NOISE_SHARE`, `NOISE_SPREAD`); on the amplitude one that counts as one sample and is
        centred on the samples' deviation over what such sites show of a map's. Where that is
        unknown (fewer than `FEWEST_SAMPLES`, all equal, all in one place) it is centred on the
        largest magnitude among the values, or one unit: the result then says it knows nothing.

        Parameters
        ----------
        values
            Shape (N,), or (N, c) for c maps that share their hyper-parameters.
        noise
            Standard deviation (root mean square over the samples), if known.
        noise_prior
            Used if it is not.

        Raises
        ------
        InputError
            If there is not one finite value a site, or noise or prior are not positive.
        """
        columns = self._checked(values)
        if noise is not None and not (noise >= 0 and math.isfinite(noise)):
            raise InputError(f"noise {noise}: give 0 or a positive number")

        def fitting(prior: NoisePrior | None) -> Callable[[SampleSpectrum], Fit]:
            return lambda spectrum: self._fit_of(spectrum, columns, noise, prior)

        if self.smoothness is None:
            found, fit, visible = self._average(fitting(noise_prior))
        else:
            found, fit, visible = self._most_probable(fitting(noise_prior), self.smoothness)
        unknown = len(columns) < FEWEST_SAMPLES or visible < LEAST_VISIBLE
        stated = noise is not None or noise_prior is not None
        if self.smoothness is None and not (stated or unknown or len(columns) < _FEWEST_TYPICAL):
            share = self._spectrum(found.length, found.smoothness, whole=True).typical_share(
                columns, fit
            )
            if 0 < share < EDGED:
                typical = share * found.noise * float(np.median(self.noise_shape))
                again = fitting(NoisePrior(typical, EDGED_SPREAD))
                found, fit, visible = self._average(again, weight=math.sqrt(share))
        unknown = unknown or not float(np.ptp(columns, axis=0).max()) > 0
        rebuilt = self.given(values, found)
        if self.smoothness is None and not unknown and len(columns) <= MOST_CORRELATED:
            rebuilt = mixed(rebuilt, self._spline, self._neighbourhoods)
        return replace(rebuilt, log_marginal_likelihood=fit.log_likelihood, knows_nothing=unknown)

    @cached_property
    def _neighbourhoods(self) -> tuple[Integers, ...]:
        return neighbourhoods(self.chamber, self.sites)

    def _spline(self, power: float) -> Spline:
        if power not in self._splines:
            self._splines[power] = Spline(self.chamber, self.sites, power, self.noise_shape)
        return self._splines[power]

    def _fit_of(
        self,
        spectrum: SampleSpectrum,
        columns: Floats,
        noise: float | None,
        noise_prior: NoisePrior | None,
    ) -> Fit:
        fit = spectrum.fit(columns, _belief(columns, spectrum, noise, noise_prior))
        off = math.log(spectrum.length / (LENGTH_SHARE * self.diameter)) / LENGTH_SPREAD
        return replace(fit, objective=fit.objective + off**2 / 2)

    def given(self, values: Floats, hyperparameters: Hyperparameters) -> Reconstruction:
        """The map under hyper-parameters that are already known."""
        self._checked(values)
        posterior = self.posterior(hyperparameters)
        return Reconstruction(
            self.chamber,
            posterior,
            read_only(values, float),
            hyperparameters,
            remainder=self._remainder(hyperparameters.terms) if hyperparameters.terms else None,
            sites=self.sites,
            splines=tuple((self._spline(each.power), each) for each in hyperparameters.splines),
        )

    def posterior(self, hyperparameters: Hyperparameters) -> Posterior:
        """What these sites leave unknown of any map: needs no values."""
        noise = np.square(hyperparameters.noise * self.noise_shape)
        variance = hyperparameters.amplitude**2
        if not hyperparameters.terms:
            variances = self._on_modes(hyperparameters.length, hyperparameters.smoothness)
            return Posterior.of(self.at_samples, variance * variances, noise)
        return Posterior.of(
            self.at_samples,
            variance * self._within(hyperparameters.terms),
            noise,
            remainder=variance * self._beyond(hyperparameters.terms),
        )

    def _within(self, terms: tuple[Term, ...]) -> PerMode:
        """Variances of the coefficients under a prior of several terms, shape (k,)."""
        variances = np.zeros(self.n_modes)
        for term in terms:
            part = split_prior(
                self.chamber.basis, self.n_modes, length=term.length, smoothness=term.smoothness
            )
            variances += term.share * part.variances
        return variances

    def _beyond(self, terms: tuple[Term, ...]) -> Floats:
        """Covariance at the samples of what such a prior holds beyond the modes."""
        remainder = self._remainder(terms)
        if len(self.sites) > MOST_CORRELATED:
            return np.full(len(self.sites), remainder.variance)
        return remainder.variance * remainder.correlation(self._distances)

    def _remainder(self, terms: tuple[Term, ...]) -> Remainder:
        return Remainder.of(self.chamber.basis, self.n_modes, terms)

    @cached_property
    def _distances(self) -> Floats:
        """Straight ways between the samples, shape (N, N), mm."""
        positions = self.sites.positions(self.chamber.mesh)
        return np.asarray(cdist(positions, positions))

    def _average(
        self, at: Callable[[SampleSpectrum], Fit], *, weight: float = 1.0
    ) -> tuple[Hyperparameters, Fit, float]:
        # Of very many samples each decomposition is large: half the lengths keep them in memory.
        step = 2 if len(self.sites) > MOST_CORRELATED else 1
        candidates = [(nu, length) for nu in SMOOTHNESSES for length in self.lengths[::step]]
        spectra = [self._spectrum(length, nu, whole=True) for nu, length in candidates]
        fits = [at(spectrum) for spectrum in spectra]
        found, best = averaged(candidates, fits, weight=weight)
        return found, fits[best], spectra[best].visible

    def _most_probable(
        self, at: Callable[[SampleSpectrum], Fit], smoothness: float
    ) -> tuple[Hyperparameters, Fit, float]:
        def found(spectrum: SampleSpectrum, fit: Fit) -> tuple[Hyperparameters, Fit, float]:
            best = Hyperparameters(spectrum.length, fit.amplitude, fit.noise, smoothness)
            return best, fit, spectrum.visible

        spectra = [self._spectrum(length, smoothness, whole=False) for length in self.lengths]
        fits = [at(spectrum) for spectrum in spectra]
        objectives = [fit.objective for fit in fits]
        best = int(np.argmin(objectives))
        if 0 < best < len(spectra) - 1:
            shift = _parabola_minimum(objectives[best - 1 : best + 2])
            length = spectra[best].length * 2 ** (shift / _LENGTHS_PER_OCTAVE)
            between = self._decomposed(length, smoothness, whole=False)
            refined = at(between)
            if refined.objective < fits[best].objective:
                return found(between, refined)
        return found(spectra[best], fits[best])

    def _spectrum(self, length: float, smoothness: float, *, whole: bool) -> SampleSpectrum:
        key = (length, smoothness)
        if key not in self._spectra:
            self._spectra[key] = self._decomposed(length, smoothness, whole=whole)
        return self._spectra[key]

    def _decomposed(self, length: float, smoothness: float, *, whole: bool) -> SampleSpectrum:
        terms = (Term(length, smoothness, 1.0),)
        return SampleSpectrum.of(
            self.at_samples,
            self._within(terms) if whole else self._on_modes(length, smoothness),
            self.noise_shape,
            length=length,
            remainder=self._beyond(terms) if whole else None,
        )

    def _on_modes(self, length: float, smoothness: float) -> PerMode:
        # Over all modes there are: what those beyond n_modes hold is no part of the map.
        variances = matern_variances(self.chamber.basis, length=length, smoothness=smoothness)
        return variances[: self.n_modes]

    def _checked(self, values: Floats) -> Floats:
        if values.ndim not in (1, 2) or len(values) != len(self.sites):
            raise InputError(
                f"values of shape {values.shape} for {len(self.sites)} sites: give one, or one "
                "row, a site"
            )
        if not np.isfinite(values).all():
            raise InputError("a value is NaN or infinite: leave that sample out")
        return values.reshape(len(values), -1)


def reconstruct(
    placed: PlacedSamples,
    chamber: Chamber,
    *,
    noise_prior: NoisePrior | None = None,
    smoothness: float | None = None,
    n_modes: int | None = None,
) -> Reconstruction:
    """The map of samples on a chamber: `GaussianProcess` and its `fit` in one step.

    Where the samples come with their noise, that is the centre of the prior on it and says how
    they compare: what is off beside (position, detail too fine for the samples) may add to it,
    and `Reconstruction.std_with_detail` takes the stated noise out again. Without, a place
    measured m times counts as √m times as sure as one measured once.
    """
    if noise_prior is None and placed.noise is not None:
        noise_prior = NoisePrior(float(np.median(placed.noise)))
    process = GaussianProcess(
        chamber,
        placed.sites,
        noise_shape=placed.noise_shape,
        smoothness=smoothness,
        n_modes=n_modes,
    )
    return process.fit(placed.values, noise_prior=noise_prior)


def default_modes(chamber: Chamber, n_samples: int) -> int:
    """Harmonics worth using for so many samples: min(n/4, max(300, 2N)), of what there are."""
    wanted = min(chamber.mesh.n_vertices // 4, max(300, 2 * n_samples))
    return min(wanted, chamber.basis.n_modes)


def _belief(
    values: Floats,
    spectrum: SampleSpectrum,
    noise: float | None,
    noise_prior: NoisePrior | None,
) -> Belief:
    """Priors on amplitude and noise; see `GaussianProcess.fit`."""
    deviation = weighted_deviation(values, spectrum.noise_shape)
    magnitude = math.sqrt(np.square(values).mean(axis=1).max()) or noise or 1.0
    largest = max(magnitude, deviation)
    amplitude = largest
    if len(values) >= FEWEST_SAMPLES and deviation > 0:
        amplitude = min(deviation / math.sqrt(max(spectrum.visible, 1e-12)), largest)
    if noise is not None:
        return Belief(amplitude, max(noise, _SMALLEST_NOISE * amplitude), 0.0)
    prior = noise_prior or NoisePrior(NOISE_SHARE * (deviation or amplitude))
    # The prior is on the noise of a typical sample, the fit on the root mean square.
    return Belief(amplitude, prior.median / float(np.median(spectrum.noise_shape)), prior.spread)


def _parabola_minimum(heights: list[float]) -> float:
    """Where the parabola through heights at -1, 0, 1 is least, within ±1."""
    left, middle, right = heights
    curvature = left - 2 * middle + right
    return float(np.clip(0.5 * (left - right) / curvature, -1, 1)) if curvature > 0 else 0.0
