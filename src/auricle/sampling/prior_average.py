"""The average of several priors, each by its probability."""

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from auricle.sampling.marginal_likelihood import Fit
from auricle.sampling.reconstruction import Hyperparameters
from auricle.sampling.remainder import Term

BEFOREHAND: Mapping[float, float] = MappingProxyType({0.5: 0.35, 1.0: 0.4, 1.5: 0.2, 2.5: 0.05})
"""Probability of each ν before any sample: measured maps are rough, few maps very smooth."""
LEAST_WEIGHT = 0.03
"""Probability below which a prior does not enter the average."""


def averaged(
    candidates: Sequence[tuple[float, float]], fits: Sequence[Fit], *, weight: float = 1.0
) -> tuple[Hyperparameters, int]:
    """The mean of the covariances of several Matérn priors, weighted by their probability.

    Parameters
    ----------
    candidates
        ν and length of each; ν counts as `BEFOREHAND` says.
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
    beforehand = [-math.log(BEFOREHAND[smoothness]) for smoothness, _ in candidates]
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
