"""Bounds of a map that its samples show: values that many of them share at either end."""

import math

from auricle.arrays import Floats

NARROW = 0.02
"""Width of an end, relative to the range of the samples; at least twice the noise."""
WIDE = 4
"""How much wider the part is that the samples of an end are held against."""


def plateau_bounds(values: Floats, noise: float) -> tuple[float, float]:
    """Least and largest value of a map, as far as samples of shape (N,) tell them.

    A map has a floor, or a ceiling, if its samples are at least as dense at their end as a bit
    off it, and two lie there: healthy tissue about a focus, dense scar. The tip of a cone or the
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
    width = max(NARROW * float(above.max()), 2 * noise)
    here = int((above <= width).sum())
    return here >= 2 and WIDE * here >= int((above <= WIDE * width).sum())
