"""Robust reconstruction: samples that all their neighbours contradict are given less weight."""

import math
from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats, Integers
from auricle.sampling.gaussian_process import GaussianProcess, NoisePrior
from auricle.sampling.reconstruction import Reconstruction

THRESHOLD = 4.0
"""Standardised leave-one-out residual, in robust standard deviations, from which one is doubted."""
LARGEST_SHARE = 0.05
"""Of the samples, at most this share is ever given less weight."""
NEIGHBOURS = 8
"""None of so many nearest samples may side with a sample that is to be doubted."""
_ROUNDS = 3
_MAD_TO_STD = 1.4826


@dataclass(frozen=True, eq=False)
class RobustReconstruction:
    """A reconstruction and the samples it gives less weight.

    Attributes
    ----------
    reconstruction
        With the noise of those samples raised to their residual.
    doubted
        Their indices, ascending; empty if there are none.
    """

    reconstruction: Reconstruction
    doubted: Integers


def fit_robustly(
    process: GaussianProcess,
    values: Floats,
    *,
    noise: float | None = None,
    noise_prior: NoisePrior | None = None,
) -> RobustReconstruction:
    """Reconstruct, doubting isolated samples.

    A sample is doubted if its leave-one-out residual exceeds `THRESHOLD` robust standard
    deviations (1.4826·median |residual|, residuals standardised) and it stands alone: of its
    `NEIGHBOURS` nearest samples, by the prior's correlation along the surface, all lie nearer to
    what the others predict here than to the sample. At the border of a scar some side with it,
    so a true edge stays. The worst goes first, its neighbours only after a new fit. At most
    `LARGEST_SHARE` of the samples are doubted; fewer than 20 are too few to doubt any. Off
    unless called: sharp maps may pay for it.

    Parameters
    ----------
    process
        On the sites of the samples.
    values
        Shape (N,).
    noise, noise_prior
        As in `GaussianProcess.fit`; of samples that are not doubted.
    """
    reconstruction = process.fit(values, noise=noise, noise_prior=noise_prior)
    doubted = np.zeros(0, dtype=np.int64)
    most = int(LARGEST_SHARE * len(values))
    for _ in range(_ROUNDS):
        found = _isolated(process, reconstruction, most - len(doubted), doubted)
        if not len(found):
            break
        doubted = np.union1d(doubted, found)
        reconstruction = _refitted(process, reconstruction, doubted, noise, noise_prior)
    return RobustReconstruction(reconstruction, doubted)


def _isolated(
    process: GaussianProcess, reconstruction: Reconstruction, most: int, known: Integers
) -> Integers:
    """Samples to doubt next, at most `most`, beside those already `known`."""
    residuals, deviations = reconstruction.leave_one_out
    standardized = np.abs(residuals) / deviations
    scale = _MAD_TO_STD * float(np.median(standardized))
    suspects = np.flatnonzero(standardized > THRESHOLD * scale)
    suspects = suspects[np.argsort(-standardized[suspects], kind="stable")]
    neighbours = _nearest_samples(process, reconstruction)
    values = reconstruction.values
    chosen: list[int] = []
    for suspect in np.setdiff1d(suspects, known, assume_unique=True).tolist():
        around = neighbours[suspect]
        beyond_half = (values[suspect] - values[around]) / residuals[suspect] < 0.5
        lonely = not beyond_half.any() and not np.isin(around, chosen).any()
        if lonely and _without(reconstruction, suspect, chosen) > THRESHOLD * scale:
            chosen.append(suspect)
    return np.array(chosen[:most], dtype=np.int64)


def _without(reconstruction: Reconstruction, suspect: int, chosen: list[int]) -> float:
    """Standardised residual of a sample predicted without those already doubted, in closed form."""
    left_out = [suspect, *chosen]
    precision = reconstruction.posterior.precision
    seen = precision[left_out] @ (reconstruction.values - reconstruction.values.mean())
    covariance = np.linalg.inv(precision[np.ix_(left_out, left_out)])
    return float(abs(covariance[0] @ seen) / np.sqrt(covariance[0, 0]))


def _nearest_samples(process: GaussianProcess, reconstruction: Reconstruction) -> Integers:
    """The `NEIGHBOURS` samples of largest prior correlation with each, shape (N, 8)."""
    scaled = process.at_samples * np.sqrt(reconstruction.posterior.prior_variances)
    scaled /= np.linalg.norm(scaled, axis=1, keepdims=True)
    correlation = scaled @ scaled.T
    np.fill_diagonal(correlation, -np.inf)
    nearest: Integers = np.argsort(-correlation, axis=1, kind="stable")[:, :NEIGHBOURS]
    return nearest


def _refitted(
    process: GaussianProcess,
    reconstruction: Reconstruction,
    doubted: Integers,
    noise: float | None,
    noise_prior: NoisePrior | None,
) -> Reconstruction:
    """With the noise of the doubted raised to their residual."""
    residuals, _ = reconstruction.leave_one_out
    others = np.setdiff1d(np.arange(len(residuals)), doubted)
    level = reconstruction.hyperparameters.noise
    shape = process.noise_shape.copy()
    shape[doubted] = np.maximum(shape[doubted], np.abs(residuals[doubted]) / level)
    # `GaussianProcess` takes noise as the root mean square over all samples.
    raised = math.sqrt(np.square(shape).mean() / np.square(process.noise_shape[others]).mean())
    again = GaussianProcess(
        process.chamber,
        process.sites,
        noise_shape=shape,
        smoothness=process.smoothness,
        n_modes=process.n_modes,
    )
    return again.fit(
        reconstruction.values,
        noise=None if noise is None else noise * raised,
        noise_prior=noise_prior,
    )
