"""The endocardium: the surface of the blood of a segmented atrium, closed and without handles."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import (
    affine_transform,
    binary_fill_holes,
    distance_transform_edt,
    gaussian_filter,
)

from auricle.arrays import Points, Truths
from auricle.errors import SurfaceError
from auricle.imaging.chambers import ATRIUM
from auricle.imaging.diffusion import perona_malik
from auricle.imaging.growing import pieces_by_size
from auricle.imaging.mask import Mask
from auricle.imaging.necks import wall_distance
from auricle.imaging.resampling import mask_box, resampled
from auricle.imaging.segmentation import Segmentation
from auricle.imaging.simple_points import ball_like
from auricle.imaging.volume import Volume
from auricle.progress import Progress, silent
from auricle.surface.cleaning import Repair
from auricle.surface.extraction import extract_surface
from auricle.surface.mesh import Mesh
from auricle.surface.soundness import Soundness, soundness

FINEST_MM, COARSEST_MM = 0.5, 1.5
"""Spacings of the lattice a surface is drawn on."""
MARGIN_MM = 4.0
_ZONE_MM = 2.0
_ZONE_BLUR_MM = 0.7
_INTERIOR_MM = 1.5
_MASK_BLUR = 0.7
"""Steps of the lattice."""


@dataclass(frozen=True, eq=False)
class Endocardium:
    """A closed surface of genus 0, and what it took.

    Attributes
    ----------
    mesh
        Closed, manifold, one piece, genus 0, normals out of the blood; LPS mm.
    soundness
        Of the mesh.
    repairs
        What was mended, in the order it was done.
    spacing
        Of the lattice it was drawn on, mm.
    """

    mesh: Mesh
    soundness: Soundness
    repairs: tuple[Repair, ...]
    spacing: float


def endocardium(
    volume: Volume,
    segmentation: Segmentation,
    *,
    spacing: float | None = None,
    progress: Progress = silent,
) -> Endocardium:
    """The surface at half height between blood and wall around a segmented atrium.

    The volume itself is interpolated on a fine lattice, filtered, and its level set taken where
    the atrium meets its wall; at the cut ends, where there is no wall, the border of the
    segmentation stands in. Windowed-sinc smoothing takes the lattice off without shrinking.

    Parameters
    ----------
    volume
        The one segmented.
    segmentation
        Of the volume.
    spacing
        Of the lattice, mm; None takes half the volume's widest spacing, from 0.5 to 1.5.
    progress
        Told where the work stands.

    Raises
    ------
    SurfaceError
        If no closed surface of genus 0 comes out.
    """
    step = spacing or float(np.clip(0.5 * volume.spacing.max(), FINEST_MM, COARSEST_MM))
    progress("surface", 0, 3)
    low, high = mask_box(segmentation.mask, margin=MARGIN_MM)
    fine = resampled(volume, low=low, high=high, step=step)
    values = perona_malik(fine.voxels)
    progress("surface", 1, 3)
    thresholds = segmentation.thresholds
    height = (values - thresholds.lower) / (thresholds.blood - thresholds.lower)
    zone, interior = _zone(segmentation)
    on_fine = (segmentation.image, fine)
    field = np.minimum(np.clip(height, -1.0, 1.0), _carried(zone, *on_fine))
    np.maximum(field, np.minimum(_carried(interior, *on_fine) - _INTERIOR_MM, 1.0), out=field)
    progress("surface", 2, 3)
    surface = _ball_surface(field, fine.origin, step)
    progress("surface", 3, 3)
    return surface


def endocardium_of_mask(mask: Mask, *, spacing: float | None = None) -> Endocardium:
    """The smoothed surface of a mask someone made, on any lattice.

    Parameters
    ----------
    mask
        Of the atrium.
    spacing
        Of the lattice the surface is drawn on, mm; None takes the mask's finest, from 0.5 to 1.5.

    Raises
    ------
    SurfaceError
        If the mask is empty, or no closed surface of genus 0 comes out.

    Examples
    --------
    >>> x, y, z = np.indices((40, 40, 40))
    >>> ball = (x - 19.5) ** 2 + (y - 19.5) ** 2 + (z - 19.5) ** 2 < 15**2
    >>> surface = endocardium_of_mask(Mask(ball, np.diag([1.0, 1.0, 1.0, 1.0])))
    >>> surface.soundness.genus, bool(abs(surface.soundness.volume_mm3 / ball.sum() - 1) < 0.02)
    (0, True)
    """
    if not mask.voxels.any():
        raise SurfaceError("the mask is empty: choose another label")
    step = spacing or float(np.clip(mask.spacing.min(), FINEST_MM, COARSEST_MM))
    distance = _signed_distance(mask)
    low, high = mask_box(mask, margin=MARGIN_MM)
    fine = resampled(distance, low=low, high=high, step=step)
    field = gaussian_filter(np.clip(fine.voxels, -MARGIN_MM, MARGIN_MM), _MASK_BLUR)
    return _ball_surface(field, fine.origin, step)


def _signed_distance(mask: Mask) -> Volume:
    """Distance to the mask's edge, mm, positive inside, on a part of its lattice."""
    inside = np.argwhere(mask.voxels)
    first, last = inside.min(axis=0), inside.max(axis=0) + 1
    margin = np.ceil(2 * MARGIN_MM / mask.spacing).astype(int)
    block = np.pad(
        mask.voxels[tuple(slice(a, b) for a, b in zip(first, last, strict=True))],
        [(n, n) for n in margin.tolist()],
    )
    half = 0.5 * mask.spacing.mean()
    within = distance_transform_edt(block, sampling=mask.spacing)
    without = distance_transform_edt(~block, sampling=mask.spacing)
    distance = np.where(block, within - half, half - without).astype(np.float32)
    distance.flags.writeable = False
    affine = mask.affine.copy()
    affine[:3, 3] = mask.points_at(first - margin)
    return Volume(distance, affine)


