"""Distance between surfaces: from points to the nearest point of a surface, exactly."""

from dataclasses import dataclass

import igl
import numpy as np
from scipy.spatial import cKDTree

from auricle.arrays import PerVertex, Points
from auricle.errors import InputError
from auricle.surface.mesh import Mesh
from auricle.surface.soundness import vertex_areas


@dataclass(frozen=True)
class GeometricDistance:
    """How far one surface lies from another, mm.

    Attributes
    ----------
    mean
        Mean distance, weighted by vertex area.
    rms
        Root of the mean square distance, weighted by vertex area.
    percentile_95
        Smallest distance within which vertices of at least 95 % of the area lie.
    hausdorff
        Largest distance.
    """

    mean: float
    rms: float
    percentile_95: float
    hausdorff: float


def point_to_surface(points: Points, mesh: Mesh) -> PerVertex:
    """Distance from each point to the nearest point of the surface, shape (n,), mm.

    The nearest point may lie on a face, an edge or a vertex; the search is exact.

    Examples
    --------
    >>> from auricle.surface.shapes import rectangle
    >>> plate = rectangle(width=10, height=10, n_x=3, n_y=3)
    >>> point_to_surface(np.array([[4.0, 3.0, 2.0], [13.0, 14.0, 0.0]]), plate).tolist()
    [2.0, 5.0]
    """
    squared, _, _ = igl.point_mesh_squared_distance(
        np.ascontiguousarray(points), mesh.vertices, mesh.faces
    )
    distances: PerVertex = np.sqrt(squared)
    return distances


def geometric_distance(
    mesh: Mesh, reference: Mesh, *, symmetric: bool = False
) -> GeometricDistance:
    """Distance from the vertices of `mesh` to the surface `reference`.

    d(p_i, S) = min over the points s of S of ‖p_i - s‖, one-sided unless `symmetric`.

    Parameters
    ----------
    mesh
        Its vertices are measured, each weighted by its area.
    reference
        Distances are to anywhere on this surface.
    symmetric
        Measure from `reference` to `mesh` as well: the mean of the two means, the root of the
        mean of the two mean squares, and the larger of the two percentiles and maxima.

    Examples
    --------
    >>> from auricle.surface.shapes import icosphere
    >>> inner, outer = (icosphere(radius=r, subdivisions=4) for r in (10.0, 12.0))
    >>> bool(abs(geometric_distance(inner, outer).mean - 2.0) < 0.03)
    True
    """
    there = _one_sided(mesh, reference)
    if not symmetric:
        return there
    back = _one_sided(reference, mesh)
    return GeometricDistance(
        mean=(there.mean + back.mean) / 2,
        rms=float(np.sqrt((there.rms**2 + back.rms**2) / 2)),
        percentile_95=max(there.percentile_95, back.percentile_95),
        hausdorff=max(there.hausdorff, back.hausdorff),
    )


def vertexwise_mean_square(positions: Points, others: Points) -> float:
    """Mean of ‖positions_i - others_i‖², mm², each vertex against the one of its own number.

    For two shapes of one connectivity: a surface and its reconstruction from few harmonics. One
    reading of the paper's "mean square error (MSE)", which it does not define.

    Raises
    ------
    InputError
        If the shapes do not agree.

    Examples
    --------
    >>> vertexwise_mean_square(np.zeros((2, 3)), np.array([[3.0, 0, 0], [0, 5, 0]]))
    17.0
    """
    if positions.shape != others.shape or not len(positions):
        raise InputError(
            f"positions {positions.shape} and {others.shape} do not belong together: "
            "give one row each a vertex"
        )
    return float(((positions - others) ** 2).sum(axis=1).mean())


def nearest_vertex_mean_square(points: Points, vertices: Points) -> float:
    """Mean squared distance from each point to the nearest of the vertices, mm².

    For shapes of different connectivity, a surface and a simplified one. The other reading of
    the paper's MSE: "GD operates with a local distance to the mesh, whereas MSE operates with
    the distance to the nearest point". Never below the mean square distance to the surface.

    Examples
    --------
    >>> nearest_vertex_mean_square(np.array([[2.0, 0, 0], [10.0, 4, 0]]), np.diag([10.0, 0, 0]))
    10.0
    """
    distances = np.asarray(cKDTree(vertices).query(points)[0])
    return float(np.mean(distances**2))


def vertexwise_rms(positions: Points, others: Points, areas: PerVertex) -> float:
    """Root of the area-weighted mean of ‖positions_i - others_i‖², mm.

    For two shapes of one connectivity: a surface and its reconstruction from few harmonics.

    Raises
    ------
    InputError
        If the shapes do not agree.

    Examples
    --------
    >>> vertexwise_rms(np.zeros((2, 3)), np.array([[3.0, 0, 0], [0, 5, 0]]), np.array([3.0, 1.0]))
    3.605551275463989
    """
    if positions.shape != others.shape or areas.shape != positions.shape[:1]:
        raise InputError(
            f"positions {positions.shape}, {others.shape} and areas {areas.shape} do not belong "
            "together: give one row each a vertex"
        )
    squared = ((positions - others) ** 2).sum(axis=1)
    return float(np.sqrt(np.average(squared, weights=areas)))


def _one_sided(mesh: Mesh, reference: Mesh) -> GeometricDistance:
    distances = point_to_surface(mesh.vertices, reference)
    areas = vertex_areas(mesh)
    order = np.argsort(distances)
    covered = np.cumsum(areas[order])
    within_95 = order[np.searchsorted(covered, 0.95 * covered[-1])]
    return GeometricDistance(
        mean=float(np.average(distances, weights=areas)),
        rms=float(np.sqrt(np.average(distances**2, weights=areas))),
        percentile_95=float(distances[within_95]),
        hausdorff=float(distances.max()),
    )
