"""The CT open in the page: what of it is drawn, and the segmentations tried on it."""

import hashlib
import json
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from auricle.errors import InputError
from auricle.imaging.reading import read_volume
from auricle.imaging.resampling import corners, resampled
from auricle.imaging.segmentation import Segmentation, SegmentationOptions, segment
from auricle.imaging.start import Start, start_of
from auricle.imaging.verdict import SegmentationError
from auricle.imaging.volume import Volume
from auricle.progress import Progress, silent
from auricle.study.result import Source
from auricle.study.segmented import SegmentationConfig, SegmentedCase, source_of_volume, surfaced

SKETCH_MM = 2.0
"""Spacing of the lattice of a sketch, mm: seen before the preview, in a fraction of its time."""
PREVIEW_MM = SegmentationOptions().step
"""Spacing of the lattice of a preview, mm: that of the command, for it is the result itself."""
MOST_DRAWN = 12_000_000
"""Voxels the page draws slices from: 24 MB on the way to it."""
FINEST_DRAWN_MM = 0.4
_PREVIEWS_KEPT = 8
_SKETCHES_KEPT = 24


@dataclass(frozen=True, eq=False)
class Trial:
    """One segmentation tried: found, or refused with its reason.

    Attributes
    ----------
    key
        The same for the same parameters.
    config
        The parameters.
    sketch
        Whether it was found on the coarse lattice; else it is what is accepted.
    found
        The segmentation; None if it was refused.
    refusal
        Why it was refused.
    """

    key: str
    config: SegmentationConfig
    sketch: bool
    found: Segmentation | None
    refusal: SegmentationError | None = None


class VolumeSession:
    """A CT, a lattice of it to draw slices from, and the segmentations tried on it.

    Parameters
    ----------
    volume
        As read.
    source
        What the file is known by; of DICOM no name.
    shown
        What slices are drawn from: int16 HU, straight in LPS.
    sketch_mm, preview_mm
        Spacing of the lattices of a sketch and of a preview, mm.

    Attributes
    ----------
    accepted
        The case that was accepted last; None before.
    """

    def __init__(
        self,
        volume: Volume,
        source: Source,
        shown: Volume,
        *,
        sketch_mm: float = SKETCH_MM,
        preview_mm: float = PREVIEW_MM,
    ) -> None:
        self.volume = volume
        self.source = source
        self.shown = shown
        self.sketch_mm = sketch_mm
        self.preview_mm = preview_mm
        self.accepted: SegmentedCase | None = None
        self._trials: dict[bool, OrderedDict[str, Trial]] = {
            True: OrderedDict(),
            False: OrderedDict(),
        }
        self._starts: dict[bool, tuple[str, Start]] = {}

    @property
    def views(self) -> tuple[str, ...]:
        """It can be segmented."""
        return ("segment",)

    def described(self) -> Mapping[str, Any]:
        """Name, lattice as read and as drawn, and what reading did."""
        shown, volume = self.shown, self.volume
        low, high = np.percentile(shown.voxels[::4, ::4, ::4], [0.5, 99.9])
        return {
            "volume": {
                "name": self.source.name,
                "shape": list(volume.shape),
                "spacing_mm": volume.spacing.tolist(),
                "shown_shape": list(shown.shape),
                "shown_step_mm": float(shown.spacing[0]),
                "shown_origin_mm": shown.origin.tolist(),
                "range_hu": [float(low), float(high)],
                "orientation_known": volume.orientation_known,
                "remarks": list(volume.remarks),
                "sketch_step_mm": self.sketch_mm,
                "preview_step_mm": self.preview_mm,
                "accepted": self.accepted is not None,
            }
        }

    def trial(
        self, config: SegmentationConfig, *, sketch: bool = False, progress: Progress = silent
    ) -> Trial:
        """Segment, by the same function at either spacing, or give what was found before."""
        key = _key(asdict(config), sketch)
        kept = self._trials[sketch]
        if key not in kept:
            found, refusal = self._segmented(config, sketch, progress)
            kept[key] = Trial(key, config, sketch, found, refusal)
        kept.move_to_end(key)
        while len(kept) > (_SKETCHES_KEPT if sketch else _PREVIEWS_KEPT):
            kept.popitem(last=False)
        return kept[key]

    def tried(self, key: str) -> Trial:
        """The trial of this key.

        Raises
        ------
        InputError
            If there is none, or it was long ago.
        """
        for kept in self._trials.values():
            if key in kept:
                return kept[key]
        raise InputError("this segmentation is no longer at hand: segment again")

    def accept(self, key: str, *, progress: Progress = silent) -> SegmentedCase:
        """The case of a preview: its own mask, with the surface of that.

        Raises
        ------
        InputError
            If it is a sketch, was refused, or no closed surface comes out.
        """
        trial = self.tried(key)
        if trial.sketch:
            raise InputError("a sketch is too coarse to be accepted: wait for the preview")
        if trial.found is None:
            raise InputError("nothing was found that could be accepted: look at the reason")
        self.accepted = surfaced(
            self.source, self.volume, trial.found, trial.config, progress=progress
        )
        return self.accepted

    def _segmented(
        self, config: SegmentationConfig, sketch: bool, progress: Progress
    ) -> tuple[Segmentation | None, SegmentationError | None]:
        options = replace(config.options, step=self.sketch_mm if sketch else self.preview_mm)
        try:
            start = self._start(config, options, sketch, progress)
            return segment(self.volume, options, start=start, progress=progress), None
        except SegmentationError as fault:
            return None, fault

    def _start(
        self,
        config: SegmentationConfig,
        options: SegmentationOptions,
        sketch: bool,
        progress: Progress,
    ) -> Start:
        """Seed and filtered box: kept while only thresholds, vein stub or cutters change."""
        which = [config.seed_mm, config.region_mm, config.region_depth_mm]
        key = _key({"start": which}, sketch)
        kept = self._starts.get(sketch)
        if kept is None or kept[0] != key:
            kept = (key, start_of(self.volume, options, progress=progress))
            self._starts[sketch] = kept
        return kept[1]


def volume_session(
    path: Path, *, series: int | None = None, progress: Progress = silent
) -> VolumeSession:
    """Read a CT and make ready what the page draws of it.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    volume = read_volume(path, series=series, progress=progress)
    progress("slices", 0, 1)
    shown = drawn_lattice(volume)
    progress("slices", 1, 1)
    return VolumeSession(volume, source_of_volume(path, volume), shown)


def drawn_lattice(volume: Volume) -> Volume:
    """The whole volume as int16 on a straight lattice, as fine as the image where that fits.

    Examples
    --------
    >>> voxels = np.zeros((9, 9, 5), np.int16)
    >>> drawn_lattice(Volume(voxels, np.diag([1.0, 1.0, 2.0, 1.0]))).shape
    (9, 9, 9)
    """
    ends = corners(volume)
    low, high = ends.min(axis=0), ends.max(axis=0)
    extent = np.maximum(high - low, 1e-6)
    fits = float((np.prod(extent) / MOST_DRAWN) ** (1 / 3))
    step = max(float(volume.spacing.min()), fits, FINEST_DRAWN_MM)
    fine = resampled(volume, low=low, high=np.maximum(high, low + step), step=step)
    voxels = np.rint(fine.voxels).clip(-32768, 32767).astype(np.int16)
    voxels.flags.writeable = False
    return Volume(voxels, fine.affine, volume.remarks, volume.orientation_known)


def _key(parameters: Mapping[str, Any], sketch: bool) -> str:
    text = json.dumps([parameters, sketch], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:24]
