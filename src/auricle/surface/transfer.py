"""Transfer of fields: from one mesh to another of the same surface, by the nearest point."""

import igl
import numpy as np

from auricle.arrays import Floats, Integers, PerVertex, Points
from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh

SMALLEST_KNOWN_WEIGHT = 0.5
FLAT = 1e-12
"""Area over squared length below which a triangle is treated as its longest edge."""


def barycentric_at(mesh: Mesh, points: Points) -> tuple[Integers, Floats, PerVertex]:
    """Where on the surface the points are nearest.

    Returns
    -------
    faces
        The face that holds the nearest point, shape (p,).
    weights
        Barycentric weights of its corners there, shape (p, 3), not negative, of sum 1.
    distances
        Distance to it, shape (p,), mm.

    Examples
    --------
    >>> triangle = Mesh([[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
    >>> _, weights, distances = barycentric_at(triangle, np.array([[1.0, 2.0, 5.0]]))
    >>> weights.tolist(), distances.tolist()
    ([[0.25, 0.25, 0.5]], [5.0])
    """
    squared, faces, nearest = igl.point_mesh_squared_distance(
        np.ascontiguousarray(points), mesh.vertices, mesh.faces
    )
    return faces, _weights(nearest, mesh.vertices[mesh.faces[faces]]), np.sqrt(squared)


def transfer(field: FieldMap, target: Mesh) -> FieldMap:
    """Carry a field over to another mesh of the same surface.

    Each vertex of the target takes the barycentric mean at the nearest point of the field's
    surface. A corner without a value (NaN) is left out of the mean as long as the others hold at
    least half of the weight; otherwise the vertex has no value either.

    Parameters
    ----------
    field
        Values at the vertices of the source, shape (n,) or (n, c).
    target
        The mesh to carry them to.

    Returns
    -------
    FieldMap
        On `target`, name and unit kept. On the source's own vertices: the same values.
    """
    faces, weights, _ = barycentric_at(field.mesh, target.vertices)
    values = field.values.reshape(field.mesh.n_vertices, -1)[field.mesh.faces[faces]]
    known = np.isfinite(values)
    weights_known = weights[:, :, None] * known
    total = weights_known.sum(axis=1)
    enough = total >= SMALLEST_KNOWN_WEIGHT - FLAT
    sums = (weights_known * np.where(known, values, 0.0)).sum(axis=1)
    means = np.full(sums.shape, np.nan)
    np.divide(sums, total, out=means, where=enough)
    return FieldMap(
        target, means.reshape(target.n_vertices, *field.values.shape[1:]), field.name, field.unit
    )


def _weights(nearest: Points, corners: Floats) -> Floats:
    """Weights of points that lie in their triangles, from the areas opposite each corner."""
    spokes = corners - nearest[:, None]
    opposite = np.cross(np.roll(spokes, -1, axis=1), np.roll(spokes, -2, axis=1))
    areas = np.linalg.norm(opposite, axis=2)
    total = areas.sum(axis=1, keepdims=True)
    edges = np.roll(corners, -1, axis=1) - corners
    squares = (edges**2).sum(axis=2)
    flat = total[:, 0] <= FLAT * squares.max(axis=1)
    weights: Floats = np.empty_like(areas)
    np.divide(areas, total, out=weights, where=~flat[:, None])
    weights[flat] = _weights_on_longest_edge(spokes[flat], edges[flat], squares[flat])
    return weights


def _weights_on_longest_edge(spokes: Floats, edges: Floats, squares: Floats) -> Floats:
    rows = np.arange(len(spokes))
    longest = squares.argmax(axis=1)
    along = -np.einsum("pi,pi->p", spokes[rows, longest], edges[rows, longest])
    length = np.maximum(squares[rows, longest], np.finfo(float).tiny)
    share = np.clip(along / length, 0.0, 1.0)
    weights = np.zeros((len(spokes), 3))
    weights[rows, longest] = 1.0 - share
    weights[rows, (longest + 1) % 3] = share
    return weights
