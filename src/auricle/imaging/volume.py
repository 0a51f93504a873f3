"""A CT volume: Hounsfield units on a lattice in space."""

from dataclasses import dataclass

import numpy as np

from auricle.errors import ImageError
from auricle.imaging.lattice import Lattice, frozen

KINDS = (np.dtype(np.int16), np.dtype(np.float32))
"""Types of number a volume may hold."""


@dataclass(frozen=True, eq=False)
class Volume(Lattice):
    """CT numbers in HU at the nodes of a lattice, checked on entry and never changed after.

    Parameters
    ----------
    voxels
        HU, shape (nx, ny, nz), indexed [i, j, k], int16 or float32, finite. Frozen: an array
        that is read-only already is taken as it is, any other is copied.
    affine
        Shape (4, 4): (i, j, k, 1) to (x, y, z, 1) in mm, LPS axes.
    remarks
        What the reader did on the way that the user should know, one phrase each.
    orientation_known
        Whether the file says which way the patient lies; if not, nothing may be concluded from
        anatomy (left, front, up).

    Raises
    ------
    ImageError
        If the shape, the type or the affine is not as above, or a value is NaN or infinite.

    Examples
    --------
    >>> voxels = np.zeros((4, 5, 6), np.int16)
    >>> volume = Volume(voxels, np.diag([0.5, 0.5, 0.625, 1.0]))
    >>> volume.spacing.tolist(), volume.points_at([2, 2, 4]).tolist()
    ([0.5, 0.5, 0.625], [1.0, 1.0, 2.5])
    """

    remarks: tuple[str, ...] = ()
    orientation_known: bool = True

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.voxels.dtype not in KINDS:
            raise ImageError(f"voxels of type {self.voxels.dtype}: give HU as int16 or float32")
        object.__setattr__(self, "voxels", frozen(self.voxels, self.voxels.dtype))
        # NaN and infinity survive minimum and maximum, which need no temporary of this size
        if not np.isfinite([self.voxels.min(), self.voxels.max()]).all():
            raise ImageError("a voxel is NaN or infinite: fill it with −1024 HU (air)")
