"""Segmentation: from a contrast CT to the blood of the left atrium, with a verdict."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, binary_fill_holes

from auricle.arrays import Integers, Truths
from auricle.imaging.chambers import ATRIUM, OTHER, Chambers, chambers_of
from auricle.imaging.findings import reasons_of
from auricle.imaging.growing import grown_region, pieces_by_size, spread_labels
from auricle.imaging.mask import Mask
from auricle.imaging.mitral import MitralPlane, cut_at_mitral, hinge_plane, mitral_plane
from auricle.imaging.necks import distance_basins
from auricle.imaging.region_of_interest import RegionOfInterest
from auricle.imaging.seed import Seed
from auricle.imaging.segmentation_options import SegmentationOptions
from auricle.imaging.start import Start, start_of
from auricle.imaging.thresholds import Thresholds, region_thresholds
from auricle.imaging.veins import Branch, Trimmed, trim_veins
from auricle.imaging.verdict import Reason, SegmentationError, Verdict, verdict_of
from auricle.imaging.volume import Volume
from auricle.progress import Progress, silent

__all__ = ["Segmentation", "SegmentationOptions", "segment"]

SEED_BALL_MM = 6.0
SPREAD_MM = 2.0
"""How far the chambers told apart at the higher threshold reach at the lower one."""
_LEAST_BRIGHT_ML = 1.0


@dataclass(frozen=True, eq=False)
class Segmentation:
    """A left atrium found in a volume, and how far to trust it.

    Attributes
    ----------
    mask
        Body, appendage and vein stubs, on the lattice of `image`.
    image
        The filtered HU it was found in: a box with equal spacing along the axes of LPS.
    labels
        Territories on the same lattice: 0, ATRIUM, VENTRICLE, OTHER (`imaging.chambers`); the
        veins cut off are OTHER.
    thresholds
        In HU.
    seed
        Where it started.
    radius
        Of the largest ball in the atrium, mm.
    branches
        Appendage and veins; positions in mm, LPS.
    mitral
        The plane to the ventricle, in mm, LPS; None if they are not joined.
    reasons
        What to know before trusting it.
    measurements
        Numbers for the report, units in their names.
    """

    mask: Mask
    image: Volume
    labels: NDArray[np.int8]
    thresholds: Thresholds
    seed: Seed
    radius: float
    branches: tuple[Branch, ...]
    mitral: MitralPlane | None
    reasons: tuple[Reason, ...]
    measurements: Mapping[str, float]

    @property
    def verdict(self) -> Verdict:
        """``ok`` or ``check``."""
        return verdict_of(self.reasons)

    @property
    def volume_ml(self) -> float:
        """Volume of the mask, ml."""
        return self.mask.volume_ml


def segment(
    volume: Volume,
    options: SegmentationOptions | None = None,
    *,
    start: Start | None = None,
    progress: Progress = silent,
) -> Segmentation:
    """The left atrium of a contrast CT: body, appendage and vein stubs, cut at the mitral valve.

    Seed, region of interest, anisotropic diffusion, thresholds from the region's histogram,
    region growing up to the cutters, chambers parted at their necks, mitral plane, vein stubs.

    Parameters
    ----------
    volume
        The CT.
    options
        How to segment.
    start
        What `start_of` gave for this volume and options that differ in thresholds, vein stub
        and cutters only; None finds it.
    progress
        Told where the work stands.

    Raises
    ------
    SegmentationError
        If there is no left atrium to be found; its `code` and `remedy` say why and what to do.
    """
    options = options or SegmentationOptions()
    start = start or start_of(volume, options, progress=progress)
    seed, image = start.seed, start.image
    progress("grow", 2, 6)
    allowed = _allowed(image, options)
    barred = _barred(image, options)
    home = _home(image, seed)
    thresholds = _thresholds(image, allowed, home, options)
    bright = _blood(image, thresholds)
    blood = bright & ~barred
    region = _pool(image, blood, home, thresholds, options)
    progress("chambers", 3, 6)
    chambers = _chambers(region, home, volume, options)
    spread = spread_labels(chambers.labels, blood, reach=SPREAD_MM, step=options.step)
    progress("mitral", 4, 6)
    labels, plane = _mitral_cut(spread, chambers, options.step)
    progress("veins", 5, 6)
    trimmed = trim_veins(
        _one_piece(labels == ATRIUM),
        labels,
        radius=chambers.radius,
        step=options.step,
        stub=options.vein_stub,
        oriented=volume.orientation_known,
    )
    trimmed = _within(trimmed, allowed, image, options.region)
    labels[bright & barred] = OTHER
    progress("veins", 6, 6)
    return _result(volume, image, thresholds, seed, (chambers, labels, plane, trimmed))


def _allowed(image: Volume, options: SegmentationOptions) -> Truths:
    """Voxels of the region of interest."""
    if options.region is None:
        return np.ones(image.shape, dtype=bool)
    nodes = image.points_at(np.indices(image.shape).reshape(3, -1).T)
    return options.region.contains(nodes).reshape(image.shape)


def _barred(image: Volume, options: SegmentationOptions) -> Truths:
    """Voxels of the cutters."""
    barred = np.zeros(image.shape, dtype=bool)
    for cutter in options.cutters:
        nodes = image.points_at(np.indices(image.shape).reshape(3, -1).T)
        barred |= cutter.bars(nodes, step=options.step).reshape(image.shape)
    return barred


def _home(image: Volume, seed: Seed) -> Integers:
    index = np.round(image.index_of(seed.position)).astype(np.int64)
    home: Integers = np.clip(index, 0, np.array(image.shape) - 1)
    return home


def _ball(shape: tuple[int, ...], centre: Integers, radius: float) -> tuple[slice, ...]:
    """The cube about a ball, inside the lattice."""
    low = np.maximum(centre - int(radius), 0)
    high = np.minimum(centre + int(radius) + 1, shape)
    return tuple(slice(a, b) for a, b in zip(low, high, strict=True))


def _thresholds(
    image: Volume, allowed: Truths, home: Integers, options: SegmentationOptions
) -> Thresholds:
    place = _ball(image.shape, home, SEED_BALL_MM / options.step)
    found = region_thresholds(image.voxels[allowed], image.voxels[place])
    if options.upper is not None:
        found = replace(found, upper=options.upper)
    if options.lower is not None:
        growing = max(options.lower, options.lower + 0.3 * (found.blood - options.lower))
        found = replace(found, lower=options.lower, growing=growing)
    if not found.lower < found.blood <= found.upper:
        raise SegmentationError(
            "seed_not_in_blood",
            f"the seed's {found.blood:.0f} HU are not between the thresholds "
            f"{found.lower:.0f} and {found.upper:.0f} HU",
        )
    return found


def _blood(image: Volume, thresholds: Thresholds) -> Truths:
    """Voxels of the atrium's kind: no brighter structure, nor the blurred rim of one."""
    values = image.voxels
    voxel_ml = image.voxel_volume / 1000
    bright, _ = pieces_by_size(
        values > thresholds.upper, smallest=max(int(_LEAST_BRIGHT_ML / voxel_ml), 1)
    )
    rim = binary_dilation(bright > 0)
    blood: Truths = (values >= thresholds.lower) & (values <= thresholds.upper) & ~rim
    return blood


