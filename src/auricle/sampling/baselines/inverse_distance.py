"""Inverse-distance weighting: means of all samples, weighted by one over distance squared."""

import numpy as np

from auricle.arrays import Floats, Points
from auricle.sampling.baselines.interpolation import checked, filled_only
from auricle.sampling.chamber import Chamber
from auricle.sampling.sites import Sites

_SAME_PLACE = 1e-9
"""Distance, relative to the chamber's size, below which a vertex has the sample's own value."""
_ENTRIES_AT_ONCE = 2_000_000


def inverse_distance(
    chamber: Chamber, sites: Sites, values: Floats, *, fill_threshold_mm: float = np.inf
) -> Floats:
    """Interpolate as `auricle.sampling.baselines.interpolation.Interpolator` says.

    Distances are straight ones (Shepard 1968, with p = 2), through walls as well: systems do so.
    The result stays within the range of the samples, and at a vertex with samples it is their
    mean.
    """
    samples = checked(sites, values, fill_threshold_mm)
    vertices = chamber.mesh.vertices
    positions = sites.positions(chamber.mesh)
    least = _SAME_PLACE * float(np.ptp(vertices, axis=0).max())
    rows = max(_ENTRIES_AT_ONCE // len(positions), 1)
    chunks = [
        _weights(vertices[start : start + rows], positions, least) @ samples
        for start in range(0, len(vertices), rows)
    ]
    return filled_only(chamber, sites, np.concatenate(chunks), fill_threshold_mm)


def _weights(vertices: Points, positions: Points, least: float) -> Floats:
    """Weights of the samples at each vertex, shape (r, m), of sum 1."""
    squares = ((vertices[:, None, :] - positions[None]) ** 2).sum(axis=2)
    there = squares < least**2
    here = there.any(axis=1)
    weights: Floats = 1.0 / np.maximum(squares, least**2)
    weights[here] = there[here]
    weights /= weights.sum(axis=1, keepdims=True)
    return weights
