"""The endocardium of a phantom as it is: its exact distance, its landmarks, its surface."""

from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats, Points
from auricle.simulation.anatomy import vector
from auricle.simulation.ct_atrium import PhantomAtrium
from auricle.simulation.ct_block import Block
from auricle.surface.extraction import extract_surface
from auricle.surface.mesh import Mesh


@dataclass(frozen=True, eq=False)
class Truth:
    """The left atrium of a phantom as it is, in LPS mm of the image.

    The endocardium encloses body, appendage and the first 12 mm of each vein along its centre
    line; it ends flat there and at the plane of the mitral annulus.

    Attributes
    ----------
    atrium
        The anatomy, about the origin of its own axes.
    offset
        Where that origin lies, mm.
    """

    atrium: PhantomAtrium
    offset: Points

    def distance(self, points: Points) -> Floats:
        """Signed distance of LPS points (m, 3) to the endocardium, shape (m,), mm.

        Negative inside; right to a few per cent out to 2 mm, a lower bound further off.
        """
        return self.atrium.distance_at(np.asarray(points, dtype=np.float64) - self.offset)

    @property
    def seed(self) -> Points:
        """A point in the middle of the atrium, mm."""
        return self.offset.copy()

    @property
    def mitral_centre(self) -> Points:
        """Middle of the mitral annulus, mm."""
        return self.offset + self.atrium.annulus_centre

    @property
    def mitral_normal(self) -> Points:
        """Unit vector across the annulus to the ventricle."""
        return self.atrium.annulus_normal

    @property
    def mitral_radius(self) -> float:
        """Radius of the mitral orifice, mm."""
        return self.atrium.annulus_radius

    @property
    def ostia(self) -> Points:
        """Middles of the ostia of the veins, shape (veins, 3), mm."""
        places: Points = np.array([vein.ostium for vein in self.atrium.veins])
        return self.offset + places

    @property
    def appendage_tip(self) -> Points:
        """End of the centre line of the appendage, mm."""
        tip: Points = self.atrium.shape.appendage.centre_line(np.array([1.0]))[0]
        return self.offset + tip


def truth_surface(truth: Truth, *, spacing: float = 0.8) -> Mesh:
    """The true endocardium as a closed surface, LPS mm, extracted on a grid of `spacing` mm."""
    low, high = truth.atrium.box
    counts = np.ceil((high - low + 6.0 * spacing) / spacing).astype(int)
    start = low - 3.0 * spacing
    block = Block(start, np.eye(3) * spacing, (int(counts[2]), int(counts[1]), int(counts[0])))
    return extract_surface(
        -truth.atrium.distance(block).T.astype(np.float64),
        level=0.0,
        spacing=(spacing, spacing, spacing),
        origin=vector(start + truth.offset),
    )
