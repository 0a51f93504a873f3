"""Radial basis functions: maps through the samples that are smooth in space, not on the surface."""

import numpy as np
from scipy.interpolate import RBFInterpolator
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from auricle.arrays import Floats, Points
from auricle.errors import InputError
from auricle.sampling.baselines.interpolation import checked, filled_only
from auricle.sampling.chamber import Chamber
from auricle.sampling.sites import Sites

SAME_PLACE_MM = 1e-3
"""Distance up to which samples count as repeated: their mean is interpolated."""
_FLAT = 1e-9


def linear_radial(
    chamber: Chamber, sites: Sites, values: Floats, *, fill_threshold_mm: float = np.inf
) -> Floats:
    """Interpolate as `auricle.sampling.baselines.interpolation.Interpolator` says.

    With the straight distance r itself as radial function, and a constant.
    """
    samples = checked(sites, values, fill_threshold_mm)
    positions, means = _without_repeats(sites.positions(chamber.mesh), samples)
    fitted = RBFInterpolator(positions, means, kernel="linear", degree=0)
    return filled_only(chamber, sites, fitted(chamber.mesh.vertices), fill_threshold_mm)


def thin_plate(
    chamber: Chamber, sites: Sites, values: Floats, *, fill_threshold_mm: float = np.inf
) -> Floats:
    """Interpolate as `auricle.sampling.baselines.interpolation.Interpolator` says.

    With r²·log r as radial function (the thin-plate spline of the plane, used in space) and a
    linear polynomial.

    Raises
    ------
    InputError
        If fewer than four samples, or all in a plane, leave the polynomial undetermined.
    """
    samples = checked(sites, values, fill_threshold_mm)
    positions, means = _without_repeats(sites.positions(chamber.mesh), samples)
    spread = np.linalg.svd(positions - positions.mean(axis=0), compute_uv=False)
    if len(positions) < 4 or not spread[-1] > _FLAT * spread[0]:
        raise InputError(
            f"{len(positions)} places, or all in a plane: a thin-plate spline needs four that "
            "are not; use another interpolation"
        )
    fitted = RBFInterpolator(positions, means, kernel="thin_plate_spline", degree=1)
    return filled_only(chamber, sites, fitted(chamber.mesh.vertices), fill_threshold_mm)


def _without_repeats(positions: Points, samples: Floats) -> tuple[Points, Floats]:
    """Places without repetition, and the mean of the samples at each."""
    m = len(positions)
    pairs = KDTree(positions).query_pairs(SAME_PLACE_MM, output_type="ndarray")
    graph = coo_array((np.ones(len(pairs)), pairs.T), shape=(m, m))
    n_places, place = connected_components(graph, directed=False)
    to_means = np.zeros((n_places, m))
    to_means[place, np.arange(m)] = 1.0 / np.bincount(place)[place]
    return to_means @ positions, to_means @ samples
