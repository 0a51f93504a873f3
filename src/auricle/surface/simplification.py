"""Simplification: the same surface with fewer vertices, to the vertex.

Quadric edge collapse (Garland and Heckbert, *Surface simplification using quadric error
metrics*, SIGGRAPH 1997), in the space of positions and fields (the same, Visualization 1998),
with the vertices placed so that the enclosed volume stays the same (Lindstrom and Turk,
Visualization 1998).
"""

from collections.abc import Sequence

import numpy as np

from auricle.errors import SurfaceError
from auricle.surface.collapse import collapse_edges
from auricle.surface.collapse_sequence import FEWEST_VERTICES, CollapseSequence
from auricle.surface.feature_scaling import feature_lengths, feature_scale
from auricle.surface.field import FieldMap
from auricle.surface.halfedges import HalfEdges, boundary_corners, half_edges
from auricle.surface.mesh import Mesh
from auricle.surface.quadric import vertex_quadrics
from auricle.surface.soundness import require_sound, soundness

BOUNDARY_WEIGHT = 10.0
"""Weight of a boundary edge's squared length beside the faces' areas."""
EVENNESS = 1e-7
"""Weight of the distance from the points a vertex stands for beside that from their faces."""


def simplify(mesh: Mesh, n_vertices: int) -> Mesh:
    """Thin a surface out to exactly `n_vertices` vertices, each step the least quadric error.

    Parameters
    ----------
    mesh
        One manifold, oriented piece, with or without holes.
    n_vertices
        How many vertices to leave; with as many or more than there are, the mesh itself comes
        back.

    Returns
    -------
    Mesh
        As many pieces, holes and handles as before, oriented as before. If closed, of the same
        volume to rounding, unless so coarse that a vertex would have to move by half an edge for
        it. No face is a sliver of quality below 0.1 unless one as bad was there, or no other edge
        was left. Vertices are new, also along the holes: carry fields over with `transfer`, or use
        `simplify_with_fields`. Renumbering the vertices of `mesh` renumbers the result and changes
        it by no more than rounding, unless edges cost the same: their order follows the numbering.

    Raises
    ------
    InputError
        If fewer than 4 vertices are asked for.
    SurfaceError
        If the mesh is not one manifold, oriented piece, or no edge is left that can collapse
        without changing the topology or folding the surface.

    Examples
    --------
    >>> from auricle.surface.shapes import torus
    >>> from auricle.surface.topology import euler_number
    >>> ring = torus(major=20.0, minor=8.0, n_major=40, n_minor=20)
    >>> coarse = simplify(ring, 123)
    >>> coarse.n_vertices, euler_number(coarse.faces)
    (123, 0)
    """
    return _sequence(mesh, (), 1.0, n_vertices).mesh_at(n_vertices)


def simplify_with_fields(
    mesh: Mesh, fields: Sequence[FieldMap], n_vertices: int, *, weight: float = 1.0
) -> tuple[Mesh, tuple[FieldMap, ...]]:
    """Thin out a surface and fields on it together, so that vertices stay where the fields change.

    Parameters
    ----------
    mesh
        As `simplify` takes it.
    fields
        On `mesh`; where one is not sampled (NaN) it counts as its nearest sample.
    n_vertices
        How many vertices to leave.
    weight
        How many mm one standard deviation of a field counts for (`feature_scale`).

    Returns
    -------
    mesh
        As `simplify` returns it.
    fields
        On that mesh, name and unit kept; NaN at vertices of which less than half was sampled.

    Raises
    ------
    InputError
        If fewer than 4 vertices are asked for, the weight is not positive, or a field lives on
        another mesh.
    SurfaceError
        As `simplify`.
    """
    sequence = _sequence(mesh, tuple(fields), weight, n_vertices)
    carried = sequence.fields_at(n_vertices)
    return (carried[0].mesh if carried else sequence.mesh_at(n_vertices)), carried


def simplification_sequence(
    mesh: Mesh, *, fields: Sequence[FieldMap] = (), weight: float = 1.0
) -> CollapseSequence:
    """Thin a surface out as far as it goes, and remember every level on the way.

    Every level is the surface that `simplify`, or `simplify_with_fields`, gives for its number
    of vertices, to the last digit.

    Raises
    ------
    InputError, SurfaceError
        As `simplify_with_fields`.

    Examples
    --------
    >>> from auricle.surface.shapes import icosphere
    >>> sequence = simplification_sequence(icosphere(radius=30.0, subdivisions=3))
    >>> sequence.n_least, sequence.mesh_at(100).n_vertices
    (4, 100)
    """
    return _sequence(mesh, tuple(fields), weight, FEWEST_VERTICES - 1)


def _sequence(
    mesh: Mesh, fields: tuple[FieldMap, ...], weight: float, n_vertices: int
) -> CollapseSequence:
    """Collapse down to `n_vertices`, or as far as it goes."""
    scales = tuple(feature_scale(field, weight) for field in fields)
    places = np.concatenate([mesh.vertices, feature_lengths(mesh, fields, scales)], axis=1)
    links = _links(mesh)
    quadrics = vertex_quadrics(
        places,
        mesh.faces.copy(),
        boundary_corners(links),
        boundary_weight=BOUNDARY_WEIGHT,
        evenness=EVENNESS,
    )
    area = float(quadrics.points[:, 0].sum()) / EVENNESS
    found = collapse_edges(links, quadrics, n_collapses=max(mesh.n_vertices - n_vertices, 0))
    squares = np.maximum(np.cumsum(np.concatenate([[0.0], found.growth])), 0.0)
    errors = np.sqrt(squares / area) if area > 0.0 else squares
    return CollapseSequence(mesh, fields, scales, found.kept, found.gone, found.places, errors)


def _links(mesh: Mesh) -> HalfEdges:
    try:
        return half_edges(mesh.faces, mesh.n_vertices)
    except SurfaceError:
        require_sound(soundness(mesh))
        raise
