"""Resampling: a box of a volume on a lattice of equal spacing whose axes are left, back, head."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import affine_transform

from auricle.arrays import Floats, Truths
from auricle.errors import ImageError
from auricle.imaging.mask import Mask
from auricle.imaging.volume import Volume

AIR = -1024.0
"""What lies outside the volume, HU."""
MOST_VOXELS = 60_000_000
"""Beyond this a lattice is refused rather than the memory filled."""


def corners(lattice: Volume | Mask) -> Floats:
    """Positions of the eight corner voxels' centres, shape (8, 3), mm."""
    last = np.array(lattice.shape) - 1
    points: Floats = lattice.points_at(np.indices((2, 2, 2)).reshape(3, -1).T * last)
    return points


def mask_box(mask: Mask, *, margin: float) -> tuple[Floats, Floats]:
    """Opposite corners of the box along LPS around the mask's voxels, `margin` mm wider."""
    inside = np.argwhere(mask.voxels)
    ends = np.stack([inside.min(axis=0), inside.max(axis=0)])
    choice = np.indices((2, 2, 2)).reshape(3, -1).T
    points = mask.points_at(np.take_along_axis(ends, choice, axis=0))
    return points.min(axis=0) - margin, points.max(axis=0) + margin


def resampled(volume: Volume, *, low: ArrayLike, high: ArrayLike, step: float) -> Volume:
    """The box from `low` to `high` by linear interpolation; air (−1024 HU) outside the volume.

    Parameters
    ----------
    volume
        On any lattice, oblique ones included.
    low, high
        Opposite corners, shape (3,), mm, LPS.
    step
        Spacing of the new lattice, mm, the same along its three axes, which are those of LPS.

    Returns
    -------
    Volume
        HU as float32; its affine has no rotation.

    Raises
    ------
    ImageError
        If the box is empty or would hold more than 60 million voxels.

    Examples
    --------
    >>> i = np.indices((5, 5, 5), dtype=np.float32)[0]
    >>> ramp = Volume(100 * i, np.diag([-2.0, 2.0, 2.0, 1.0]))
    >>> fine = resampled(ramp, low=[-6, 2, 2], high=[-2, 6, 6], step=1.0)
    >>> fine.voxels[:, 0, 0].tolist()
    [300.0, 250.0, 200.0, 150.0, 100.0]
    """
    start = np.asarray(low, np.float64)
    extent = np.asarray(high, np.float64) - start
    if not step > 0 or not (extent >= step).all():
        raise ImageError(f"a box of {extent.tolist()} mm in steps of {step} mm: enlarge the box")
    shape = tuple((np.floor(extent / step + 1e-9).astype(int) + 1).tolist())
    if np.prod(shape, dtype=float) > MOST_VOXELS:
        raise ImageError(f"a box of {np.prod(shape, dtype=float):.2g} voxels: take a smaller box")
    block, first = _block(volume, start, start + extent)
    turn = np.linalg.inv(volume.affine[:3, :3])
    offset = turn @ (start - volume.origin) - first
    values: NDArray[np.float32] = affine_transform(
        block,
        _simplest(turn * step),
        offset=offset,
        output_shape=shape,
        output=np.dtype(np.float32),
        order=1,
        cval=AIR,
        prefilter=False,
    )
    values.flags.writeable = False
    return Volume(values, straight_affine(start, step), remarks=volume.remarks)


def straight_affine(origin: ArrayLike, step: float) -> Floats:
    """The affine of a lattice along the axes of LPS, shape (4, 4)."""
    affine = np.diag([step, step, step, 1.0])
    affine[:3, 3] = origin
    return affine


def mask_on(mask: Mask, volume: Volume) -> Mask:
    """The mask on the volume's lattice: true where linear interpolation of it gives over ½."""
    low = volume.index_of(corners(mask)).min(axis=0)
    high = volume.index_of(corners(mask)).max(axis=0)
    first = np.clip(np.floor(low).astype(int), 0, volume.shape)
    last = np.clip(np.ceil(high).astype(int) + 1, 0, volume.shape)
    voxels: Truths = np.zeros(volume.shape, dtype=bool)
    if (last > first).all():
        turn = np.linalg.inv(mask.affine[:3, :3])
        offset = turn @ (volume.points_at(first) - mask.origin)
        share = affine_transform(
            mask.voxels.astype(np.float32),
            _simplest(turn @ volume.affine[:3, :3]),
            offset=offset,
            output_shape=tuple((last - first).tolist()),
            order=1,
            prefilter=False,
        )
        place = tuple(slice(a, b) for a, b in zip(first, last, strict=True))
        voxels[place] = share > 0.5
    voxels.flags.writeable = False
    return Mask(voxels, volume.affine)


def _block(volume: Volume, low: Floats, high: Floats) -> tuple[NDArray[Any], Floats]:
    """The voxels the box needs, and the index of the first of them."""
    ends = np.where(np.indices((2, 2, 2)).reshape(3, -1).T == 0, low, high)
    indices = volume.index_of(ends)
    first = np.clip(np.floor(indices.min(axis=0)).astype(int) - 1, 0, np.array(volume.shape) - 2)
    last = np.clip(np.ceil(indices.max(axis=0)).astype(int) + 2, first + 2, volume.shape)
    place = tuple(slice(a, b) for a, b in zip(first, last, strict=True))
    return volume.voxels[place], first.astype(np.float64)


def _simplest(matrix: NDArray[np.floating]) -> Floats:
    """The diagonal of a diagonal matrix, for which interpolation takes a shorter way."""
    diagonal = np.diag(matrix).astype(np.float64)
    straight = np.array_equal(np.diag(diagonal), matrix)
    return diagonal if straight else matrix.astype(np.float64)
