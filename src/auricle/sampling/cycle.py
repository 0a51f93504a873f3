"""Times on a cycle: whole cycles apart is the same."""

import numpy as np

from auricle.arrays import Floats


def wrapped(times: Floats, cycle_length: float) -> Floats:
    """Times moved by whole cycles into [0, cycle length).

    >>> wrapped(np.array([-10.0, 0.0, 190.0, 410.0]), 200.0).tolist()
    [190.0, 0.0, 190.0, 10.0]
    """
    remainder = np.mod(times, cycle_length)
    # A time just below 0 comes out as the cycle length itself.
    within: Floats = np.where(remainder >= cycle_length, 0.0, remainder)
    return within


def circular_difference(times: Floats, others: Floats, cycle_length: float) -> Floats:
    """`times` − `others`, the short way round: in [−half, half) of the cycle."""
    half = cycle_length / 2
    difference: Floats = wrapped(times - others + half, cycle_length) - half
    return difference
