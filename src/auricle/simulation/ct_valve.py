"""The leaflets of a mitral valve: a thin funnel from the annulus into the ventricle."""

from dataclasses import dataclass

import numpy as np

from auricle.arrays import Points
from auricle.simulation.ct_block import Block, Box, Grid


@dataclass(frozen=True, eq=False)
class Funnel:
    """A cone's wall of even thickness.

    Attributes
    ----------
    centre, axis
        Middle of the wide end and the unit vector to the narrow one.
    wide, narrow
        Height above the centre and radius of each end, mm.
    thickness
        Of the wall, mm.
    """

    centre: Points
    axis: Points
    wide: tuple[float, float]
    narrow: tuple[float, float]
    thickness: float

    @property
    def box(self) -> Box:
        """Where it lies."""
        reach = max(self.wide[1], self.narrow[0]) + self.narrow[1] + self.thickness
        return self.centre - reach, self.centre + reach

    def distance(self, block: Block) -> Grid:
        """Signed distance at the voxels, mm; exact."""
        x, y, z = (
            coordinate - middle
            for coordinate, middle in zip(block.coordinates, self.centre, strict=True)
        )
        height = self.axis[0] * x + self.axis[1] * y + self.axis[2] * z
        beside = np.sqrt(np.maximum(x**2 + y**2 + z**2 - height**2, 0.0))
        rise, widening = self.narrow[0] - self.wide[0], self.narrow[1] - self.wide[1]
        along = (height - self.wide[0]) * rise + (beside - self.wide[1]) * widening
        share = np.clip(along / (rise**2 + widening**2), 0.0, 1.0)
        off = np.hypot(
            height - self.wide[0] - share * rise, beside - self.wide[1] - share * widening
        )
        distance: Grid = (off - self.thickness / 2).astype(np.float32)
        return distance
