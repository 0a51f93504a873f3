"""Sample entropy: how little of a signal's future its past tells."""

import math

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from auricle.electroanatomy.features.signal import checked_signal
from auricle.errors import InputError


def sample_entropy(
    samples: ArrayLike, *, sampling_rate: float, order: int = 2, tolerance: float = 0.2
) -> float:
    """−ln(A/B): of the pairs alike over `order` samples (B), those alike over one more (A).

    Richman and Moorman, Am. J. Physiol. 278:H2039, 2000: alike is "no sample further apart than
    `tolerance` times the signal's standard deviation", pairs of a stretch with itself do not
    count. White noise gives −ln(erf(tolerance/2)) whatever the order, a period next to nothing.

    Parameters
    ----------
    samples
        Two hundred or more, for the value to mean something; the cost grows with their square.
    sampling_rate
        Hz; the value depends on it, so compare signals of one rate only.
    order
        Samples compared first.
    tolerance
        In standard deviations.

    Returns
    -------
    float
        Infinite where no pair stays alike, NaN where none is alike to begin with.

    Raises
    ------
    InputError
        If the signal is constant or too short, or an option is not positive.

    Examples
    --------
    >>> wave = np.tile([0.0, 1.0, 0.0, -1.0], 100)
    >>> round(sample_entropy(wave, sampling_rate=1000.0), 2)
    0.0
    """
    if order < 1 or tolerance <= 0:
        raise InputError("order and tolerance of the entropy are positive")
    signal = checked_signal(samples, sampling_rate=sampling_rate, shortest=order + 3)
    reach = tolerance * float(signal.std())
    if reach == 0.0:
        raise InputError("a signal is constant, it has no entropy: leave it out")
    stretches = np.lib.stride_tricks.sliding_window_view(signal, order + 1)
    longer, shorter = _pairs(stretches, reach), _pairs(stretches[:, :order], reach)
    if not shorter:
        return math.nan
    return math.log(shorter / longer) if longer else math.inf


def _pairs(stretches: ArrayLike, reach: float) -> int:
    """How many ordered pairs of different rows lie within reach in every column."""
    rows = np.ascontiguousarray(stretches)
    tree = cKDTree(rows)
    return int(tree.count_neighbors(tree, reach, p=np.inf)) - len(rows)
