"""Fitting: a map of either kind from placed samples, with the noise they are stated to have."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from auricle.arrays import Floats, Integers, PerVertex
from auricle.sampling.circular import CircularReconstruction, fit_circular
from auricle.sampling.cycle import circular_difference
from auricle.sampling.gaussian_process import GaussianProcess, NoisePrior
from auricle.sampling.reconstruction import Reconstruction
from auricle.sampling.robust import fit_robustly
from auricle.sampling.samples import PlacedSamples
from auricle.study.mapping_result import MappingConfig


@dataclass(frozen=True, eq=False)
class FittedMap:
    """A map, and what of its fitted noise is the samples' own.

    One sample a place cannot tell its own noise from detail of the map too fine for the samples.
    What is fitted beyond the noise stated (all of it, if none is) therefore counts as detail here:
    deviations and errors are those of the map as a further, noiseless sample would show it.

    Attributes
    ----------
    process
        On the samples' sites, their noise as it was used in the end.
    reconstruction
        Of the values; of a re-entry, of cosine and sine.
    circular
        The times of a re-entry; None for other maps.
    doubted
        Indices of samples that count less.
    unit
        The values' unit over that of the reconstruction: 1, or cycle·√2/(2π) for a re-entry.
    stated
        Noise the samples are stated to have, root mean square over those not doubted, in the
        values' unit; None if nothing is stated.
    """

    process: GaussianProcess
    reconstruction: Reconstruction
    circular: CircularReconstruction | None
    doubted: Integers
    unit: float
    stated: float | None

    @cached_property
    def noise(self) -> float:
        """Noise fitted, root mean square over the samples not doubted, in the values' unit."""
        variances = np.delete(self.reconstruction.posterior.noise_variances, self.doubted)
        return self.unit * float(np.sqrt(variances.mean()))

    @property
    def detail(self) -> float:
        """Deviation of the detail too fine for the samples, in the values' unit."""
        return math.sqrt(max(self.noise**2 - (self.stated or 0.0) ** 2, 0.0))

    @property
    def predicted_nrmse(self) -> float:
        """Expected error of the map, detail included, relative to its expected deviation."""
        return self.nrmse_of(self.reconstruction)

    @property
    def smooth_nrmse(self) -> float:
        """The same if all that was fitted as noise is noise."""
        return self.reconstruction.predicted_nrmse

    @cached_property
    def std(self) -> PerVertex:
        """Standard deviation of the map, detail included, shape (n,), in the values' unit."""
        if self.circular is None:
            return self.reconstruction.std_with_detail(noise=self._own(self.reconstruction))
        unknown = self.circular.cycle_length / math.sqrt(12)
        return np.asarray(np.minimum(np.hypot(self.circular.std, self.detail), unknown))

    @property
    def residuals(self) -> Floats:
        """Each sample minus what the others predict there, shape (m,), in the values' unit."""
        found = self.reconstruction
        residuals, _ = found.leave_one_out
        if self.circular is None:
            return residuals
        predicted = found.values - residuals
        angles = (np.arctan2(each[:, 1], each[:, 0]) for each in (found.values, predicted))
        cycle = self.circular.cycle_length
        sampled, others = (angle * cycle / (2 * math.pi) for angle in angles)
        return circular_difference(sampled, others, cycle)

    def nrmse_of(self, reconstruction: Reconstruction) -> float:
        """`predicted_nrmse` of a reconstruction from some of the samples."""
        return reconstruction.predicted_nrmse_with_detail(noise=self._own(reconstruction))

    def nrmse_after(self, drops: Floats) -> Floats:
        """`predicted_nrmse` once the mean variance has dropped by these, shape (c,)."""
        found = self.reconstruction
        now = found.chamber.mean(found.variance)
        detail = (self.detail / self.unit) ** 2
        variation = now / found.predicted_nrmse**2 + detail
        errors: Floats = np.sqrt((np.maximum(now - drops, 0.0) + detail) / variation)
        return errors

    def _own(self, reconstruction: Reconstruction) -> float:
        """The noise to state for a reconstruction, so that its detail is that of this map."""
        level = reconstruction.hyperparameters.noise
        return math.sqrt(max(level**2 - (self.detail / self.unit) ** 2, 0.0))


def fitted_map(process: GaussianProcess, placed: PlacedSamples, config: MappingConfig) -> FittedMap:
    """Fit the map that the parameters ask for.

    A noise that is stated (for all samples, or in a column for each) is the centre of the prior
    on it, as in `auricle.sampling.gaussian_process.reconstruct`: positions that are off and
    detail may add to it.

    Raises
    ------
    InputError
        As `GaussianProcess.fit`.
    """
    noise = _stated(placed, config)
    prior = None
    if noise is not None and noise.min() > 0:
        prior = NoisePrior(float(np.median(noise)))
    doubted = np.zeros(0, dtype=np.int64)
    cycle = config.cycle_length_ms
    circular, unit = None, 1.0
    if cycle is not None:
        circular = fit_circular(process, placed.values, cycle, noise_prior=prior)
        unit = cycle * math.sqrt(2) / (2 * math.pi)
        reconstruction = circular.components
    elif config.robust:
        robust = fit_robustly(process, placed.values, noise_prior=prior)
        reconstruction, doubted = robust.reconstruction, robust.doubted
        process = _reweighted(process, reconstruction)
    else:
        reconstruction = process.fit(placed.values, noise_prior=prior)
    stated = None
    if noise is not None:
        stated = float(np.sqrt(np.square(np.delete(noise, doubted)).mean()))
    return FittedMap(process, reconstruction, circular, doubted, unit, stated)


def _stated(placed: PlacedSamples, config: MappingConfig) -> Floats | None:
    """Noise of each place as stated, shape (m,); None if it is not."""
    if config.noise is None:
        return placed.noise
    noise: Floats = config.noise * placed.noise_shape
    return noise


def _reweighted(process: GaussianProcess, reconstruction: Reconstruction) -> GaussianProcess:
    """The process with the noise that a reconstruction ended with."""
    return GaussianProcess(
        process.chamber,
        process.sites,
        noise_shape=np.sqrt(reconstruction.posterior.noise_variances),
        smoothness=process.smoothness,
        n_modes=process.n_modes,
    )
