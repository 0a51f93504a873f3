"""Fractionation of a bipolar electrogram: the mean interval between its deflections."""

import math

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import find_peaks

from auricle.arrays import Integers
from auricle.electroanatomy.electrogram import MILLISECONDS
from auricle.electroanatomy.features.signal import checked_signal

FRACTIONATED_MS = 120.0
"""Mean interval up to which an electrogram counts as fractionated (Nademanee et al., 2004)."""


def deflections(
    samples: ArrayLike,
    *,
    sampling_rate: float,
    sensitivity: float = 0.05,
    width: float = 10.0,
    refractory: float = 40.0,
) -> Integers:
    """Samples at which deflections of a bipole fall through their middle, shape (d,).

    A deflection is a maximum with a minimum at most `width` after it and `sensitivity` or more
    below it; from each on, `refractory` must pass before the next counts.

    Parameters
    ----------
    samples
        mV, without far field.
    sampling_rate
        Hz.
    sensitivity
        Peak to peak, mV.
    width, refractory
        ms.

    Raises
    ------
    InputError
        If samples are missing.
    """
    signal = checked_signal(samples, sampling_rate=sampling_rate)
    reach = max(round(width / MILLISECONDS * sampling_rate), 1)
    pause = refractory / MILLISECONDS * sampling_rate
    tops, _ = find_peaks(signal)
    found: list[int] = []
    for top in tops.tolist():
        after = signal[top : top + reach + 1]
        bottom = top + int(after.argmin())
        if signal[top] - signal[bottom] < sensitivity:
            continue
        middle = (top + bottom) // 2
        if not found or middle - found[-1] >= pause:
            found.append(middle)
    return np.array(found, np.int64)


def complex_fractionated_interval(
    samples: ArrayLike,
    *,
    sampling_rate: float,
    sensitivity: float = 0.05,
    width: float = 10.0,
    refractory: float = 40.0,
) -> float:
    """Mean interval between deflections, ms; NaN if there are fewer than two.

    The CFE mean of EnSite: Verma et al., Heart Rhythm 5:198, 2008, with its usual sensitivity,
    width and refractory time; Nademanee et al. (J. Am. Coll. Cardiol. 43:2044, 2004) call up to
    120 ms fractionated. Arguments and errors as those of `deflections`.

    Examples
    --------
    >>> time = np.arange(1000)
    >>> train = np.sin(2 * np.pi * time / 8.0) * (time % 80 < 8)
    >>> complex_fractionated_interval(train, sampling_rate=1000.0)
    80.0
    """
    found = deflections(
        samples,
        sampling_rate=sampling_rate,
        sensitivity=sensitivity,
        width=width,
        refractory=refractory,
    )
    if len(found) < 2:
        return math.nan
    return float(np.diff(found).mean() / sampling_rate * MILLISECONDS)
