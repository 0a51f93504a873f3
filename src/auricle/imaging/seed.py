"""The seed: which of the bright chambers is the left atrium.

Places are judged in LPS mm, never along array axes, so an oblique or flipped volume gives the
same answer, and one whose orientation is not known gives none.
"""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import median_filter

from auricle.arrays import Floats, Points
from auricle.imaging.chambers import TO_VENTRICLE, TOWARD
from auricle.imaging.necks import Basins, distance_basins
from auricle.imaging.region_of_interest import RegionOfInterest
from auricle.imaging.resampling import corners, resampled
from auricle.imaging.verdict import SegmentationError
from auricle.imaging.volume import Volume

COARSE_MM = 3.0
BLOOD = (150.0, 1500.0)
"""HU of contrasted blood, widely."""
LEAST_RADIUS_MM = 9.0
_PROMINENCE_MM = 1.5
_LEAST_HEART_MM = 15.0
_LIKE_CONTRAST = 0.3
_PARTNER_MM = (20.0, 80.0)
_PARTNER_SHARE = 0.6


@dataclass(frozen=True, eq=False)
class Seed:
    """A place in the left atrium.

    Attributes
    ----------
    position
        Middle of the largest ball there, shape (3,), mm, LPS.
    radius
        Of that ball, on a coarse lattice, mm.
    given
        Whether the user gave it.
    margin
        How much better it is than the runner-up, in points of the score; infinite if given or
        alone.
    """

    position: Points
    radius: float
    given: bool
    margin: float


def find_seed(volume: Volume, *, region: RegionOfInterest | None = None) -> Seed:
    """The middle of the left atrium, by size and place among the bright chambers.

    The score of a chamber, in mm: its radius (at most 20), how well a neighbour of like contrast
    lies where the ventricle should (left, in front, below; at most 12), and how far back it lies
    among all blood, less what it lies aside, too high, too low or behind the heart. The weights
    were set by hand on phantoms and one patient.

    Raises
    ------
    SegmentationError
        ``orientation`` if the file does not say how the patient lies; ``no_contrast`` if nothing
        bright is as large as a chamber; ``no_chamber`` if none has a ventricle (asked only
        without a region of interest).
    """
    if not volume.orientation_known:
        raise SegmentationError("orientation", "the file does not say how the patient lies")
    basins, places, contrast = _bright_basins(volume, region)
    large = np.flatnonzero(basins.peaks >= LEAST_RADIUS_MM)
    if not len(large):
        raise SegmentationError(
            "no_contrast", f"nothing above {BLOOD[0]:.0f} HU holds a ball of 9 mm radius"
        )
    ventricles = _ventricle_cosines(places[large], basins.peaks[large], contrast[large])
    scores = _scores(places[large], basins.peaks[large], ventricles)
    order = np.argsort(-scores)
    margin = float(scores[order[0]] - scores[order[1]]) if len(order) > 1 else float("inf")
    best = large[order[0]]
    if region is None and ventricles[order[0]] < TOWARD:
        raise _no_chamber(float(basins.peaks.max()))
    return Seed(places[best], float(basins.peaks[best]), False, margin)


def given_seed(volume: Volume, position: Points, *, region: RegionOfInterest | None = None) -> Seed:
    """The middle of the chamber around a position a user gave, mm, LPS.

    Raises
    ------
    SegmentationError
        ``seed_outside`` outside the volume or the region, ``seed_not_in_blood`` if there is no
        contrasted blood within a few mm.
    """
    index = volume.index_of(position)
    outside = (index < -0.5).any() or (index > np.array(volume.shape) - 0.5).any()
    if outside or (region is not None and not region.contains(position[None])[0]):
        raise SegmentationError(
            "seed_outside", f"the seed {_text(position)} lies outside the volume or the region"
        )
    around = resampled(volume, low=position - 2.0, high=position + 2.0, step=1.0).voxels
    hu = float(np.median(around))
    if not BLOOD[0] <= hu <= BLOOD[1]:
        raise SegmentationError(
            "seed_not_in_blood", f"around the seed {_text(position)} there are {hu:.0f} HU"
        )
    basins, places, _ = _bright_basins(volume, region)
    away = np.linalg.norm(places - position, axis=1)
    holding = np.flatnonzero((away <= 1.25 * basins.peaks) & (basins.peaks >= LEAST_RADIUS_MM))
    if not len(holding):
        return Seed(position, COARSE_MM, True, float("inf"))
    nearest = holding[np.argmin(away[holding] / basins.peaks[holding])]
    return Seed(places[nearest], float(basins.peaks[nearest]), True, float("inf"))


