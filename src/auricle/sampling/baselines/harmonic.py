"""Harmonic interpolation: the smoothest map, in the sense of least ∫|∇u|², through the samples."""

import numpy as np
import robust_laplacian
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import splu

from auricle.arrays import Floats
from auricle.sampling.baselines.interpolation import checked, filled_only
from auricle.sampling.chamber import Chamber
from auricle.sampling.sites import Sites

STIFFNESS_OF_SAMPLES = 1e7
"""Energy of missing a sample by 1, in units of a typical edge's energy for a step of 1.

Samples are missed by about 1e-7 of the map's range; twice a sample at one place is its mean.
"""


def harmonic(
    chamber: Chamber, sites: Sites, values: Floats, *, fill_threshold_mm: float = np.inf
) -> Floats:
    """Interpolate as `auricle.sampling.baselines.interpolation.Interpolator` says.

    The linear interpolation of mapping systems, on the surface: between two samples on a strip
    it is a straight line. With samples at vertices the map keeps within their range (maximum
    principle: the intrinsic Delaunay Laplacian has no negative weight).
    """
    samples = checked(sites, values, fill_threshold_mm)
    mesh = chamber.mesh
    centred = mesh.vertices - mesh.vertices.mean(axis=0)
    stiffness, _ = robust_laplacian.mesh_laplacian(centred, mesh.faces)
    n_sites = len(sites)
    at_sites = coo_array(
        (sites.weights.ravel(), (np.repeat(np.arange(n_sites), 3), sites.corners.ravel())),
        shape=(n_sites, mesh.n_vertices),
    ).tocsr()
    # Far from zero the solution would lose digits: interpolate the deviation from the mean.
    mean = samples.mean(axis=0)
    factors = splu(
        csc_array(stiffness + STIFFNESS_OF_SAMPLES * (at_sites.T @ at_sites)),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    solution = factors.solve(STIFFNESS_OF_SAMPLES * (at_sites.T @ (samples - mean)))
    return filled_only(chamber, sites, solution + mean, fill_threshold_mm)
