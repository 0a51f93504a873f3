"""From a contrast CT, or a mask someone made, to the endocardium of the left atrium."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from types import MappingProxyType

import numpy as np

from auricle.errors import InputError
from auricle.imaging.cutters import BallCutter, Cutter, DiscCutter
from auricle.imaging.findings import reasons_of_mask
from auricle.imaging.image_files import is_image_file
from auricle.imaging.labels import label_mask
from auricle.imaging.mask import Mask
from auricle.imaging.reading import read_volume
from auricle.imaging.region_of_interest import BoxRegion, PolygonRegion, RegionOfInterest
from auricle.imaging.resampling import corners, mask_box, mask_on, resampled
from auricle.imaging.segmentation import Segmentation, SegmentationOptions, segment
from auricle.imaging.verdict import Reason, Verdict, verdict_of
from auricle.imaging.volume import Volume
from auricle.progress import Progress, silent
from auricle.study.clock import Clock
from auricle.study.provenance import source_of, versions
from auricle.study.result import Source
from auricle.surface.endocardium import Endocardium, endocardium, endocardium_of_mask

PICTURED_MM = 0.75
"""Spacing of the lattice the slices of a report are cut from, mm."""
_AROUND_MM = 25.0
_LIBRARIES = ("SimpleITK", "pydicom")
_LABELLED_HU = 300

Place = tuple[float, float, float]
"""Coordinates in mm, LPS."""


@dataclass(frozen=True)
class SegmentationConfig:
    """What the user may choose about one segmentation.

    Attributes
    ----------
    seed_mm
        A place in the left atrium, mm, LPS; None finds one.
    region_mm
        Where to look, mm, LPS: two opposite corners of a box, or three and more of a polygon on
        a slice; empty looks around the seed.
    region_depth_mm
        How far a polygon reaches to either side of its slice, mm.
    series
        Number of the series in a DICOM folder, from 1.
    label
        Numbers of the atrium, or of its parts, in a label map, where one is given.
    lower_hu, upper_hu
        Thresholds, HU, in place of those from the histogram.
    vein_stub_mm
        Length of vein kept from its ostium, mm.
    spacing_mm
        Of the lattice the surface is drawn on, mm; None follows the voxels.
    cuts_mm
        Where blood must not be followed, mm, LPS: x, y, z and radius of a ball, or x, y, z, the
        three of a normal and the radius of a disc.
    """

    seed_mm: Place | None = None
    region_mm: tuple[Place, ...] = ()
    region_depth_mm: float = 60.0
    series: int | None = None
    label: tuple[int, ...] = ()
    lower_hu: float | None = None
    upper_hu: float | None = None
    vein_stub_mm: float = 12.0
    spacing_mm: float | None = None
    cuts_mm: tuple[tuple[float, ...], ...] = ()

    def __post_init__(self) -> None:
        if self.spacing_mm is not None and not 0.3 <= self.spacing_mm <= 3.0:
            raise InputError(f"a surface lattice of {self.spacing_mm} mm: give 0.3 to 3")

    @property
    def region_of_interest(self) -> RegionOfInterest | None:
        """The region as a part of space."""
        match len(self.region_mm):
            case 0:
                return None
            case 2:
                low, high = np.sort(np.array(self.region_mm), axis=0)
                return BoxRegion(low, high)
            case _:
                return PolygonRegion(np.array(self.region_mm), self.region_depth_mm)

    @property
    def options(self) -> SegmentationOptions:
        """What the segmentation itself takes."""
        return SegmentationOptions(
            seed=None if self.seed_mm is None else np.array(self.seed_mm),
            region=self.region_of_interest,
            lower=self.lower_hu,
            upper=self.upper_hu,
            vein_stub=self.vein_stub_mm,
            cutters=tuple(_cutter(cut) for cut in self.cuts_mm),
        )


def _cutter(cut: tuple[float, ...]) -> Cutter:
    numbers = np.array(cut)
    match len(cut):
        case 4:
            return BallCutter(numbers[:3], cut[3])
        case 7:
            return DiscCutter(numbers[:3], numbers[3:6], cut[6])
        case _:
            raise InputError(
                f"a cutter of {len(cut)} numbers: give x, y, z and a radius, or x, y, z, the "
                "three of a normal and a radius"
            )


@dataclass(frozen=True, eq=False)
class SegmentedCase:
    """A left atrium found in one input, or taken from a label map, and how far to trust it.

    Attributes
    ----------
    source
        The input; of a DICOM series, whose folder may carry a name, only what it holds.
    labels_source
        The label map, if one was given beside a CT.
    config
        The parameters of this run.
    shape, spacing_mm
        Of the input.
    mask
        The atrium on the input's lattice.
    endocardium
        Its surface, mm, LPS.
    segmentation
        How it was found; None if it was taken from a label map.
    slices, slices_mask
        The CT around the atrium and the mask on one straight lattice, for pictures; without a
        CT the label map itself.
    reasons
        What to know before trusting it.
    remarks
        What reading did that should be known.
    versions, seconds
        Of what entered the numbers; wall time by stage.
    """

    source: Source
    labels_source: Source | None
    config: SegmentationConfig
    shape: tuple[int, int, int]
    spacing_mm: tuple[float, float, float]
    mask: Mask
    endocardium: Endocardium
    segmentation: Segmentation | None
    slices: Volume
    slices_mask: Mask
    reasons: tuple[Reason, ...]
    remarks: tuple[str, ...]
    versions: Mapping[str, str]
    seconds: Mapping[str, float]

    @property
    def verdict(self) -> Verdict:
        """``ok`` or ``check``."""
        return verdict_of(self.reasons)

    @property
    def volume_ml(self) -> float:
        """What the surface encloses, ml."""
        return (self.endocardium.soundness.volume_mm3 or 0.0) / 1000


def segment_file(
    path: Path,
    config: SegmentationConfig | None = None,
    *,
    labels: Path | None = None,
    progress: Progress = silent,
) -> SegmentedCase:
    """Read a CT, find the left atrium, draw its surface, and say how far to trust it.

    Parameters
    ----------
    path
        A DICOM folder or file, NIfTI, NRRD or MetaImage; with ``config.label`` and without
        `labels` a label map.
    config
        The parameters.
    labels
        A label map that takes the place of the segmentation; needs ``config.label``.
    progress
        Told the stages.

    Raises
    ------
    SegmentationError
        If no left atrium can be found.
    InputError
        If a file cannot be read, or no closed surface comes out.
    """
    config = config or SegmentationConfig()
    if labels is not None and not config.label:
        raise InputError("a label map without a label: give --label N")
    clock = Clock(progress)
    if not config.label:
        found = _searched(path, config, clock)
    else:
        found = _labelled(path, config, labels, clock)
    mask = found.mask if labels is None and config.label else None
    labels_source = None if labels is None else source_of_volume(labels, found.volume)
    sources = (source_of_volume(path, found.volume), labels_source)
    return _case(found, mask, config, sources, clock)


def surfaced(
    source: Source,
    volume: Volume,
    segmentation: Segmentation,
    config: SegmentationConfig,
    *,
    progress: Progress = silent,
) -> SegmentedCase:
    """The case of a segmentation at hand: what `segment_file` gives, from its surface on.

    Parameters
    ----------
    source
        Of the volume, see `source_of_volume`.
    volume
        The CT.
    segmentation
        ``segment(volume, config.options)``.
    config
        The parameters.
    progress
        Told the stages.

    Raises
    ------
    SurfaceError
        If no closed surface comes out.
    """
    clock = Clock(progress)
    found = _surfaced(volume, segmentation, config, clock)
    return _case(found, None, config, (source, None), clock)


def _case(
    found: "_Found",
    mask: Mask | None,
    config: SegmentationConfig,
    sources: tuple[Source, Source | None],
    clock: Clock,
) -> SegmentedCase:
    """The case of an atrium; a mask on the input's own lattice already is taken as it is."""
    with clock.stage("slices"):
        slices = _slices(found.volume, found.mask)
        shown = mask_on(found.mask, slices)
        mask = mask or mask_on(found.mask, found.volume)
    x, y, z = found.volume.spacing.tolist()
    return SegmentedCase(
        source=sources[0],
        labels_source=sources[1],
        config=config,
        shape=found.volume.shape,
        spacing_mm=(x, y, z),
        mask=mask,
        endocardium=found.endocardium,
        segmentation=found.segmentation,
        slices=slices,
        slices_mask=shown,
        reasons=found.reasons,
        remarks=found.remarks,
        versions=MappingProxyType(versions() | {name: version(name) for name in _LIBRARIES}),
        seconds=MappingProxyType(clock.seconds),
    )