def _text(position: Points) -> str:
    return "(" + ", ".join(f"{value:.1f}" for value in position) + ") mm"


def _bright_basins(
    volume: Volume, region: RegionOfInterest | None
) -> tuple[Basins, Points, Floats]:
    """Basins of all bright blood on a coarse lattice, their middles in mm and their HU."""
    low, high = corners(volume).min(axis=0), corners(volume).max(axis=0)
    if region is not None:
        low, high = np.maximum(low, region.bounds[0]), np.minimum(high, region.bounds[1])
    if not (high - low >= 2 * COARSE_MM).all():
        raise SegmentationError("seed_outside", "the region of interest lies outside the volume")
    coarse = resampled(volume, low=low, high=high, step=COARSE_MM)
    values = median_filter(coarse.voxels, 3)
    bright = (values >= BLOOD[0]) & (values <= BLOOD[1])
    if region is not None:
        nodes = coarse.points_at(np.indices(coarse.shape).reshape(3, -1).T)
        bright &= region.contains(nodes).reshape(coarse.shape)
    if not bright.any():
        raise SegmentationError("no_contrast", f"nothing is brighter than {BLOOD[0]:.0f} HU")
    basins = distance_basins(bright, step=COARSE_MM, depth=_PROMINENCE_MM)
    contrast = values[tuple(basins.centres.T)].astype(np.float64)
    return basins, coarse.points_at(basins.centres), contrast


def _no_chamber(largest: float) -> SegmentationError:
    """The refusal where nothing bright lies before, left of and below the best candidate."""
    if largest < _LEAST_HEART_MM:
        cause = f"nothing bright is larger than a ball of {largest:.0f} mm radius, as bone is"
        return SegmentationError("no_contrast", cause)
    return SegmentationError(
        "no_chamber", "no bright chamber has another where its ventricle should be"
    )


def _ventricle_cosines(places: Points, radii: Floats, contrast: Floats) -> Floats:
    """How well a like chamber lies where the ventricle should: 1 is exactly, 0 not at all."""
    offset = places[None] - places[:, None]
    away = np.linalg.norm(offset, axis=2)
    toward = offset @ TO_VENTRICLE / np.maximum(away, 1.0)
    like = np.abs(contrast[None] / contrast[:, None] - 1.0) < _LIKE_CONTRAST
    partner = like & (away >= _PARTNER_MM[0]) & (away <= _PARTNER_MM[1])
    partner &= radii[None] >= _PARTNER_SHARE * radii[:, None]
    cosines: Floats = np.where(partner, toward, 0.0).max(axis=1)
    return cosines


def _scores(places: Points, radii: Floats, ventricles: Floats) -> Floats:
    """Points for each chamber as the left atrium, in mm."""
    aside, back, up = (places - np.average(places, axis=0, weights=radii**3)).T
    scores: Floats = (
        np.minimum(radii, 20.0)
        + 12.0 * ventricles
        + 0.3 * np.clip(back, -30.0, 30.0)
        - 0.5 * np.maximum(back - 35.0, 0.0)
        - 0.15 * np.abs(aside)
        - 0.15 * np.abs(up - 7.0)
    )
    return scores
