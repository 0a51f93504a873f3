"""What every feature demands of a signal before it measures anything."""

import math

import numpy as np
from numpy.typing import ArrayLike

from auricle.arrays import Floats
from auricle.errors import InputError


def checked_signal(samples: ArrayLike, *, sampling_rate: float, shortest: int = 3) -> Floats:
    """The samples as an array of shape (s,), all finite.

    Raises
    ------
    InputError
        If there are fewer than `shortest`, one is not finite, or the rate is not positive.
    """
    signal = np.asarray(samples, np.float64)
    if signal.ndim != 1 or len(signal) < shortest:
        raise InputError(f"a signal of shape {signal.shape}: give {shortest} samples or more")
    if not np.isfinite(signal).all():
        raise InputError("a signal has missing samples: leave it out, or fill it and say so")
    if not (math.isfinite(sampling_rate) and sampling_rate > 0):
        raise InputError(f"sampling rate {sampling_rate}: give a positive number (Hz)")
    return signal
