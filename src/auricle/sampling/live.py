"""A live session: samples come one by one, map, error and next point are there at once."""

import math

import numpy as np

from auricle.arrays import Floats, PerVertex, Truths
from auricle.errors import InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.gaussian_process import LENGTH_SHARE, GaussianProcess, NoisePrior
from auricle.sampling.locator import Locator
from auricle.sampling.matern import matern_variances
from auricle.sampling.next_point import NextPoint, Travel, next_point, next_points
from auricle.sampling.reconstruction import Hyperparameters
from auricle.sampling.running_posterior import RunningPosterior
from auricle.sampling.sites import Sites

MOST_MODES = 500
"""Harmonics a session uses unless told otherwise."""
SMOOTHNESS = 1.5
"""ν of a session's prior unless hyper-parameters were given."""
FIRST_REFITS = (1, 5, 10)
"""Numbers of samples at which hyper-parameters are fitted anew; then whenever these double."""


class Session:
    """Reconstruction while the samples come.

    Between refits the hyper-parameters stand still and each sample is absorbed exactly: the
    state is that of `GaussianProcess.given` with all samples so far. The prior is one of ν = 3/2
    on the harmonics, with the most probable length; once the samples are there, a
    `GaussianProcess` averages over smoothness and length, tells detail beyond the harmonics and
    takes the mean with splines: none of which an exact update in milliseconds could carry.

    Parameters
    ----------
    chamber
        Where the map lives.
    n_modes
        How many harmonics carry it; None for min(n/4, `MOST_MODES`) of what there are.
    hyperparameters
        If given they are kept until `refit` is called; otherwise fitted after 1, 5, 10, 20, 40 …
        samples.
    noise, noise_prior
        Of a sample, as in `GaussianProcess.fit`.
    max_distance
        How far off the surface a sample may lie, mm.

    Attributes
    ----------
    predicted_errors
        Predicted nRMSE after each sample.
    knows_nothing
        As in `Reconstruction`, at the last fit.
    """

    def __init__(
        self,
        chamber: Chamber,
        *,
        n_modes: int | None = None,
        hyperparameters: Hyperparameters | None = None,
        noise: float | None = None,
        noise_prior: NoisePrior | None = None,
        max_distance: float = 5.0,
    ) -> None:
        self.chamber = chamber
        wanted = n_modes or min(chamber.mesh.n_vertices // 4, MOST_MODES)
        self.n_modes = min(wanted, chamber.basis.n_modes)
        self.max_distance = max_distance
        self.knows_nothing = hyperparameters is None
        self.predicted_errors: list[float] = []
        self._hyperparameters = hyperparameters
        self._refits_itself = hyperparameters is None
        self._noise, self._noise_prior = noise, noise_prior
        self._gram = chamber.accessible_gram[: self.n_modes, : self.n_modes]
        self._locator = Locator(chamber.mesh)
        self._sites: list[Sites] = []
        self._values: list[float] = []
        self._running: RunningPosterior | None = None

    @property
    def n_samples(self) -> int:
        """Number of samples so far."""
        return len(self._values)

    @property
    def values(self) -> Floats:
        """The samples, shape (N,)."""
        return np.array(self._values)

    @property
    def sites(self) -> Sites:
        """Where they were taken."""
        return Sites(
            np.array([site.corners[0] for site in self._sites], dtype=np.int64),
            np.array([site.weights[0] for site in self._sites]),
        )

    @property
    def hyperparameters(self) -> Hyperparameters:
        """As fitted last, or given."""
        if self._hyperparameters is None:
            raise InputError("no sample yet, so nothing is fitted: add one")
        return self._hyperparameters

    @property
    def running(self) -> RunningPosterior:
        """Map (`mean`), `variance`, `coefficients`, `covariance` and `predicted_nrmse`, as of now.

        Raises
        ------
        InputError
            If there is no sample yet.
        """
        if self._running is None:
            raise InputError("no sample yet, so there is no map: add one")
        return self._running

    @property
    def mean(self) -> PerVertex:
        """The map, shape (n,)."""
        return self.running.mean

    @property
    def std(self) -> PerVertex:
        """Its posterior standard deviation, shape (n,)."""
        deviation: PerVertex = np.sqrt(np.maximum(self.running.variance, 0.0))
        return deviation

    def add(self, position: Floats, value: float) -> float:
        """Take in a sample; gives back how far off the surface it lay, mm.

        Raises
        ------
        InputError
            If position or value are not finite, or the position lies too far off the surface or
            over a part that is not accessible (a cap); the session is then as it was.
        """
        place = np.asarray(position, dtype=float).reshape(-1)
        if place.shape != (3,) or not np.isfinite(place).all():
            raise InputError(f"position {position}: give three finite numbers, mm")
        site, distance = self._locator.nearest(place)
        if distance > self.max_distance:
            raise InputError(
                f"the sample lies {distance:.1f} mm off the surface, more than "
                f"{self.max_distance:g}: leave it out, or check units and frame"
            )
        self.add_at(site, value)
        return distance

    def add_at(self, site: Sites, value: float) -> None:
        """Take in a sample at a place of the surface; errors as `add`."""
        if len(site) != 1 or not math.isfinite(value):
            raise InputError(f"{len(site)} places, value {value}: give one place and a number")
        if not self.chamber.accessible[site.nearest_vertices[0]]:
            raise InputError("the sample lies over a cap or where none may be: leave it out")
        self._sites.append(site)
        self._values.append(float(value))
        if self._refits_itself and _is_refit(self.n_samples):
            self._fit()
        elif self._running is None:
            self._start_over()
        else:
            at_sample = site.of(self.chamber.basis.modes[:, : self.n_modes])[0]
            self._running.absorb(at_sample, float(value), self.hyperparameters.noise**2)
        self.predicted_errors.append(self.running.predicted_nrmse)

    def add_all(self, sites: Sites, values: Floats) -> None:
        """Take in many samples at once: the state is the same as one by one, but found at once.

        Hyper-parameters are fitted once, to all, unless they were given; `predicted_errors` holds
        NaN for all of these samples but the last.

        Raises
        ------
        InputError
            As `add_at`; the session is then as it was.
        """
        if not len(sites):
            return
        if len(sites) != len(values) or not np.isfinite(values).all():
            raise InputError(f"{len(sites)} places, {len(values)} values: give a number for each")
        if not self.chamber.accessible[sites.nearest_vertices].all():
            raise InputError("samples lie over a cap or where none may be: leave them out")
        self._sites += [sites[[index]] for index in range(len(sites))]
        self._values += values.tolist()
        if self._refits_itself:
            self._fit()
        else:
            self._start_over()
        self.predicted_errors += [math.nan] * (len(sites) - 1) + [self.running.predicted_nrmse]

    def undo(self) -> None:
        """Take back the last sample; hyper-parameters stay.

        Raises
        ------
        InputError
            If there is none.
        """
        if not self._values:
            raise InputError("there is no sample to take back")
        self._sites.pop()
        self._values.pop()
        self.predicted_errors.pop()
        if not self._values:
            self._running = None
        elif not self.running.take_back():
            self._start_over()

    def recent_change(self, n_samples: int = 10) -> float:
        """By how much the predicted error fell over the last samples: little means stop.

        Negative where it rose (a refit may find that less is known than was thought); NaN until
        there are more samples than that.
        """
        if len(self.predicted_errors) <= n_samples:
            return math.nan
        return self.predicted_errors[-1 - n_samples] - self.predicted_errors[-1]

    def refit(self) -> None:
        """Fit the hyper-parameters to the samples so far."""
        if not self._values:
            raise InputError("no sample yet, so nothing can be fitted: add one")
        self._fit()
        self.predicted_errors[-1] = self.running.predicted_nrmse

    def next_point(
        self, *, allowed: Truths | None = None, travel: Travel | None = None
    ) -> NextPoint:
        """Where the next sample lowers the error most; see `next_point.next_point`.

        Before the first sample the prior decides, with a length of a quarter of the diameter
        unless hyper-parameters were given.
        """
        running, noise_variance = self._ahead()
        return next_point(running, noise_variance, allowed=allowed, travel=travel)

    def next_points(
        self, count: int, *, allowed: Truths | None = None, travel: Travel | None = None
    ) -> tuple[NextPoint, ...]:
        """Several, in order, each as if those before it had been taken."""
        running, noise_variance = self._ahead()
        return next_points(running, count, noise_variance, allowed=allowed, travel=travel)

    def _ahead(self) -> tuple[RunningPosterior, float]:
        if self._running is None:
            return self._prior(), self._assumed().noise ** 2
        return self._running, self.hyperparameters.noise**2

    def _process(self) -> GaussianProcess:
        smoothness = (
            SMOOTHNESS if self._hyperparameters is None else self._hyperparameters.smoothness
        )
        return GaussianProcess(
            self.chamber, self.sites, n_modes=self.n_modes, smoothness=smoothness
        )

    def _fit(self) -> None:
        fitted = self._process().fit(self.values, noise=self._noise, noise_prior=self._noise_prior)
        self._hyperparameters = fitted.hyperparameters
        self.knows_nothing = fitted.knows_nothing
        self._running = RunningPosterior.of(self.chamber, self._gram, fitted.posterior, self.values)

    def _start_over(self) -> None:
        posterior = self._process().posterior(self.hyperparameters)
        self._running = RunningPosterior.of(self.chamber, self._gram, posterior, self.values)

    def _assumed(self) -> Hyperparameters:
        diameter = math.sqrt(self.chamber.basis.area / math.pi)
        return self._hyperparameters or Hyperparameters(LENGTH_SHARE * diameter, 1.0, 0.05)

    def _prior(self) -> RunningPosterior:
        assumed = self._assumed()
        variances = assumed.amplitude**2 * matern_variances(
            self.chamber.basis, length=assumed.length, smoothness=assumed.smoothness
        )
        covariance = np.diag(variances[: self.n_modes])
        return RunningPosterior(self.chamber, self._gram, np.zeros(self.n_modes), covariance)


def _is_refit(n_samples: int) -> bool:
    ratio = n_samples // FIRST_REFITS[-1]
    doubled = n_samples % FIRST_REFITS[-1] == 0 and ratio & (ratio - 1) == 0
    return n_samples in FIRST_REFITS or doubled
