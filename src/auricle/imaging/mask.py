"""A mask: which voxels of a lattice belong to a structure."""

from dataclasses import dataclass

import numpy as np

from auricle.errors import ImageError
from auricle.imaging.lattice import Lattice, frozen


@dataclass(frozen=True, eq=False)
class Mask(Lattice):
    """Truth values at the nodes of a lattice, checked on entry and never changed after.

    Parameters
    ----------
    voxels
        Bool, shape (nx, ny, nz), indexed [i, j, k]. Frozen: an array that is read-only already
        is taken as it is, any other is copied.
    affine
        Shape (4, 4): (i, j, k, 1) to (x, y, z, 1) in mm, LPS axes.
    remarks
        What the reader did on the way that the user should know, one phrase each.

    Raises
    ------
    ImageError
        If the shape, the type or the affine is not as above.

    Examples
    --------
    >>> voxels = np.zeros((4, 4, 4), bool)
    >>> voxels[1:3, 1:3, 1:3] = True
    >>> Mask(voxels, np.diag([5.0, 5.0, 5.0, 1.0])).volume_ml
    1.0
    """

    remarks: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.voxels.dtype != np.bool_:
            raise ImageError(f"a mask of type {self.voxels.dtype}: give truth values")
        object.__setattr__(self, "voxels", frozen(self.voxels, np.bool_))

    @property
    def volume_ml(self) -> float:
        """Volume of the voxels inside, ml."""
        return float(np.count_nonzero(self.voxels) * self.voxel_volume / 1000)
