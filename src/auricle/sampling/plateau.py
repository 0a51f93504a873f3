"""Plateaus of a map: values that many samples share at an end, and what follows from two."""

import math
from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats, Truths

NARROW = 0.03
"""Width of a plateau without noise, relative to the range of the samples."""
IN_NOISE = 3
"""Width, in deviations of the noise found, that is taken without a look at the shape."""
WIDEST = 0.3
"""Of the range: a wider crowd is no plateau."""
ABOUT = 4
"""How much wider the part is that a crowd is held against."""
MOST_ABOUT = 0.6
"""Of the range: where that part ends at the latest; the other plateau may begin there."""
THINNER = 1 / 3
"""How dense the samples are beside a crowd at most, compared with those in it.

About a smooth top of a map they would be as dense, about the tip of a cone denser."""
MUCH_THINNER = 0.1
"""The same of a crowd that is to tell its own width: the tail of skewed values is denser."""
CENTRAL = 0.6
"""Share of such a crowd that lies in the middle half of its width: of normal noise from end to
end 0.8, of values without a plateau 0.5."""
FEWEST, LEAST_SHARE = 5, 0.15
"""Samples, and share of all, of such a crowd."""
END_TO_END = 5
"""Deviations from end to end of the noise on a plateau."""
STEEPNESS = 1.2
"""How much steeper than the mean of its members a map is half-way between two plateaus."""
_WIDTHS, _QUARTER = 8, 0.25


@dataclass(frozen=True)
class _Crowd:
    """Samples that share the least value, as far as noise lets them."""

    lowest: float
    median: float
    deviation: float
    count: int


def plateau_bounds(values: Floats, noise: float) -> tuple[float, float]:
    """Least and largest value of a map, as far as samples of shape (N,) tell them.

    A map has a floor, or a ceiling, if its samples crowd at their end and are few beside it:
    healthy tissue about a focus, dense scar. A smooth top, the tip of a cone or the last of an
    activation is no bound: few samples come near it, and the map may go beyond. How wide noise
    makes a crowd is seen on it, since what is fitted as noise to a map with edges is often too
    small; the fuller crowd tells it to the other end. The bound is the median of a crowd, the
    outermost value of one too small to have noise seen on it. Infinite where there is no bound.

    Parameters
    ----------
    values
        Shape (N,).
    noise
        Standard deviation of a sample, as fitted.

    Examples
    --------
    Zeros here and ones there are bounds; the tip of a cone is none:

    >>> import numpy as np
    >>> plateau_bounds(np.repeat([0.0, 1.0], 20), 0.0)
    (0.0, 1.0)
    >>> plateau_bounds(np.sqrt(np.linspace(0.01, 1.0, 40)), 0.0)[0]
    -inf
    """
    if not np.ptp(values) > 0:
        return -math.inf, math.inf
    least = max(NARROW * float(np.ptp(values)), IN_NOISE * noise)
    floor, ceiling = _crowd(values, least), _crowd(-values, least)
    lower = _level(values, floor, ceiling, least)
    return lower, -_level(-values, ceiling, floor, least)


def within_plateaus(values: Floats, samples: Floats, noise: float) -> Floats:
    """A map kept within the plateaus of its samples, and steeper between two of them.

    Parameters
    ----------
    values
        The map, any shape.
    samples
        Shape (N,).
    noise
        Standard deviation of a sample, as fitted.
    """
    lower, upper = plateau_bounds(samples, noise)
    bounded: Floats = np.clip(values, lower, upper)
    return steepened(bounded, lower, upper) if two_levels(samples, lower, upper) else bounded


def two_levels(samples: Floats, lower: float, upper: float) -> bool:
    """Whether a map has two levels and little between, as far as samples of shape (N,) tell.

    No more samples lie in the middle half between the bounds than about the rarer level: of a
    focus with a smooth top four times as many do.

    Examples
    --------
    >>> two_levels(np.repeat([0.0, 0.5, 1.0], [50, 4, 5]), 0.0, 1.0)
    True
    >>> two_levels(np.linspace(0.0, 1.0, 40), 0.0, 1.0)
    False
    """
    if not 0 < upper - lower < math.inf:
        return False
    share = (samples - lower) / (upper - lower)
    below, above = int((share < _QUARTER).sum()), int((share > 1 - _QUARTER).sum())
    return len(samples) - below - above <= min(below, above)


def steepened(values: Floats, lower: float, upper: float) -> Floats:
    """A map of values between two plateaus, steeper half-way between them.

    The mean of interpolations falls from plateau to plateau over the whole gap between samples,
    the map somewhere in it: values near a plateau are likelier to be on it. With u from 0 to 1
    between the plateaus and s the `STEEPNESS`: uˢ/(uˢ + (1 − u)ˢ).

    Examples
    --------
    The ends and the middle stay:

    >>> steepened(np.array([0.0, 0.5, 0.8, 1.0]), 0.0, 1.0).round(2).tolist()
    [0.0, 0.5, 0.84, 1.0]
    """
    share = (values - lower) / (upper - lower)
    above, below = share**STEEPNESS, (1 - share) ** STEEPNESS
    return np.asarray(lower + (upper - lower) * above / (above + below))


def _level(values: Floats, crowd: _Crowd | None, other: _Crowd | None, least: float) -> float:
    """The bound below values, from their crowd or the width that the other end tells."""
    if crowd:
        return crowd.median if _full(crowd, len(values)) else crowd.lowest
    if other and _full(other, len(values)):
        crowd = _within(values, max(END_TO_END * other.deviation, least))
    return crowd.median if crowd else -math.inf


def _full(crowd: _Crowd, n_samples: int) -> bool:
    """Whether noise can be seen on a crowd."""
    return crowd.count >= max(FEWEST, LEAST_SHARE * n_samples)


def _crowd(values: Floats, least: float) -> _Crowd | None:
    """The samples that share the least value, in the smallest width that holds a crowd."""
    found = _within(values, least)
    widest = WIDEST * float(np.ptp(values))
    if found or not least < widest:
        return found
    for width in np.geomspace(least, widest, _WIDTHS)[1:]:
        found = _within(values, float(width), MUCH_THINNER)
        if found and _full(found, len(values)) and _peaked(values, float(width)):
            return found
    return None


def _within(values: Floats, width: float, thinner: float = THINNER) -> _Crowd | None:
    """The samples within a width of the least value, if far denser than beside it.

    Two may be so by chance: of two, none lies beside.
    """
    above = values - values.min()
    here: Truths = above <= width
    count = int(here.sum())
    end = min(ABOUT * width, MOST_ABOUT * float(above.max()))
    beside = int((~here & (above <= end)).sum())
    too_wide = width > WIDEST * float(above.max())
    if too_wide or count < 2 or beside * width > thinner * (count - 2) * (end - width):
        return None
    lowest, median = float(values.min()), float(np.median(values[here]))
    return _Crowd(lowest, median, float(values[here].std()), count)


def _peaked(values: Floats, width: float) -> bool:
    """Whether the samples within a width of the least value crowd in the middle of it."""
    above = values - values.min()
    middle = (above >= width / 4) & (above <= 3 * width / 4)
    return int(middle.sum()) >= CENTRAL * int((above <= width).sum())
