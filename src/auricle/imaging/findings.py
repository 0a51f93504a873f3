"""Findings: what in a segmentation a user should know, from its measures."""

import numpy as np

from auricle.arrays import Floats, Integers, Truths
from auricle.imaging.chambers import TO_VENTRICLE, Chambers
from auricle.imaging.mask import Mask
from auricle.imaging.mitral import MitralPlane
from auricle.imaging.seed import Seed
from auricle.imaging.veins import Branch
from auricle.imaging.verdict import Reason
from auricle.imaging.volume import Volume

PLAUSIBLE_ML = (30.0, 300.0)
WEAK_NECK = 0.85
LEAK_RADIUS_MM = 7.0
LONGEST_MM = 95.0
"""Extent of an atrium toward the ventricle beyond which it holds some of that, mm."""
LEAST_MARGIN = 3.0
RAGGED_MM = 4.0


def reasons_of(
    volume: Volume,
    mask: Mask,
    seed: Seed,
    chambers: Chambers,
    plane: MitralPlane | None,
    branches: tuple[Branch, ...],
) -> tuple[Reason, ...]:
    """Every reason for doubt about an atrium that was found, those that stop first."""
    found = [
        *_of_seed(volume, seed),
        *_of_necks(mask, chambers),
        *_of_mitral(mask, plane),
        *_of_extent(volume, mask),
        *_of_branches(branches),
    ]
    return tuple(sorted(found, key=lambda reason: not reason.stops))


def reasons_of_mask(mask: Mask) -> tuple[Reason, ...]:
    """Reasons for doubt about a mask someone else made: its size and its edges."""
    found = _of_size(mask)
    inside = np.argwhere(mask.voxels)
    at_edge = ((inside < 1) | (inside > np.array(mask.shape) - 2)).any(axis=1)
    if at_edge.any():
        found.append(_truncated(mask, inside[at_edge]))
    return tuple(found)


def _of_seed(volume: Volume, seed: Seed) -> list[Reason]:
    found = []
    if seed.margin < LEAST_MARGIN:
        place = _place(seed.position)
        cause = f"another chamber scored {seed.margin:.1f} points less than the one taken"
        found.append(Reason("runner_up_seed", cause, position=place))
    if not volume.orientation_known:
        cause = "without known axes the ventricle and the appendage are guesses"
        found.append(Reason("orientation", cause))
    return found


def _of_necks(mask: Mask, chambers: Chambers) -> list[Reason]:
    found = []
    if chambers.leak_radius > LEAK_RADIUS_MM:
        place = _place(mask.points_at(chambers.leak_index))
        cause = (
            f"an opening of {chambers.leak_radius:.1f} mm radius leads to another structure and "
            "was cut at its narrowest"
        )
        found.append(Reason("leak", cause, position=place))
    if chambers.mitral_share > WEAK_NECK:
        cause = (
            f"the opening to the ventricle has {100 * chambers.mitral_share:.0f} % of the "
            "chamber's radius: the cut there is a guess"
        )
        found.append(Reason("weak_neck", cause))
    return found


def _of_mitral(mask: Mask, plane: MitralPlane | None) -> list[Reason]:
    points = mask.points_at(np.argwhere(mask.voxels))
    near, far = np.percentile(points @ TO_VENTRICLE, [0.5, 99.5])
    if far - near > LONGEST_MM:
        cause = f"the region is {far - near:.0f} mm long toward the ventricle"
        return [Reason("mitral", cause)]
    if plane is not None and plane.deviation > RAGGED_MM:
        cause = f"the border to the ventricle is uneven by {plane.deviation:.1f} mm"
        return [Reason("mitral", cause, position=_place(plane.centre))]
    return []


def _of_extent(volume: Volume, mask: Mask) -> list[Reason]:
    found = _of_size(mask)
    at_edge = _at_edge(volume, mask)
    if at_edge.any():
        found.append(_truncated(mask, np.argwhere(mask.voxels)[at_edge]))
    return found


def _of_size(mask: Mask) -> list[Reason]:
    if PLAUSIBLE_ML[0] <= mask.volume_ml <= PLAUSIBLE_ML[1]:
        return []
    return [Reason("volume_outside", f"the volume is {mask.volume_ml:.0f} ml")]


def _truncated(mask: Mask, at_edge: Integers) -> Reason:
    cause = f"the atrium reaches the edge of the image over {len(at_edge)} voxels"
    return Reason("truncated", cause, position=_place(mask.points_at(at_edge).mean(axis=0)))


def _at_edge(volume: Volume, mask: Mask) -> Truths:
    """Which voxels of the mask lie within two steps of the volume's faces or of the mask's box."""
    inside = np.argwhere(mask.voxels)
    box = np.array(mask.shape)
    in_box = ((inside < 1) | (inside > box - 2)).any(axis=1)
    index = volume.index_of(mask.points_at(inside))
    margin = mask.spacing.max() / volume.spacing
    last = np.array(volume.shape) - 1
    edge: Truths = in_box | ((index < margin) | (index > last - margin)).any(axis=1)
    return edge


def _of_branches(branches: tuple[Branch, ...]) -> list[Reason]:
    leaks = [
        Reason(
            "leak",
            f"a branch of {branch.volume_ml:.0f} ml is no vein and was cut at the body",
            position=_place(branch.ostium),
        )
        for branch in branches
        if branch.kind == "leak"
    ]
    return leaks + _without_appendage(branches)


def _without_appendage(branches: tuple[Branch, ...]) -> list[Reason]:
    if any(branch.kind == "appendage" for branch in branches):
        return []
    cause = "no branch to the left and the front was found"
    return [Reason("no_appendage", cause, stops=False)]


def _place(point: Floats) -> tuple[float, float, float]:
    x, y, z = point.tolist()
    return x, y, z
