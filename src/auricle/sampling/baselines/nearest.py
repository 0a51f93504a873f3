"""Nearest-sample colouring: every vertex has the value of the sample nearest along the surface."""

import numpy as np

from auricle.arrays import Floats
from auricle.errors import SurfaceError
from auricle.sampling.baselines.interpolation import checked, nearest_sites
from auricle.sampling.chamber import Chamber
from auricle.sampling.sites import Sites


def nearest(
    chamber: Chamber, sites: Sites, values: Floats, *, fill_threshold_mm: float = np.inf
) -> Floats:
    """Interpolate as `auricle.sampling.baselines.interpolation.Interpolator` says.

    Of samples at the same distance the earlier one counts.

    Raises
    ------
    SurfaceError
        If no path leads from any sample to a part of the surface.
    """
    samples = checked(sites, values, fill_threshold_mm)
    distances, owners = nearest_sites(chamber, sites, reach=fill_threshold_mm)
    beyond = ~(distances <= fill_threshold_mm)
    if np.isinf(fill_threshold_mm) and (owners < 0).any():
        raise SurfaceError("no path leads to a part of the surface: keep one piece of it")
    coloured: Floats = samples[owners]
    coloured[beyond] = np.nan
    return coloured
