"""How far k harmonics, and k points, stay from a surface: the two ways to be brief about it."""

from dataclasses import dataclass

import numpy as np

from auricle.progress import Progress, silent
from auricle.surface.collapse_sequence import CollapseSequence
from auricle.surface.distance import point_to_surface
from auricle.surface.mesh import Mesh
from auricle.surface.soundness import vertex_areas
from auricle.viewer.shown_signal import ShownSignal

COUNTS = (5, 10, 20, 35, 50, 75, 100, 150, 250, 350, 500)
"""Numbers of harmonics and of points at which the distance is measured, and at the last one."""


@dataclass(frozen=True)
class MeasuredDistance:
    """Mean distance from the surface to an approximation of it.

    Attributes
    ----------
    count
        Harmonics or points of the approximation.
    gd_mm
        Mean over the surface's area of the distance to the nearest point of the approximation, mm.
    """

    count: int
    gd_mm: float


def mean_distance(surface: Mesh, approximation: Mesh) -> float:
    """Mean over the area of `surface` of the distance to `approximation`, mm.

    Examples
    --------
    >>> from auricle.surface.shapes import icosphere
    >>> outer, inner = (icosphere(radius=r, subdivisions=4) for r in (12.0, 10.0))
    >>> round(mean_distance(outer, inner), 1)
    2.0
    """
    distances = point_to_surface(surface.vertices, approximation)
    return float(np.average(distances, weights=vertex_areas(surface)))


def harmonic_distances(
    surface: Mesh, geometry: ShownSignal, *, progress: Progress = silent
) -> tuple[MeasuredDistance, ...]:
    """Distance from a surface to what its first harmonics make of it, at each of `COUNTS`.

    Parameters
    ----------
    surface
        The original.
    geometry
        Its positions as a signal.
    progress
        Told how many are measured.
    """
    counts = _counts(COUNTS[0], geometry.n_modes)
    found = []
    for place, count in enumerate(counts):
        progress("distances", place, len(counts))
        level = Mesh(geometry.rebuilt(count), surface.faces)
        found.append(MeasuredDistance(count, mean_distance(surface, level)))
    return tuple(found)


def point_distances(
    sequence: CollapseSequence, *, most: int, progress: Progress = silent
) -> tuple[MeasuredDistance, ...]:
    """Distance from a surface to its simplification, at each of `COUNTS` there is a level of.

    Parameters
    ----------
    sequence
        The surface at every number of points.
    most
        Largest number of points of interest.
    progress
        Told how many are measured.
    """
    counts = _counts(sequence.n_least, min(most, sequence.mesh.n_vertices))
    found = []
    for place, count in enumerate(counts):
        progress("distances", place, len(counts))
        found.append(MeasuredDistance(count, mean_distance(sequence.mesh, sequence.mesh_at(count))))
    return tuple(found)


def _counts(least: int, most: int) -> list[int]:
    return [count for count in COUNTS if least <= count < most] + [most] * (least <= most)
