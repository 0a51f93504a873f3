"""What may be chosen about a segmentation."""

from dataclasses import dataclass

import numpy as np

from auricle.arrays import Points
from auricle.errors import InputError
from auricle.imaging.cutters import Cutter
from auricle.imaging.region_of_interest import RegionOfInterest


@dataclass(frozen=True, eq=False)
class SegmentationOptions:
    """How to segment; every default is for a contrast CT of an adult heart.

    Attributes
    ----------
    seed
        A place in the left atrium, (3,), mm, LPS; None finds one.
    region
        What the atrium lies in: thresholds come from its histogram, and nothing outside it is
        kept. Chambers are told apart in a box about the seed all the same.
    lower, upper
        Thresholds in HU that replace those from the histogram.
    step
        Spacing of the lattice the segmentation is found on, mm.
    contrast, iterations
        Of the anisotropic diffusion: HU, and passes.
    vein_stub
        Length of vein kept from its ostium, mm.
    cutters
        Where blood must not be followed any further.

    Raises
    ------
    InputError
        If a number is not positive and finite.
    """

    seed: Points | None = None
    region: RegionOfInterest | None = None
    lower: float | None = None
    upper: float | None = None
    step: float = 1.0
    contrast: float = 40.0
    iterations: int = 5
    vein_stub: float = 12.0
    cutters: tuple[Cutter, ...] = ()

    def __post_init__(self) -> None:
        if self.seed is not None:
            place = np.asarray(self.seed, dtype=np.float64)
            if place.shape != (3,) or not np.isfinite(place).all():
                raise InputError("a seed is three finite coordinates: give x, y, z in mm, LPS")
            object.__setattr__(self, "seed", place)
        if not 0.3 <= self.step <= 3.0:
            raise InputError(f"a lattice of {self.step} mm: give 0.3 to 3")
        if not 0 <= self.vein_stub <= 100:
            raise InputError(f"vein stubs of {self.vein_stub} mm: give 0 to 100")
