"""Samples left out with their neighbours: what a map misses where no sample is near."""

import numpy as np
from scipy.spatial import KDTree

from auricle.arrays import Floats, Integers
from auricle.sampling.chamber import Chamber
from auricle.sampling.sites import Sites

MOST_TOGETHER = 50
"""Samples that are left out together at most, beside half of all: each solves for as many."""


def neighbourhoods(chamber: Chamber, sites: Sites) -> tuple[Integers, ...]:
    """Of every sample those to leave out with it, itself first.

    A map is asked for where no sample is: at the mean, over the accessible area, so far from the
    nearest one. Of samples spread evenly that is less than their spacing, and each is left out
    alone. Of clusters, as a catheter leaves them, it is more: a sample then has neighbours that
    foretell it, as they do not foretell the map between the clusters; they are left out too.

    Returns
    -------
    tuple of Integers
        Indices of the samples within that distance in space, at most `MOST_TOGETHER` of them and
        half of all: the nearest.
    """
    positions = sites.positions(chamber.mesh)
    areas = chamber.accessible_areas
    inside = areas > 0
    tree = KDTree(positions)
    away, _ = tree.query(chamber.mesh.vertices[inside])
    reach = float(np.average(away, weights=areas[inside]))
    most = max(min(len(positions) // 2, MOST_TOGETHER), 1)
    distances, nearest = tree.query(positions, k=np.arange(1, most + 1))
    counts = np.count_nonzero(np.asarray(distances) <= reach, axis=1)
    order = np.asarray(nearest)
    return tuple(
        _itself_first(index, order[index, :count]) for index, count in enumerate(counts.tolist())
    )


def left_out_together(precision: Floats, values: Floats, together: tuple[Integers, ...]) -> Floats:
    """Each value minus its prediction without it and its neighbours, shape (N, c).

    In closed form: with P the precision of the values beside what is free in the map and B the
    samples left out, their residuals are (P_BB)⁻¹(P·values)_B; of one alone the quotient of
    Rasmussen and Williams (2006, Eq. 5.12).

    Parameters
    ----------
    precision
        P, shape (N, N).
    values
        Shape (N, c).
    together
        As `neighbourhoods` has them: not all of the samples.
    """
    weights = precision @ values
    residuals = weights / np.diag(precision)[:, None]
    for index, some in enumerate(together):
        if len(some) > 1:
            among = precision[np.ix_(some, some)]
            residuals[index] = np.linalg.solve(among, weights[some])[0]
    return np.asarray(residuals)


def _itself_first(index: int, some: Integers) -> Integers:
    # Of samples in one place the tree may name another one first, or leave this one out.
    others = some[some != index]
    return np.concatenate([[index], others[: max(len(some) - 1, 0)]]).astype(np.intp)
