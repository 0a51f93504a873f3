"""Bounds of a map that its samples show: values that many of them share at either end."""

import math

from auricle.arrays import Floats

NARROW = 0.03
"""Width of an end, relative to the range of the samples; at least three times the noise."""
WIDE = 4
"""How much wider the part is that the samples of an end are held against."""
LEAST_SHARE = 0.5
"""Of the samples in the wider part, at least this share lies at the end itself of a plateau.

A smooth top of a map would have a quarter of them there, the tip of a cone a sixteenth.
"""


def plateau_bounds(values: Floats, noise: float) -> tuple[float, float]:
    """Least and largest value of a map, as far as samples of shape (N,) tell them.

    A map has a floor, or a ceiling, if its samples crowd at their end (`LEAST_SHARE`), and two
    lie there: healthy tissue about a focus, dense scar. A smooth top, the tip of a cone or the
    last of an activation is no bound: few samples come near it, and the map may go beyond.
    Infinite where there is no bound.

    Parameters
    ----------
    values
        Shape (N,).
    noise
        Standard deviation of a sample.

    Examples
    --------
    Zeros here and ones there are bounds; the tip of a cone is none:

    >>> import numpy as np
    >>> plateau_bounds(np.repeat([0.0, 1.0], 20), 0.0)
    (0.0, 1.0)
    >>> plateau_bounds(np.sqrt(np.linspace(0.01, 1.0, 40)), 0.0)[0]
    -inf
    """
    lower = float(values.min()) if _ends_flat(values, noise) else -math.inf
    upper = float(values.max()) if _ends_flat(-values, noise) else math.inf
    return lower, upper


def _ends_flat(values: Floats, noise: float) -> bool:
    """Whether many samples share the least value."""
    above = values - values.min()
    width = max(NARROW * float(above.max()), 3 * noise)
    here = int((above <= width).sum())
    return here >= 2 and here >= LEAST_SHARE * int((above <= WIDE * width).sum())
