"""A block of voxels in space, and the part of it that a structure can reach."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from auricle.arrays import Floats, Points
from auricle.simulation.implicit import Coordinates

Grid = NDArray[np.float32]
"""One number a voxel, indexed [k, j, i]: slice, row, column."""
Box = tuple[Points, Points]
"""Lowest and highest coordinates, mm."""
Window = tuple[slice, slice, slice]


@dataclass(frozen=True, eq=False)
class Block:
    """Voxels at origin + steps @ (i, j, k).

    Attributes
    ----------
    origin
        Position of voxel (0, 0, 0), mm.
    steps
        Shape (3, 3): the columns lead from one voxel to the next along i, j and k, mm.
    shape
        Number of voxels along k, j and i: arrays on the block are indexed so.
    """

    origin: Points
    steps: Floats
    shape: tuple[int, int, int]

    @property
    def inverse(self) -> Floats:
        """Matrix from mm to steps, shape (3, 3)."""
        return np.asarray(np.linalg.inv(self.steps), dtype=np.float64)

    @property
    def edge(self) -> float:
        """Edge of a cube as large as a voxel, mm."""
        return float(np.cbrt(abs(np.linalg.det(self.steps))))

    @property
    def coordinates(self) -> Coordinates:
        """Arrays of x, y and z, mm, that broadcast to `shape`; thin where the axes agree."""
        k, j, i = np.ix_(*(np.arange(count, dtype=np.float64) for count in self.shape))
        x, y, z = (
            self._coordinate(start, row, (i, j, k))
            for start, row in zip(self.origin, self.steps, strict=True)
        )
        return x, y, z

    @staticmethod
    def _coordinate(start: float, row: Floats, indices: Coordinates) -> Floats:
        coordinate = np.full((1, 1, 1), start)
        for step, index in zip(row, indices, strict=True):
            if step != 0.0:
                coordinate = coordinate + step * index
        return coordinate

    def slab(self, start: int, stop: int) -> "Block":
        """The slices from `start` to before `stop`."""
        _, rows, columns = self.shape
        return self.part((slice(start, stop), slice(0, rows), slice(0, columns)))

    def part(self, window: Window) -> "Block":
        """The voxels in a window of slices [k, j, i]."""
        first = np.array([axis.start for axis in window[::-1]], dtype=np.float64)
        counts = [axis.stop - axis.start for axis in window]
        return Block(
            self.origin + self.steps @ first, self.steps, (counts[0], counts[1], counts[2])
        )

    def window(self, box: Box, *, margin: float) -> Window | None:
        """The voxels within `margin` mm of a box of space, or None if there are none.

        Examples
        --------
        >>> block = Block(np.zeros(3), np.diag([2.0, 1.0, 1.0]), (5, 6, 7))
        >>> block.window((np.array([3.0, 1.0, 1.0]), np.array([4.5, 2.0, 9.0])), margin=0.0)
        (slice(1, 5, None), slice(1, 3, None), slice(2, 3, None))
        """
        low, high = box[0] - margin, box[1] + margin
        centre = self.inverse @ ((low + high) / 2 - self.origin)
        reach = np.abs(self.inverse) @ ((high - low) / 2)
        counts = np.array(self.shape[::-1])
        # Far structures have infinite boxes only in doubt: clip before turning into integers.
        first = np.clip(np.ceil(centre - reach - 1e-9), 0, counts).astype(int)
        last = np.clip(np.floor(centre + reach + 1e-9) + 1, 0, counts).astype(int)
        if (last <= first).any():
            return None
        i, j, k = (slice(int(a), int(b)) for a, b in zip(first, last, strict=True))
        return k, j, i
