"""Interpolation from sites: its signature, its checks, and the distance up to which it colours."""

from typing import Protocol

import numpy as np

from auricle.arrays import Floats, Integers, PerVertex, Truths
from auricle.errors import InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.sites import Sites
from auricle.surface.fast_marching import FastMarching, VoronoiCells


class Interpolator(Protocol):
    """A map from samples.

    Parameters
    ----------
    chamber
        The surface.
    sites
        Where the samples were taken, m of them.
    values
        Shape (m,), or (m, c) for several maps at the same sites: of times within a cycle, cosine
        and sine of the phase.
    fill_threshold_mm
        Distance along the surface from the nearest sample up to which a vertex gets a value;
        beyond it NaN. The usual settings: `auricle.sampling.literature.FILL_DISTANCES_MM`.

    Returns
    -------
    Floats
        Shape (n,) or (n, c), at all vertices of the closed mesh.

    Raises
    ------
    InputError
        If there is no sample, a value is not finite, there are not as many values as sites, or
        the threshold is not positive.
    """

    def __call__(
        self,
        chamber: Chamber,
        sites: Sites,
        values: Floats,
        *,
        fill_threshold_mm: float = np.inf,
    ) -> Floats:
        """Interpolate."""
        ...


def checked(sites: Sites, values: Floats, fill_threshold_mm: float) -> Floats:
    """The values as floats, if they, the sites and the threshold are fit for interpolation."""
    samples: Floats = np.asarray(values, dtype=np.float64)
    if not len(sites):
        raise InputError("no samples: a map needs at least one")
    if samples.ndim not in (1, 2) or len(samples) != len(sites):
        raise InputError(f"values of shape {samples.shape} at {len(sites)} sites: give one each")
    if not np.isfinite(samples).all():
        raise InputError("a sample's value is NaN or infinite: leave it out")
    if not fill_threshold_mm > 0:
        raise InputError(f"a fill threshold of {fill_threshold_mm} mm: give a positive one")
    return samples


def nearest_sites(
    chamber: Chamber, sites: Sites, *, reach: float = np.inf
) -> tuple[PerVertex, Integers]:
    """Distance along the surface to the nearest site, and which it is.

    From a site inside a triangle the way starts straight to its three corners.

    Returns
    -------
    distances
        Shape (n,), mm; infinite beyond `reach`.
    owners
        Shape (n,); -1 there.
    """
    cells = VoronoiCells(FastMarching(chamber.mesh), reach=reach)
    positions = sites.positions(chamber.mesh)
    for corners, position in zip(sites.corners, positions, strict=True):
        own = np.unique(corners)
        cells.add(own, np.linalg.norm(chamber.mesh.vertices[own] - position, axis=1))
    return cells.distances, cells.owners


def filled_only(
    chamber: Chamber, sites: Sites, interpolated: Floats, fill_threshold_mm: float
) -> Floats:
    """The map with NaN farther from every sample than the threshold."""
    if np.isinf(fill_threshold_mm):
        return interpolated
    distances, _ = nearest_sites(chamber, sites, reach=fill_threshold_mm)
    beyond: Truths = ~(distances <= fill_threshold_mm)
    masked: Floats = interpolated.copy()
    masked[beyond] = np.nan
    return masked
