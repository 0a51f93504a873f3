"""A map of several members: shares of the process and of each spline, as the samples tell."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from auricle.arrays import Floats, Integers
from auricle.sampling.neighbourhoods import left_out_together
from auricle.sampling.reconstruction import Reconstruction
from auricle.sampling.splines import Spline, SplineTerm

POWERS: Mapping[float, float] = MappingProxyType({0.6: 0.005, 1.0: 0.025, 1.4: 0.05, 1.8: 0.92})
"""Power of the distance of every spline, and its share among them before any sample."""
PROCESS = 0.55
"""Share of the Gaussian process before any sample."""
CAUTION = 2.0
"""What the samples' evidence between splines is divided by: residuals are not independent."""
HELD = 300
"""Samples that `PROCESS` counts as: the process and the splines together err alike."""
MOST_HEARD = 200
"""Samples that count at most: what many miss tells of the map between them, less of its gaps."""
LEAST_SHARE = 0.01
"""Share below which a spline does not enter the map."""


def mixed(
    found: Reconstruction,
    spline: Callable[[float], Spline],
    together: tuple[Integers, ...],
) -> Reconstruction:
    """The map of a process, with splines of the same noise beside it by their `shares`.

    Parameters
    ----------
    found
        The process alone.
    spline
        Of each power, on the same samples.
    together
        Samples that are left out together (`auricle.sampling.neighbourhoods.neighbourhoods`).
    """
    values = found.values.reshape(len(found.values), -1)
    values = values - values.mean(axis=0)
    splines = {power: spline(power) for power in POWERS}
    smoothings = {
        power: each.smoothing(values, found.hyperparameters.noise)
        for power, each in splines.items()
    }
    precisions = [
        found.posterior.precision,
        *(each.precision(smoothings[power]) for power, each in splines.items()),
    ]
    missed = np.array([left_out_together(each, values, together) for each in precisions])
    terms = tuple(
        SplineTerm(power, float(share), smoothings[power])
        for power, share in zip(POWERS, shares(missed)[1:], strict=True)
        if share > 0
    )
    return replace(
        found,
        hyperparameters=replace(found.hyperparameters, splines=terms),
        splines=tuple((splines[term.power], term) for term in terms),
    )


def shares(missed: Floats) -> Floats:
    """Shares in the map of the process and of the splines, shape (1 + s,), of sum 1.

    Among the splines by `POWERS` times their evidence: with E the mean square of what a spline
    misses of samples that are left out with their neighbours, E^(−N/2) to the power 1/`CAUTION`;
    N counts to `MOST_HEARD`. The process' share is the one with which the mean of both would miss
    least, by least squares from `PROCESS`, which counts as `HELD` samples.

    Parameters
    ----------
    missed
        By the process and by each spline of `POWERS`, shape (1 + s, N, c).

    Examples
    --------
    Where all miss alike nothing is learned; a rough spline that misses much less has all that
    splines share:

    >>> alike = np.ones((5, 40, 1))
    >>> shares(alike).round(3).tolist()
    [0.551, 0.0, 0.011, 0.023, 0.415]
    >>> shares(alike * np.array([1, 1, 0.5, 1, 1])[:, None, None]).round(2)[2:].tolist()
    [0.53, 0.0, 0.0]
    """
    products = np.einsum("mic,nic->mn", missed, missed) / missed.shape[1]
    products += np.finfo(float).tiny * np.eye(len(products))
    heard = min(missed.shape[1], MOST_HEARD)
    evidence = np.log(list(POWERS.values())) - (
        heard / (2 * CAUTION) * np.log(np.diag(products)[1:])
    )
    among = np.exp(evidence - evidence.max())
    among /= among.sum()
    process = _process_share(products, among, HELD / heard)
    both = np.append(process, (1 - process) * among)
    both[1:][both[1:] < LEAST_SHARE] = 0.0
    return np.asarray(both / both.sum())


def _process_share(products: Floats, among: Floats, held: float) -> float:
    """The process' share against a mean of splines, from mean products of what each misses."""
    own, across = products[0, 0], among @ products[0, 1:]
    others = among @ products[1:, 1:] @ among
    mean = PROCESS**2 * own + 2 * PROCESS * (1 - PROCESS) * across + (1 - PROCESS) ** 2 * others
    best = (others - across + held * mean * PROCESS) / (own + others - 2 * across + held * mean)
    return float(np.clip(best, 0.0, 1.0))
