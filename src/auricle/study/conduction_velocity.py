"""Conduction velocity: how fast activation runs over a surface, and how sure that is.

The velocity is 1/|∇t|, t the activation time, its gradient constant in each triangle; what is
averaged is the slowness |∇t|, which stays finite where wavefronts meet or begin.
"""

from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats, PerVertex, Truths
from auricle.sampling.cycle import circular_difference
from auricle.surface.mesh import Mesh

QUANTILES = (0.05, 0.95)
"""Of the draws: the ends of the interval that is told."""
_SLOWEST_TOLD = 1e-6


@dataclass(frozen=True, eq=False)
class ConductionVelocity:
    """Velocities in m/s (mm/ms) over the part of a surface that was mapped.

    Attributes
    ----------
    of_map
        Median of the most probable map: half of the mapped area conducts faster. That map is
        smoother than the truth, and so too fast.
    expected, low, high
        Median and `QUANTILES` of the same of maps that agree with the samples as well as the
        truth may. Detail finer than the samples is in none of them: still rather too fast.
    vendor
        Of the vendor's own map; NaN if there is none.
    local, local_low, local_high
        At each vertex the same, shape (n,); NaN where not mapped.
    """

    of_map: float
    expected: float
    low: float
    high: float
    vendor: float
    local: PerVertex
    local_low: PerVertex
    local_high: PerVertex


def slowness(mesh: Mesh, times: Floats, *, cycle_length: float | None = None) -> Floats:
    """Length of the gradient of activation times in each triangle, shape (…, f), ms/mm.

    Parameters
    ----------
    mesh
        The surface.
    times
        At the vertices, shape (…, n), ms; NaN spreads to the triangles it touches.
    cycle_length
        Of times that wrap round: differences are then taken the short way.

    Examples
    --------
    A plane wave at 0.5 m/s:

    >>> plane = Mesh([[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
    >>> slowness(plane, plane.vertices[:, 0] / 0.5).tolist()
    [2.0]
    """
    corners = mesh.vertices[mesh.faces]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    along, across, second_along = (
        (a * b).sum(axis=1) for a, b in ((first, first), (first, second), (second, second))
    )
    at = [times[..., mesh.faces[:, corner]] for corner in range(3)]
    rise, other = (_difference(at[corner], at[0], cycle_length) for corner in (1, 2))
    area = np.maximum(along * second_along - across**2, np.finfo(float).tiny)
    squares = rise**2 * second_along - 2 * rise * other * across + other**2 * along
    lengths: Floats = np.sqrt(np.maximum(squares, 0.0) / area)
    return lengths


def conduction_velocity(
    mesh: Mesh,
    times: PerVertex,
    draws: Floats,
    *,
    mapped: Truths,
    vendor: PerVertex | None = None,
    cycle_length: float | None = None,
) -> ConductionVelocity | None:
    """Velocity over the mapped part of a surface; None if no whole triangle was mapped.

    Parameters
    ----------
    mesh
        The surface.
    times
        Most probable activation times, shape (n,), ms.
    draws
        Maps that agree with the samples, shape (c, n), ms.
    mapped
        Vertices to be judged, shape (n,).
    vendor
        The vendor's times, NaN where there are none.
    cycle_length
        Of times that wrap round.
    """
    faces = np.flatnonzero(mapped[mesh.faces].all(axis=1))
    areas = mesh.face_areas[faces]
    if not len(faces) or not areas.sum() > 0:
        return None
    part = Mesh(mesh.vertices, mesh.faces[faces])
    own = slowness(part, times, cycle_length=cycle_length)
    drawn = slowness(part, draws, cycle_length=cycle_length)
    medians = np.array([weighted_median(each, areas) for each in drawn])
    middle, slow, fast = np.quantile(medians, (0.5, QUANTILES[1], QUANTILES[0])).tolist()
    of_vendor = np.nan
    if vendor is not None:
        theirs = slowness(part, vendor, cycle_length=cycle_length)
        known = np.isfinite(theirs)
        if known.any():
            of_vendor = _speed(weighted_median(theirs[known], areas[known]))
    ends = np.quantile(drawn, (QUANTILES[1], QUANTILES[0]), axis=0)
    return ConductionVelocity(
        _speed(weighted_median(own, areas)),
        _speed(middle),
        _speed(slow),
        _speed(fast),
        of_vendor,
        *(_at_vertices(part, each) for each in (own, *ends)),
    )


def weighted_median(values: Floats, weights: Floats) -> float:
    """The value below which half of the weight lies.

    >>> weighted_median(np.array([3.0, 1.0, 2.0]), np.array([1.0, 1.0, 5.0]))
    2.0
    """
    order = np.argsort(values)
    below = np.cumsum(weights[order])
    return float(values[order[np.searchsorted(below, below[-1] / 2)]])


def _difference(times: Floats, others: Floats, cycle_length: float | None) -> Floats:
    if cycle_length is None:
        return times - others
    return circular_difference(times, others, cycle_length)


def _speed(slow: float) -> float:
    return 1 / max(slow, _SLOWEST_TOLD)


def _at_vertices(part: Mesh, slow: Floats) -> PerVertex:
    """Velocity at the vertices, from the mean slowness of the triangles round them."""
    corners = part.faces.reshape(-1)
    weights = np.repeat(part.face_areas, 3)
    total = np.bincount(corners, weights, minlength=part.n_vertices)
    sums = np.bincount(corners, weights * np.repeat(slow, 3), minlength=part.n_vertices)
    means = np.divide(sums, total, out=np.full(len(total), np.nan), where=total > 0)
    speeds: PerVertex = 1 / np.maximum(means, _SLOWEST_TOLD)
    return speeds