def _pool(
    image: Volume,
    blood: Truths,
    home: Integers,
    thresholds: Thresholds,
    options: SegmentationOptions,
) -> Truths:
    """The blood joined to the seed at the growing threshold, without holes."""
    values = np.where(blood, image.voxels, -np.inf)
    place = _ball(image.shape, home, SEED_BALL_MM / options.step)
    near = np.argwhere(values[place] >= thresholds.growing)
    if not len(near):
        raise SegmentationError("seed_not_in_blood", "no voxel near the seed is within thresholds")
    near += [part.start for part in place]
    start = near[np.argmin(np.linalg.norm(near - home, axis=1))]
    x, y, z = start.tolist()
    region = grown_region(values, (x, y, z), lower=thresholds.growing)
    filled: Truths = binary_fill_holes(region)
    return filled


def _chambers(
    region: Truths, home: Integers, volume: Volume, options: SegmentationOptions
) -> Chambers:
    basins = distance_basins(region, step=options.step)
    away = np.linalg.norm(basins.centres - home, axis=1) * options.step
    return chambers_of(
        basins,
        int(np.argmin(away - basins.peaks)),
        step=options.step,
        oriented=volume.orientation_known,
    )


def _mitral_cut(
    labels: NDArray[np.int8], chambers: Chambers, step: float
) -> tuple[NDArray[np.int8], MitralPlane | None]:
    plane = mitral_plane(labels, step=step)
    if plane is None:
        return labels, None
    middle = chambers.centre.astype(np.float64) * step
    annulus = hinge_plane(labels, plane, middle=middle, step=step)
    return cut_at_mitral(labels, annulus, step=step), annulus


def _one_piece(region: Truths) -> Truths:
    """The largest piece, its holes filled."""
    pieces, sizes = pieces_by_size(region)
    if not len(sizes):
        raise SegmentationError("no_chamber", "nothing is left of the atrium after the cuts")
    filled: Truths = binary_fill_holes(pieces == 1)
    return filled


def _within(
    trimmed: Trimmed, allowed: Truths, image: Volume, region: RegionOfInterest | None
) -> Trimmed:
    """The atrium inside the region of interest, with the branches that leave it there."""
    if region is None:
        return trimmed
    kept = tuple(
        branch
        for branch in trimmed.branches
        if region.contains((branch.ostium + image.origin)[None])[0]
    )
    return replace(trimmed, atrium=trimmed.atrium & allowed, branches=kept)


def _result(
    volume: Volume,
    image: Volume,
    thresholds: Thresholds,
    seed: Seed,
    parts: tuple[Chambers, NDArray[np.int8], MitralPlane | None, Trimmed],
) -> Segmentation:
    chambers, labels, plane, trimmed = parts
    territories = np.where(labels == ATRIUM, OTHER, labels)
    territories[trimmed.atrium] = ATRIUM
    atrium = _one_piece(trimmed.atrium)
    territories.flags.writeable = atrium.flags.writeable = False
    mask = Mask(atrium, image.affine, remarks=volume.remarks)
    branches = tuple(
        replace(branch, ostium=branch.ostium + image.origin) for branch in trimmed.branches
    )
    if plane is not None:
        plane = replace(plane, centre=plane.centre + image.origin)
    return Segmentation(
        mask=mask,
        image=image,
        labels=territories,
        thresholds=thresholds,
        seed=seed,
        radius=chambers.radius,
        branches=branches,
        mitral=plane,
        reasons=reasons_of(volume, mask, seed, chambers, plane, branches),
        measurements=MappingProxyType(
            {
                "volume_ml": mask.volume_ml,
                "radius_mm": chambers.radius,
                "mitral_opening_radius_mm": chambers.mitral_radius,
                "mitral_opening_share": chambers.mitral_share,
                "leak_radius_mm": chambers.leak_radius,
                "n_veins": sum(branch.kind == "vein" for branch in branches),
                "seed_margin": seed.margin,
            }
        ),
    )