@dataclass(frozen=True, eq=False)
class _Found:
    """An atrium, however it was come by."""

    volume: Volume
    mask: Mask
    endocardium: Endocardium
    segmentation: Segmentation | None
    reasons: tuple[Reason, ...]
    remarks: tuple[str, ...]


def _searched(path: Path, config: SegmentationConfig, clock: Clock) -> _Found:
    with clock.stage("read"):
        volume = read_volume(path, series=config.series, progress=clock.progress)
    with clock.stage("segment"):
        found = segment(volume, config.options, progress=clock.progress)
    return _surfaced(volume, found, config, clock)


def _surfaced(
    volume: Volume, found: Segmentation, config: SegmentationConfig, clock: Clock
) -> _Found:
    with clock.stage("mesh"):
        surface = endocardium(volume, found, spacing=config.spacing_mm, progress=clock.progress)
    return _Found(volume, found.mask, surface, found, found.reasons, volume.remarks)


def _labelled(path: Path, config: SegmentationConfig, labels: Path | None, clock: Clock) -> _Found:
    """The surface of a mask someone made, with the same checks."""
    with clock.stage("read"):
        mask = label_mask(labels or path, config.label, progress=clock.progress)
        if labels is None:
            volume, remarks = _drawn(mask), mask.remarks
        else:
            volume = read_volume(path, series=config.series, progress=clock.progress)
            remarks = (*volume.remarks, *mask.remarks)
            _require_inside(mask, volume)
    with clock.stage("mesh"):
        surface = endocardium_of_mask(mask, spacing=config.spacing_mm)
    return _Found(volume, mask, surface, None, reasons_of_mask(mask), remarks)


