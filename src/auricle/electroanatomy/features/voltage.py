"""Voltage of an electrogram, peak to peak."""

import numpy as np
from numpy.typing import ArrayLike

from auricle.electroanatomy.features.signal import checked_signal


def peak_to_peak_voltage(samples: ArrayLike, *, sampling_rate: float) -> float:
    """Largest minus smallest sample of a signal within its window of interest, mV.

    Of a bipole the bipolar voltage (scar below 0.5 mV in the atrium by convention), of a unipole
    the unipolar one.

    Raises
    ------
    InputError
        If samples are missing.

    Examples
    --------
    >>> peak_to_peak_voltage([0.0, 1.5, -0.5, 0.0], sampling_rate=1000.0)
    2.0
    """
    return float(np.ptp(checked_signal(samples, sampling_rate=sampling_rate)))