def _zone(segmentation: Segmentation) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Two distances on the segmentation's lattice, mm: into the atrium's zone, and into its mask.

    The zone is what lies nearer to the atrium than to any other blood, and not far from it.
    """
    step = float(segmentation.mask.spacing[0])
    atrium = segmentation.mask.voxels
    other = (segmentation.labels > 0) & (segmentation.labels != ATRIUM)
    to_atrium = distance_transform_edt(~atrium, sampling=step)
    zone = _ZONE_MM - to_atrium
    if other.any():
        to_other = distance_transform_edt(~other, sampling=step)
        np.minimum(zone, 0.5 * (to_other - to_atrium), out=zone)
    zone = gaussian_filter(zone, _ZONE_BLUR_MM / step)
    return zone.astype(np.float32), wall_distance(atrium, step=step)


def _carried(values: NDArray[np.float32], lattice: Volume, target: Volume) -> NDArray[np.float32]:
    """Values on one straight lattice, interpolated on another; −1 mm, outside, beyond its edge."""
    ratio = target.spacing / lattice.spacing
    carried: NDArray[np.float32] = affine_transform(
        values,
        ratio,
        offset=lattice.index_of(target.origin),
        output_shape=target.shape,
        order=1,
        cval=-1.0,
        prefilter=False,
    )
    return carried


def _ball_surface(field: NDArray[np.floating], origin: Points, step: float) -> Endocardium:
    """The surface where the field is 0 around its largest piece, made a sphere in topology."""
    region, repairs = _filled_piece(field > 0)
    mesh, found = _surface_of(field, region, origin, step)
    if found.genus:
        opened = ball_like(region, distance_transform_edt(region, sampling=step))
        n_cut = int(region.sum() - opened.sum())
        handles = f"{found.genus} of them"
        repairs.append(Repair("voxels cut to open handles", n_cut, handles))
        mesh, found = _surface_of(field, opened, origin, step)
    _refuse_unsound(found)
    return Endocardium(mesh, found, tuple(repairs), step)


def _filled_piece(region: Truths) -> tuple[Truths, list[Repair]]:
    """The largest piece without cavities, and what that took."""
    pieces, sizes = pieces_by_size(region)
    if not len(sizes):
        raise SurfaceError("the atrium is empty: lower the threshold")
    kept = pieces == 1
    filled: Truths = binary_fill_holes(kept)
    repairs = []
    if len(sizes) > 1:
        repairs.append(Repair("detached voxels dropped", int(sizes[1:].sum())))
    if n_filled := int(filled.sum() - kept.sum()):
        repairs.append(Repair("voxels of cavities filled", n_filled))
    return filled, repairs


def _surface_of(
    field: NDArray[np.floating], region: Truths, origin: Points, step: float
) -> tuple[Mesh, Soundness]:
    """The surface around exactly `region`: the field where they agree, its mirror where not."""
    least = 0.05 * float(np.abs(field).max())
    kept = np.where(region, np.maximum(field, least), -np.maximum(-field, least))
    height = np.where((field > 0) == region, field, kept)
    x, y, z = origin.tolist()
    mesh = extract_surface(
        height.astype(np.float64), level=0.0, spacing=(step, step, step), origin=(x, y, z)
    )
    return mesh, soundness(mesh)


def _refuse_unsound(found: Soundness) -> None:
    sound = found.is_closed and found.is_manifold and found.is_oriented
    if not sound or found.n_pieces != 1 or found.genus != 0 or (found.volume_mm3 or 0.0) <= 0:
        raise SurfaceError(
            f"the surface has {found.n_pieces} pieces, {found.n_holes} holes and "
            f"{found.genus} handles: smooth the mask or give a coarser spacing"
        )