def _require_inside(mask: Mask, volume: Volume) -> None:
    """Refuse a label map of another scan: its atrium must lie in the CT."""
    indices = volume.index_of(np.stack(mask_box(mask, margin=0.0)))
    middle = indices.mean(axis=0)
    if (middle < 0).any() or (middle > np.array(volume.shape) - 1).any():
        raise InputError(
            "the label's voxels lie outside the CT: give the label map of this very scan"
        )


def _drawn(mask: Mask) -> Volume:
    """A volume to draw where there is a mask and no CT."""
    voxels = mask.voxels.astype(np.int16) * np.int16(_LABELLED_HU)
    voxels.flags.writeable = False
    return Volume(voxels, mask.affine, mask.remarks)


def _slices(volume: Volume, mask: Mask) -> Volume:
    """The CT around a mask, on a straight lattice."""
    low, high = mask_box(mask, margin=_AROUND_MM)
    ends = corners(volume)
    low, high = np.maximum(low, ends.min(axis=0)), np.minimum(high, ends.max(axis=0))
    return resampled(volume, low=low, high=high, step=PICTURED_MM)


def source_of_volume(path: Path, volume: Volume) -> Source:
    """The file; of a DICOM series its content only, since names of its files may be a person's."""
    if is_image_file(path):
        return source_of(path)
    digest = hashlib.sha256(volume.affine.tobytes())
    for k in range(volume.shape[2]):
        digest.update(np.ascontiguousarray(volume.voxels[:, :, k]).tobytes())
    return Source("DICOM series", volume.voxels.nbytes, digest.hexdigest())
