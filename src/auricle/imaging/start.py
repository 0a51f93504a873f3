"""The start of a segmentation: a seed, and the filtered box around it."""

from dataclasses import dataclass, replace

import numpy as np

from auricle.imaging.diffusion import perona_malik
from auricle.imaging.resampling import corners, resampled
from auricle.imaging.seed import Seed, find_seed, given_seed
from auricle.imaging.segmentation_options import SegmentationOptions
from auricle.imaging.verdict import SegmentationError
from auricle.imaging.volume import Volume
from auricle.progress import Progress, silent

BOX_MM = (150.0, 120.0, 130.0)
"""Size of the region looked at around the seed where none is given: left, back, head."""


@dataclass(frozen=True, eq=False)
class Start:
    """What thresholds, cutters and vein stubs do not change: found once for many trials of them.

    Attributes
    ----------
    seed
        Where the region grows from.
    image
        The filtered HU of the box around it: equal spacing along the axes of LPS.
    """

    seed: Seed
    image: Volume


def start_of(volume: Volume, options: SegmentationOptions, *, progress: Progress = silent) -> Start:
    """Find or check the seed, and filter the box around it and the region of interest.

    Raises
    ------
    SegmentationError
        If the values are no HU, or the seed or the contrast is not there.
    """
    _refuse_other_units(volume)
    progress("seed", 0, 6)
    seed = _seed(volume, options)
    progress("filter", 1, 6)
    return Start(seed, _filtered_box(volume, seed, options))


def _refuse_other_units(volume: Volume) -> None:
    """Refuse what cannot be HU: no air below −200, or nothing but air."""
    sample = volume.voxels[::4, ::4, ::4]
    low, high = np.percentile(sample, [0.5, 99.9])
    if low > -200.0 and float(sample.min()) > -200.0:
        raise SegmentationError("not_hu", f"values from {low:.0f} to {high:.0f} hold no air")
    if high < 0.0 or high > 20_000.0:
        raise SegmentationError(
            "not_hu", f"values from {low:.0f} to {high:.0f} are no CT of a chest"
        )


def _seed(volume: Volume, options: SegmentationOptions) -> Seed:
    if options.seed is None:
        return find_seed(volume, region=options.region)
    return given_seed(volume, options.seed, region=options.region)


def _filtered_box(volume: Volume, seed: Seed, options: SegmentationOptions) -> Volume:
    """The region looked at, filtered, on a lattice of its own.

    It is never less than the box about the seed: a chamber is told from its neighbours by these.
    """
    low, high = seed.position - np.array(BOX_MM) / 2, seed.position + np.array(BOX_MM) / 2
    if options.region is not None:
        first, last = options.region.bounds
        low, high = np.minimum(low, first), np.maximum(high, last)
    low = np.maximum(low, corners(volume).min(axis=0))
    high = np.minimum(high, corners(volume).max(axis=0))
    box = resampled(volume, low=low, high=high, step=options.step)
    values = perona_malik(box.voxels, contrast=options.contrast, iterations=options.iterations)
    values.flags.writeable = False
    return replace(box, voxels=values)
