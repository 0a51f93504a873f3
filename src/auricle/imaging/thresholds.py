"""Thresholds: where blood begins, from the histogram of the region itself."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from auricle.imaging.verdict import SegmentationError

WALL_RANGE = (90.0, 140.0)
"""HU of atrial wall in an arterial phase; fat and muscle are softer and would push it out."""
LEAST_BLOOD = 150.0
"""HU below which blood holds no contrast to speak of."""
LEAST_STEP = 60.0
"""Difference of blood and wall below which noise decides where the surface lies, HU."""
GROWING_HEIGHT = 0.65
"""How far up from wall to blood the level lies at which chambers are told apart."""
_BRIGHTER = 120.0
_SPREADS = 5.0
_BIN = 5.0
_SOFT_TISSUE = 150.0
"""Above it lies blood with a little contrast, of the right heart say."""


@dataclass(frozen=True)
class Thresholds:
    """What counts as blood of the left atrium, HU.

    Attributes
    ----------
    blood
        Median around the seed.
    wall
        Commonest value of soft tissue, kept to 90…140 HU.
    noise
        Standard deviation around the seed, from the median deviation.
    lower
        Half height between wall and blood: where the surface lies.
    growing
        Higher than `lower`: where the chambers are told apart, so that a thin wall still parts.
    upper
        Above it: the right heart, bone, metal.
    """

    blood: float
    wall: float
    noise: float
    lower: float
    growing: float
    upper: float


def region_thresholds(
    values: NDArray[np.floating], around_seed: NDArray[np.floating]
) -> Thresholds:
    """Thresholds from a region's values and those of a ball around the seed.

    Parameters
    ----------
    values
        Of the whole region of interest, HU, any shape.
    around_seed
        Of the ball, HU, any shape.

    Raises
    ------
    SegmentationError
        ``no_contrast`` below 150 HU at the seed, ``low_contrast`` if blood is less than 60 HU
        above the wall or three standard deviations of the noise.

    Examples
    --------
    >>> tissue, blood = np.full(900, 100.0), np.full(100, 400.0)
    >>> found = region_thresholds(np.concatenate([tissue, blood]), blood)
    >>> found.blood, round(found.lower)
    (400.0, 251)
    """
    blood = float(np.median(around_seed))
    if blood < LEAST_BLOOD:
        raise SegmentationError(
            "no_contrast", f"the blood at the seed has {blood:.0f} HU, no contrast"
        )
    noise = 1.4826 * float(np.median(np.abs(around_seed - blood)))
    wall = _wall(values, blood)
    if blood - wall < max(LEAST_STEP, 3.0 * noise):
        raise SegmentationError(
            "low_contrast",
            f"blood at {blood:.0f} HU stands {blood - wall:.0f} HU above the wall with a noise "
            f"of {noise:.0f} HU",
        )
    return Thresholds(
        blood=blood,
        wall=wall,
        noise=noise,
        lower=0.5 * (wall + blood),
        growing=wall + GROWING_HEIGHT * (blood - wall),
        upper=blood + max(_BRIGHTER, _SPREADS * noise),
    )


def _wall(values: NDArray[np.floating], blood: float) -> float:
    """The commonest value of soft tissue below blood, kept to the range of walls."""
    edges = np.arange(0.0, min(0.7 * blood, _SOFT_TISSUE) + _BIN, _BIN)
    counts, _ = np.histogram(values, edges)
    mode = edges[int(np.argmax(gaussian_filter1d(counts.astype(float), 2.0)))] + 0.5 * _BIN
    return float(np.clip(mode, *WALL_RANGE))
