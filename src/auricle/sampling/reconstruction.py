"""A reconstruction: the most probable map, its deviation everywhere, and how it checks out."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csr_array

from auricle.arrays import Floats, Modes, PerMode, PerVertex
from auricle.sampling.chamber import Chamber
from auricle.sampling.plateau import within_plateaus
from auricle.sampling.posterior import Posterior
from auricle.sampling.remainder import Remainder, Term
from auricle.sampling.sites import Sites
from auricle.sampling.splines import Spline, SplineTerm

_ENTRIES_AT_ONCE = 10_000_000


@dataclass(frozen=True)
class Hyperparameters:
    """What is fitted before the map is.

    Attributes
    ----------
    length
        Correlation length of the Matérn prior, mm; with several terms of the most probable.
    amplitude
        Prior standard deviation of the map's varying part, in the map's unit.
    noise
        Standard deviation of a sample (root mean square over the samples), in the map's unit.
    smoothness
        ν of the Matérn prior; with several terms of the most probable.
    terms
        What the prior is a mean of, each with what it holds beyond the harmonics; empty for one
        Matérn prior on the harmonics alone.
    splines
        What shares in the map beside the process.
    """

    length: float
    amplitude: float
    noise: float
    smoothness: float = 1.5
    terms: tuple[Term, ...] = ()
    splines: tuple[SplineTerm, ...] = ()


@dataclass(frozen=True, eq=False)
class Reconstruction:
    """A map reconstructed from samples, under a Gaussian-process prior.

    What no posterior can know is a feature that lies wholly between the samples: state it by the
    covering radius of the sites beside every number here.

    Attributes
    ----------
    chamber
        Where the map lives.
    posterior
        Of its coefficients; its `operator` is the linear reconstruction.
    values
        The samples, shape (N,) or (N, c).
    hyperparameters
        As fitted or given.
    log_marginal_likelihood
        Of the samples, the constant integrated out; NaN if the hyper-parameters were given.
    knows_nothing
        Whether the samples (fewer than five, all equal, all in one place) say so little that
        amplitude and length are guesses, and with them every number here.
    remainder
        What the prior holds beyond the harmonics; None for nothing.
    sites
        Where the samples are; needed with a remainder.
    splines
        What shares in the map beside the process, and how.
    """

    chamber: Chamber
    posterior: Posterior
    values: Floats
    hyperparameters: Hyperparameters
    log_marginal_likelihood: float = math.nan
    knows_nothing: bool = False
    remainder: Remainder | None = None
    sites: Sites | None = None
    splines: tuple[tuple[Spline, SplineTerm], ...] = ()

    @property
    def _modes(self) -> Modes:
        return self.chamber.basis.modes[:, : self.posterior.at_samples.shape[1]]

    @cached_property
    def coefficient_mean(self) -> PerMode:
        """Most probable coefficients, shape (k,) or (k, c)."""
        # The middle is taken out first so that a large offset costs no digits.
        middle = self.values.mean(axis=0)
        mean: Floats = self.posterior.operator @ (self.values - middle)
        mean[0] += middle / self._modes[0, 0]
        return mean

    @cached_property
    def coefficient_variance(self) -> PerMode:
        """Posterior variance of each coefficient, shape (k,)."""
        return self.posterior.covariance.variances

    @cached_property
    def mean(self) -> Floats:
        """The map, shape (n,) or (n, c).

        Of the process and the splines by their shares if there are splines, and then within what
        the samples of one column show of its plateaus (`within_plateaus`). Columns together have
        none: cosine and sine have no bound of their own that turns with the phase.
        """
        if not self.splines:
            return self.process_mean
        mixed: Floats = np.tensordot(*self._members, 1)
        if mixed.shape[1] == 1:
            mixed = within_plateaus(mixed, self.values.ravel(), self.hyperparameters.noise)
        return mixed.reshape(-1, *self.values.shape[1:])

    @cached_property
    def _members(self) -> tuple[Floats, Floats]:
        """Shares (m,) and maps (m, n, c) of the process and of each spline."""
        columns = self.values.reshape(len(self.values), -1)
        middle = columns.mean(axis=0)
        maps = [self.process_mean.reshape(len(self._modes), -1)]
        maps += [
            middle + spline.mean(columns - middle, term.smoothing) for spline, term in self.splines
        ]
        return self._shares, np.array(maps)

    @property
    def _shares(self) -> Floats:
        shares = [term.share for _, term in self.splines]
        return np.array([1 - sum(shares), *shares])

    @cached_property
    def process_mean(self) -> Floats:
        """The map of the Gaussian process alone, shape (n,) or (n, c)."""
        values: Floats = self._modes @ self.coefficient_mean
        if self.remainder is None:
            return values
        # The precision is blind to a constant: taken out first, it costs no digits.
        left = self.posterior.precision @ (self.values - self.values.mean(axis=0))
        detailed: Floats = values + self._detail_weights @ left
        return detailed

    @property
    def detail_variance(self) -> float:
        """Prior variance of what the map holds beyond the harmonics, in the map's unit squared."""
        scale = self.hyperparameters.amplitude**2
        return scale * self.remainder.variance if self.remainder else 0.0

    @cached_property
    def variance(self) -> PerVertex:
        """Posterior variance of the map, shape (n,); the same for every column.

        Of a mixture that of the process and the members' spread (law of total variance, each
        member being taken for as sure as the process; mean over the columns).
        """
        if not self.splines:
            return self.process_variance
        shares, members = self._members
        middle = np.tensordot(shares, members, 1)
        spread: Floats = np.tensordot(shares, np.square(members - middle), 1)
        return np.asarray(self.process_variance + spread.mean(axis=1))

    @cached_property
    def process_variance(self) -> PerVertex:
        """Posterior variance of the Gaussian process alone, shape (n,)."""
        carried = self.posterior.covariance.seen_by(self._modes)
        if self.remainder is None:
            return carried
        return np.asarray(np.maximum(carried + self._added_by_detail(), 0.0))

    def _added_by_detail(self) -> PerVertex:
        """What detail adds to the variance that the modes carry, shape (n,); may be negative.

        With τ² the detail's variance, d its covariance with the samples, P the precision and w
        the weights of the samples in what the modes carry: τ² − dᵀPd − 2·dᵀw.
        """
        added = np.full(len(self._modes), self.detail_variance)
        n_samples = len(self.values)
        rows = max(_ENTRIES_AT_ONCE // n_samples, 1)
        for start in range(0, len(added), rows):
            block = slice(start, start + rows)
            weights = self._detail_weights[block]
            told = weights.multiply(weights @ self.posterior.precision).sum(axis=1)
            shared = weights @ self.posterior.operator.T
            added[block] -= told + 2 * np.einsum("nk,nk->n", self._modes[block], shared)
        return added

    @cached_property
    def _detail_weights(self) -> csr_array:
        """Covariance of the map's detail at vertices and samples, shape (n, N)."""
        if self.remainder is None or self.sites is None:
            return csr_array((len(self._modes), len(self.values)))
        return self.detail_variance * self.remainder.between(self.chamber, self.sites)

    @property
    def std(self) -> PerVertex:
        """Posterior standard deviation of the map (not of a further sample), shape (n,)."""
        deviation: PerVertex = np.sqrt(self.variance)
        return deviation

    def std_with_detail(self, *, noise: float = 0.0) -> PerVertex:
        """Standard deviation if part of what was fitted as noise belongs to the map, shape (n,).

        One sample a place cannot tell a sample's own noise from detail of the map too fine for
        the samples. With the former known to be `noise`, the rest of the fitted variance is
        detail, and a vertex may differ by it; with 0 all of it is. On a clinical map (OpenEP's
        data set 2, from 200 samples on) `std` covered 83 to 95 % of the map as exported, this
        92.6 to 95.9 %.
        """
        deviation: PerVertex = np.sqrt(self.variance + self._detail(noise))
        return deviation

    def predicted_nrmse_with_detail(self, *, noise: float = 0.0) -> float:
        """`predicted_nrmse` if the fitted noise beyond `noise` is detail of the map."""
        error, variation = self._expected_squares
        detail = self._detail(noise)
        return math.sqrt((error + detail) / (variation + detail))

    def _detail(self, noise: float) -> float:
        return max(self.hyperparameters.noise**2 - noise**2, 0.0)

    @property
    def predicted_nrmse(self) -> float:
        """Expected error over the accessible area, relative to the map's expected deviation.

        √(E‖error‖² / E‖map − its mean‖²), both given the samples; what the prior holds beyond
        the harmonics is in both.
        """
        error, variation = self._expected_squares
        return math.sqrt(error / variation)

    @cached_property
    def _expected_squares(self) -> tuple[float, float]:
        """Mean square error, and mean square deviation of the map from its mean, unit²."""
        if self.remainder is None and not self.splines:
            # tr(GΣ)/A: the mean of the variance, without looking at every vertex.
            covariance = self.posterior.covariance.matrix
            gram = self.chamber.accessible_gram[: len(covariance), : len(covariance)]
            error = float(np.vdot(gram, covariance)) / self.chamber.accessible_area
        else:
            error = self.chamber.mean(self.variance)
        columns = self.mean.reshape(len(self.mean), -1)
        varying = float(
            np.mean(
                [self.chamber.rms(column - self.chamber.mean(column)) ** 2 for column in columns.T]
            )
        )
        return error, varying + error - self._variance_of_mean()

    @cached_property
    def planned_nrmse(self) -> float:
        """The same before any value is known: relative to the prior's deviation of maps."""
        error = self.chamber.mean(self.process_variance)
        return math.sqrt(error / prior_variation(self.chamber, self.posterior.prior_variances))

    def _variance_of_mean(self) -> float:
        """Posterior variance of the map's mean over the accessible area."""
        weights = self.chamber.accessible_areas @ self._modes / self.chamber.accessible_area
        return float(self.posterior.covariance.seen_by(weights[None, :])[0])

    @cached_property
    def leave_one_out(self) -> tuple[Floats, Floats]:
        """Residual of each sample predicted from the others, and its expected deviation.

        Shapes (N,) or (N, c), and (N,); see `Posterior.leave_one_out`. Of a mixture the members'
        by their shares, and their spread; the map's bounds are not looked at.
        """
        centred = self.values - self.values.mean(axis=0)
        residuals, deviations = self.posterior.leave_one_out(centred)
        if not self.splines:
            return residuals, deviations
        columns = centred.reshape(len(centred), -1)
        left_out = [residuals.reshape(columns.shape)]
        left_out += [spline.left_out(columns, term.smoothing) for spline, term in self.splines]
        members = np.array(left_out)
        mixed = np.tensordot(self._shares, members, 1)
        spread = np.tensordot(self._shares, np.square(members - mixed), 1).mean(axis=1)
        return mixed.reshape(centred.shape), np.sqrt(deviations**2 + spread)

    @property
    def standardized_variance(self) -> float:
        """Mean square of the leave-one-out residuals over their deviations.

        About 1 if the reconstruction is as sure as it may be; above 1.5 it is too sure.
        NaN with one sample.
        """
        residuals, deviations = self.leave_one_out
        predictable = np.isfinite(deviations)
        if not predictable.any():
            return math.nan
        columns = residuals.reshape(len(deviations), -1)[predictable]
        return float(np.square(columns / deviations[predictable, None]).mean())

    def draw(self, rng: np.random.Generator, count: int) -> Floats:
        """Maps that agree with the samples as well as the truth may, shape (count, n).

        Of the first column if there are several. What the harmonics carry of the process: detail
        beyond them, which is nearly independent from vertex to vertex, is left out, and splines.
        """
        mean = self.coefficient_mean.reshape(len(self.coefficient_mean), -1)[:, :1]
        maps: Floats = (self._modes @ (mean + self.posterior.draw(rng, count))).T
        return maps


def prior_variation(chamber: Chamber, prior_variances: PerMode) -> float:
    """Expected mean square deviation of a prior map from its mean, over the accessible area."""
    modes = chamber.basis.modes[:, : len(prior_variances)]
    weights = chamber.accessible_areas / chamber.accessible_area
    squares = weights @ (np.square(modes) @ prior_variances)
    return float(squares - np.square(weights @ modes) @ prior_variances)
