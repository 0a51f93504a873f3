"""Geodesic distances: how far apart two places are along the surface.

By the heat method (Crane, Weischedel and Wardetzky 2013) one factorisation serves any number of
sources in milliseconds each, but near a source its distances are blurred over an edge or two; by
exact propagation over the triangles (Mitchell, Mount and Papadimitriou 1987) they carry no error
but the mesh's own, at seconds a source, or much less for those within reach.
"""

import igl
import numpy as np
import potpourri3d
from numpy.typing import ArrayLike

from auricle.arrays import Faces, Integers, PerVertex, Points, Truths
from auricle.errors import InputError, SurfaceError
from auricle.surface.mesh import Mesh
from auricle.surface.soundness import triangle_quality
from auricle.surface.topology import pieces

POOREST_QUALITY = 1e-5
"""Shape quality (1: equilateral) below which exact distances are refused: at 1e-9 libigl hangs."""


class GeodesicDistances:
    """Distances by the heat method, from a factorisation that is kept.

    Parameters
    ----------
    mesh
        Any surface; holes and several pieces are allowed.

    Examples
    --------
    >>> from auricle.surface.shapes import icosphere
    >>> sphere = icosphere(radius=10.0, subdivisions=4)
    >>> far = GeodesicDistances(sphere).from_vertices([0]).max()  # half-way round: 10π
    >>> bool(abs(far / (10 * np.pi) - 1) < 0.02)
    True
    """

    def __init__(self, mesh: Mesh) -> None:
        self._mesh = mesh
        self._piece_of_face = pieces(mesh.faces)
        centred = mesh.vertices - mesh.vertices.mean(axis=0)
        self._solver = potpourri3d.MeshHeatMethodDistanceSolver(centred, mesh.faces.copy())

    def from_vertices(self, indices: ArrayLike) -> PerVertex:
        """Distance from each vertex to the nearest of some vertices, by one solve for each.

        One solve for all would be quicker and many times less accurate: its distances are off
        by different amounts at different sources.

        Parameters
        ----------
        indices
            Vertex indices of the sources, shape (m,).

        Returns
        -------
        PerVertex
            Shape (n,), mm; exactly 0 at the sources, infinite where no path leads.

        Raises
        ------
        InputError
            If there is no source or an index is out of range.
        """
        sources = _checked(indices, self._mesh.n_vertices)
        nearest = np.full(self._mesh.n_vertices, np.inf)
        for source in sources.tolist():
            np.minimum(nearest, self._from_vertex(source), out=nearest)
        return nearest

    def _from_vertex(self, source: int) -> PerVertex:
        faces = _around(self._mesh.faces, self._piece_of_face, source)
        computed = np.asarray(self._solver.compute_distance(source))
        distance = np.full(self._mesh.n_vertices, np.inf)
        distance[source] = 0.0
        distance[faces] = np.maximum(computed[faces] - computed[source], 0.0)
        return distance


def geodesic_distances(mesh: Mesh, sources: ArrayLike) -> PerVertex:
    """Distance from each vertex to the nearest source by the heat method, shape (n,), mm.

    As `GeodesicDistances` with one question; infinite where no path leads.

    Raises
    ------
    InputError
        If there is no source or an index is out of range.
    """
    return GeodesicDistances(mesh).from_vertices(sources)


def distances_from(mesh: Mesh, source: int, *, reach: float = np.inf) -> PerVertex:
    """Distances along the surface from one vertex: exact where the triangles allow it.

    Where a triangle is as good as degenerate the heat method takes over, which copes with it;
    it is off by a fraction of an edge length. Arguments, result and errors as those of
    `exact_geodesic_distances`.
    """
    if triangle_quality(mesh).min() > POOREST_QUALITY:
        return exact_geodesic_distances(mesh, source, reach=reach)
    distance = geodesic_distances(mesh, [source])
    return np.where(distance <= reach, distance, np.inf)


def exact_geodesic_distances(mesh: Mesh, source: int, *, reach: float = np.inf) -> PerVertex:
    """Length of the shortest path over the triangles from one vertex, for those within reach.

    Only the part of the mesh within `reach` as the crow flies is searched: a path that leaves
    it is longer than `reach`, so nothing is lost.

    Parameters
    ----------
    mesh
        A manifold surface; holes and several pieces are allowed.
    source
        Index of the vertex to start from.
    reach
        Distance up to which the answer matters, mm; the cost grows steeply with it.

    Returns
    -------
    PerVertex
        Shape (n,), mm; exact up to `reach`, infinite beyond it or where no path leads.

    Raises
    ------
    InputError
        If the index is out of range or the reach is not positive.
    SurfaceError
        If a triangle is as good as degenerate: the search for paths need not end there.

    Examples
    --------
    >>> from auricle.surface.shapes import cube
    >>> corners = exact_geodesic_distances(cube(side=1.0, n=1), 0)
    >>> bool(np.isclose(corners.max(), 5**0.5))  # the far corner, over two unfolded sides
    True
    """
    _checked([source], mesh.n_vertices)
    if not reach > 0:
        raise InputError(f"a reach of {reach} mm: give a positive distance")
    if triangle_quality(mesh).min() <= POOREST_QUALITY:
        raise SurfaceError("a triangle is degenerate: exact distances need triangles with area")
    offsets = mesh.vertices - mesh.vertices[source]
    faces = mesh.faces[_faces_within(offsets, mesh.faces, reach)]
    distance = np.full(mesh.n_vertices, np.inf)
    distance[source] = 0.0
    if (faces == source).any():
        patch, index = np.unique(_around(faces, pieces(faces), source), return_inverse=True)
        start = np.searchsorted(patch, [source])
        distance[patch] = _exact(offsets[patch], index.reshape(-1, 3), start)
    distance[distance > reach] = np.inf
    return distance


def _exact(vertices: Points, faces: Faces, source: Integers) -> PerVertex:
    none = np.empty(0, dtype=np.int64)
    everywhere = np.arange(len(vertices))
    distance: PerVertex = igl.exact_geodesic(vertices, faces, source, none, everywhere, none)
    return distance


def _around(faces: Faces, piece_of_face: Integers, source: int) -> Faces:
    """Faces of the piece, or pieces, that `source` lies on."""
    own = np.unique(piece_of_face[(faces == source).any(axis=1)])
    around: Faces = faces[np.isin(piece_of_face, own)]
    return around


def _faces_within(offsets: Points, faces: Faces, reach: float) -> Truths:
    """Mark every face that has a point within `reach` of the origin, and few others."""
    corners = offsets[faces]
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    nearest = np.linalg.norm(corners, axis=2).min(axis=1)
    within: Truths = nearest <= reach + edges.max(axis=1)
    return within


def _checked(indices: ArrayLike, n_vertices: int) -> Integers:
    sources = np.asarray(indices, dtype=np.int64)
    if sources.ndim != 1 or not len(sources):
        raise InputError(f"sources of shape {sources.shape}: give a list of at least one vertex")
    if sources.min() < 0 or sources.max() >= n_vertices:
        raise InputError(
            f"source vertices {sources.min()}…{sources.max()} of {n_vertices}: indices count from 0"
        )
    return sources
