"""Judgement: whether a map's samples are enough, and where they are too sparse."""

from dataclasses import dataclass

import numpy as np

from auricle.arrays import PerVertex, Truths
from auricle.errors import BandError, InputError
from auricle.sampling.bandwidth import Bracket, bracket
from auricle.sampling.local_nyquist import LocalNyquist, local_nyquist, modal_transfer
from auricle.sampling.optimal_design import Prior
from auricle.sampling.reconstruction import Reconstruction
from auricle.sampling.samples import PlacedSamples
from auricle.sampling.stopping import Evidence, Verdict, verdict
from auricle.study.fitting import FittedMap


@dataclass(frozen=True, eq=False)
class Judgement:
    """What the samples of a fitted map are good for.

    Attributes
    ----------
    verdict
        Enough, or not yet and why.
    bracket
        Bandwidth at the share of the power that the target stands for; None if it lies beyond the
        harmonics.
    wavelengths
        Finest wavelength the samples support at each vertex of the chamber, shape (n,), mm;
        infinite where none.
    undersampled, undersampled_share
        Accessible vertices that do not support the bandwidth, shape (n,), and their share of the
        accessible area.
    """

    verdict: Verdict
    bracket: Bracket | None
    wavelengths: PerVertex
    undersampled: Truths
    undersampled_share: float


def judgement(
    fitted: FittedMap, placed: PlacedSamples, *, n_read: int, target_nrmse: float
) -> Judgement:
    """Judge whether the samples of a fitted map are enough for a target.

    Parameters
    ----------
    fitted
        The map.
    placed
        Its samples.
    n_read
        How many were handed in, those that could not be placed included.
    target_nrmse
        Error to reach.
    """
    found = fitted.reconstruction
    nyquist = _nyquist(fitted)
    aimed = _aimed(found, target_nrmse)
    undersampled = _undersampled(nyquist, None if found.knows_nothing else aimed, fitted)
    share = found.chamber.mean(undersampled.astype(float))
    judged = verdict(
        Evidence(
            n_samples=len(placed),
            knows_nothing=found.knows_nothing,
            target_nrmse=target_nrmse,
            predicted_nrmse=fitted.predicted_nrmse,
            bracket=aimed,
            undersampled_share=share,
            loo_variance=found.standardized_variance,
            left_out_share=1 - int(placed.counts.sum()) / n_read,
        )
    )
    return Judgement(judged, aimed, nyquist.wavelengths, undersampled, share)


def brackets(found: Reconstruction, share: float | None = None) -> tuple[Bracket, ...]:
    """Brackets of a map's bandwidth at the usual shares of its power, or at one.

    Of cosine and sine together their wider ends.

    Raises
    ------
    BandError
        If a share lies beyond the harmonics.
    InputError
        If the map is as good as constant.
    """
    means = found.coefficient_mean.reshape(len(found.coefficient_mean), -1)
    k = len(means)
    gram = found.chamber.accessible_gram[:k, :k]
    covariance = found.posterior.covariance.matrix
    shares = {} if share is None else {"shares": [share]}
    columns = [bracket(mean, covariance, gram=gram, **shares) for mean in means.T]
    return tuple(
        Bracket(parts[0].share, min(p.lower for p in parts), max(p.upper for p in parts))
        for parts in zip(*columns, strict=True)
    )


def _nyquist(fitted: FittedMap) -> LocalNyquist:
    found, chamber = fitted.reconstruction, fitted.process.chamber
    noise = max(found.hyperparameters.noise, 1e-6 * found.hyperparameters.amplitude)
    prior = Prior(found.posterior.prior_variances, noise)
    relative = np.square(fitted.process.noise_shape)
    transfer = modal_transfer(chamber, fitted.process.sites, prior, relative_noise=relative)
    return local_nyquist(chamber, transfer)


def _aimed(found: Reconstruction, target: float) -> Bracket | None:
    try:
        return brackets(found, 1 - target**2)[0]
    except (BandError, InputError):
        return None


def _undersampled(nyquist: LocalNyquist, aimed: Bracket | None, fitted: FittedMap) -> Truths:
    """Accessible vertices that do not support the bandwidth; all if it is beyond the harmonics."""
    accessible = fitted.reconstruction.chamber.accessible
    if aimed is None or aimed.upper > nyquist.edges[-1]:
        return accessible
    coarse: Truths = nyquist.undersampled(aimed.upper) & accessible
    return coarse
