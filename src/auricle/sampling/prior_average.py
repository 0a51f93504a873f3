"""The average of several priors, each by its probability; and what samples say of their tails."""

import math
from collections.abc import Sequence

import numpy as np
from scipy.stats import chi2

from auricle.arrays import Floats
from auricle.sampling.marginal_likelihood import Fit
from auricle.sampling.posterior import Posterior
from auricle.sampling.reconstruction import Hyperparameters
from auricle.sampling.remainder import Term

LEAST_WEIGHT = 0.03
"""Probability below which a prior does not enter the average."""


def averaged(
    candidates: Sequence[tuple[float, float]], fits: Sequence[Fit], *, weight: float = 1.0
) -> tuple[Hyperparameters, int]:
    """The mean of the covariances of several Matérn priors, weighted by their probability.

    Parameters
    ----------
    candidates
        ν and length of each; ν counts as 1/ν beforehand, which favours no scale of it.
    fits
        Best amplitude and noise of each, and their objective.
    weight
        Power the likelihoods are raised to: below 1 where they are surer than they should be.

    Returns
    -------
    Hyperparameters
        Terms of the prior and mean noise; length and smoothness of the most probable.
    int
        Index of that.
    """
    beforehand = [math.log(smoothness) for smoothness, _ in candidates]
    objectives = weight * np.array([fit.objective for fit in fits]) + beforehand
    best = int(np.argmin(objectives))
    shares = np.exp(objectives[best] - objectives)
    shares /= shares.sum()
    shares[shares < min(LEAST_WEIGHT, shares[best])] = 0.0
    shares /= shares.sum()
    squares = shares * [fit.amplitude**2 for fit in fits]
    terms = tuple(
        Term(length, smoothness, float(square / squares.sum()))
        for (smoothness, length), square in zip(candidates, squares, strict=True)
        if square > 0
    )
    noise = math.sqrt(shares @ [fit.noise**2 for fit in fits])
    smoothness, length = candidates[best]
    return Hyperparameters(length, math.sqrt(squares.sum()), noise, smoothness, terms), best


def typical_share(posterior: Posterior, values: Floats) -> float:
    """Typical over root mean square size of the standardised leave-one-out residuals.

    About 1 if they are normal, as noise makes them. Far below 1 if a few samples are missed by
    much and most by little: an edge, which a likelihood of normal noise takes for noise of all.

    Parameters
    ----------
    posterior
        Of the samples.
    values
        Shape (N, c).
    """
    own = np.sqrt(np.maximum(np.diag(posterior.precision), np.finfo(float).tiny))
    residuals = (posterior.precision @ (values - values.mean(axis=0))) / own[:, None]
    # By the squares of a sample's columns together, so that a turned phase has the same.
    squares = np.square(residuals).sum(axis=1)
    size = float(squares.mean())
    normal = float(chi2.median(values.shape[1])) / values.shape[1]
    return math.sqrt(float(np.median(squares)) / (normal * size)) if size > 0 else 1.0
