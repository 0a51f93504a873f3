"""Voxels on a lattice in space: array indices [i, j, k] tied to LPS positions by an affine."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from auricle.arrays import Floats, Points, read_only
from auricle.errors import ImageError

_SQUARENESS = 1e-4
_LAST_ROW = (0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class Lattice:
    """Values at the nodes of a rectangular lattice, checked on entry and never changed after.

    Parameters
    ----------
    voxels
        Shape (nx, ny, nz), indexed [i, j, k], each axis 2 or longer. Frozen: an array that is
        read-only already is taken as it is, any other is copied.
    affine
        Shape (4, 4): (i, j, k, 1) to (x, y, z, 1) in mm, LPS axes (to the patient's left, back
        and head); copied and frozen.

    Raises
    ------
    ImageError
        If the shape is another, the affine is not finite, its axes have no length or are not at
        right angles.
    """

    voxels: NDArray[Any]
    affine: Floats

    def __post_init__(self) -> None:
        object.__setattr__(self, "voxels", np.asarray(self.voxels))
        object.__setattr__(self, "affine", read_only(self.affine, np.float64))
        if self.voxels.ndim != 3:
            raise ImageError(f"{self.voxels.ndim}-dimensional voxels: give one volume (nx, ny, nz)")
        if min(self.voxels.shape) < 2:
            raise ImageError(f"{_shape_text(self.voxels)} voxels: give 2 or more along each axis")
        _check_affine(self.affine)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Voxels along i, j and k."""
        nx, ny, nz = self.voxels.shape
        return nx, ny, nz

    @property
    def spacing(self) -> Floats:
        """Distance between neighbours along i, j and k, shape (3,), mm."""
        lengths: Floats = np.linalg.norm(self.affine[:3, :3], axis=0)
        return lengths

    @property
    def origin(self) -> Floats:
        """Centre of voxel [0, 0, 0], shape (3,), mm, LPS."""
        return self.affine[:3, 3]

    @property
    def direction(self) -> Floats:
        """Unit vectors of i, j and k in LPS, one a column, shape (3, 3)."""
        axes: Floats = self.affine[:3, :3] / self.spacing
        return axes

    @property
    def voxel_volume(self) -> float:
        """Volume of one voxel, mm³."""
        return float(np.prod(self.spacing))

    def points_at(self, indices: ArrayLike) -> Points:
        """Positions of (fractional) `indices`, shape (n, 3) or (3,): the same shape, mm, LPS."""
        points: Points = np.asarray(indices, np.float64) @ self.affine[:3, :3].T + self.origin
        return points

    def index_of(self, points_lps: ArrayLike) -> Floats:
        """Fractional indices of positions, shape (n, 3) or (3,), mm, LPS: the same shape.

        A voxel reaches from −½ to +½ about its index; outside the lattice nothing is clipped.
        """
        inverse = np.linalg.inv(self.affine[:3, :3])
        indices: Floats = (np.asarray(points_lps, np.float64) - self.origin) @ inverse.T
        return indices


def frozen(voxels: NDArray[Any], dtype: DTypeLike) -> NDArray[Any]:
    """`voxels` as `dtype` and read-only: itself where it is both already, else a copy.

    >>> own = np.zeros((2, 2, 2), np.int16)
    >>> own.flags.writeable = False
    >>> frozen(own, np.int16) is own
    True
    """
    if voxels.dtype == dtype and not voxels.flags.writeable:
        return voxels
    copy = np.array(voxels, dtype=dtype, order="K", copy=True)
    copy.flags.writeable = False
    return copy


def _check_affine(affine: Floats) -> None:
    if affine.shape != (4, 4) or not np.isfinite(affine).all():
        raise ImageError("the affine is not a finite (4, 4) matrix: correct the geometry")
    if tuple(affine[3]) != _LAST_ROW:
        raise ImageError(f"the affine ends in {affine[3].tolist()}: give 0, 0, 0, 1")
    lengths = np.linalg.norm(affine[:3, :3], axis=0)
    if not (lengths > 0).all():
        raise ImageError(f"a spacing of {lengths.tolist()} mm: give positive distances")
    axes = affine[:3, :3] / lengths
    if np.abs(axes.T @ axes - np.eye(3)).max() > _SQUARENESS:
        raise ImageError("the axes are not at right angles (sheared): resample to a straight grid")


def _shape_text(voxels: NDArray[Any]) -> str:
    return "×".join(map(str, voxels.shape))
