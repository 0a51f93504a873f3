"""Local activation time: where a unipole falls steepest, where a bipole is largest."""

import math

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import savgol_filter

from auricle.electroanatomy.electrogram import MILLISECONDS, Electrogram
from auricle.electroanatomy.features.signal import checked_signal
from auricle.errors import InputError

METHODS = ("unipolar", "bipolar")
_POLYNOMIAL_ORDER = 2


def unipolar_activation(
    samples: ArrayLike, *, sampling_rate: float, derivative_window: float = 5.0
) -> int:
    """Sample at which a unipolar electrogram falls steepest: maximum −dV/dt.

    The derivative is that of a parabola fitted to the samples around each (Savitzky-Golay). The
    steepest fall marks activation under the electrode (Spach et al., Circ. Res. 30:505, 1972;
    Steinhaus, Circ. Res. 64:449, 1989).

    Parameters
    ----------
    samples
        Within the window of interest, mV.
    sampling_rate
        Hz.
    derivative_window
        ms that the parabola is fitted over; three samples at least.

    Raises
    ------
    InputError
        If the signal is shorter than that window or constant.

    Examples
    --------
    >>> time = np.arange(100.0)
    >>> unipolar_activation(-np.tanh((time - 40.0) / 5.0), sampling_rate=1000.0)
    40
    """
    width = _odd(derivative_window / MILLISECONDS * sampling_rate)
    signal = checked_signal(samples, sampling_rate=sampling_rate, shortest=width)
    _require_deflection(np.ptp(signal))
    return int(savgol_filter(signal, width, _POLYNOMIAL_ORDER, deriv=1).argmin())


def bipolar_activation(samples: ArrayLike, *, sampling_rate: float) -> int:
    """Sample at which a bipolar electrogram is largest in size, of either sign.

    The peak is the mark clinical systems set (Cantwell et al., Comput. Biol. Med. 65:229, 2015).

    Parameters
    ----------
    samples
        Within the window of interest, mV, about a baseline of 0.
    sampling_rate
        Hz.

    Raises
    ------
    InputError
        If the signal is constant.

    Examples
    --------
    >>> bipolar_activation([0.0, 0.1, -0.8, 0.5, 0.0], sampling_rate=1000.0)
    2
    """
    signal = checked_signal(samples, sampling_rate=sampling_rate)
    _require_deflection(np.ptp(signal))
    return int(np.abs(signal).argmax())


def annotated_activation_time(electrogram: Electrogram, *, method: str) -> float:
    """Activation in the window of interest, ms after the reference annotation.

    NaN where the electrogram lacks the channel or the annotation.

    Parameters
    ----------
    electrogram
        Its window of interest, all of it where that is not known.
    method
        One of `METHODS`: which channel, and by which mark.

    Raises
    ------
    InputError
        If the method is unknown, or the window lies outside the recording.
    """
    if method not in METHODS:
        raise InputError(f"method {method!r} is unknown: choose {' or '.join(METHODS)}")
    name = electrogram.unipolar if method == "unipolar" else electrogram.bipolar
    if not name or math.isnan(electrogram.reference_annotation):
        return math.nan
    window, rate = electrogram.window, electrogram.sampling_rate
    samples = electrogram.channel(name)[window]
    mark = unipolar_activation if method == "unipolar" else bipolar_activation
    tick = window.start + mark(samples, sampling_rate=rate)
    return float((tick - electrogram.reference_annotation) / rate * MILLISECONDS)


def _odd(length: float) -> int:
    whole = max(round(length), 3)
    return whole if whole % 2 else whole + 1


def _require_deflection(size: float) -> None:
    if size == 0.0:
        raise InputError("a signal is constant, it has no activation: leave it out")
