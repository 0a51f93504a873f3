"""Cycle length of a rhythm, from how a signal repeats itself."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import correlate, detrend, find_peaks

from auricle.electroanatomy.electrogram import MILLISECONDS
from auricle.electroanatomy.features.signal import checked_signal
from auricle.errors import InputError

_AS_HIGH = 0.9


def cycle_length(
    samples: ArrayLike, *, sampling_rate: float, shortest: float = 100.0, longest: float = 1200.0
) -> float:
    """Lag at which a signal is most like itself, ms.

    The unbiased autocorrelation's first peak that is at least 0.9 of its highest between the two
    lags, refined by a parabola: twice the cycle is as good a match, so the first counts.

    Parameters
    ----------
    samples
        Two cycles or more.
    sampling_rate
        Hz.
    shortest, longest
        Lags looked at, ms; the longest is cut to half of the signal.

    Raises
    ------
    InputError
        If the signal is shorter than twice the shortest lag, or nothing repeats.

    Examples
    --------
    >>> time = np.arange(2000)
    >>> round(cycle_length(np.exp(-((time % 250 - 125) / 9.0) ** 2), sampling_rate=1000.0))
    250
    """
    first = max(round(shortest / MILLISECONDS * sampling_rate), 1)
    signal = detrend(
        checked_signal(samples, sampling_rate=sampling_rate, shortest=2 * first + 2),
        type="constant",
    )
    last = min(round(longest / MILLISECONDS * sampling_rate), len(signal) // 2)
    likeness = correlate(signal, signal, method="fft")[len(signal) - 1 :]
    likeness = likeness / np.arange(len(signal), 0, -1)
    peaks, _ = find_peaks(likeness[: last + 2])
    peaks = peaks[(peaks >= first) & (peaks <= last)]
    heights = likeness[peaks]
    if not len(peaks) or heights.max() <= 0:
        raise InputError("a signal does not repeat itself: give two cycles or more")
    peak = int(peaks[heights >= _AS_HIGH * heights.max()][0])
    before, here, after = likeness[peak - 1 : peak + 2]
    bend = before - 2.0 * here + after
    shift = 0.5 * (before - after) / bend if bend else 0.0
    return float((peak + shift) / sampling_rate * MILLISECONDS)
