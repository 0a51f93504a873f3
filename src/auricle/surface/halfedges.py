"""Half-edges: the connectivity of a manifold, kept up while edges collapse.

Half-edge 3f + c runs from corner c of face f to the next corner. Around a vertex, half-edges that
leave it follow one another counter-clockwise; at a boundary vertex the first of them is the one
with no face on its right.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from auricle.arrays import Faces
from auricle.compiled import compiled
from auricle.errors import SurfaceError

Indices = NDArray[np.int32]
"""What is wanted all over a table at random is fetched faster in 32 bits."""

NONE = -1
ORIGIN, OPPOSITE, EDGE = 0, 1, 2
SIDE, WAITS = 0, 1
START, MARK, WAITING = 0, 1, 2


class HalfEdges(NamedTuple):
    """Connectivity in three tables, which the functions below change in place.

    Attributes
    ----------
    half_edges
        Shape (3f, 3). ``ORIGIN``: the vertex each one leaves, -1 once its face is gone;
        ``OPPOSITE``: the one that runs the other way, -1 at a boundary; ``EDGE``: where it lies.
    edges
        Shape (e, 2). ``SIDE``: a half-edge of each, -1 once the edge is gone; ``WAITS``: 0, for
        those who work with the edges.
    vertices
        Shape (n, 3). ``START``: a half-edge that leaves each, the first one at a boundary;
        ``MARK`` and ``WAITING``: 0, for those who work with the vertices.
    """

    half_edges: Indices
    edges: Indices
    vertices: Indices


def half_edges(faces: Faces, n_vertices: int) -> HalfEdges:
    """Work out the connectivity of faces.

    Raises
    ------
    SurfaceError
        If the faces are not one oriented manifold piece that uses every vertex.

    Examples
    --------
    >>> links = half_edges(np.array([[0, 1, 2], [2, 1, 3]]), 4)
    >>> links.half_edges[:, OPPOSITE].tolist()
    [-1, 3, -1, 1, -1, -1]
    """
    table = np.full((faces.size, 3), NONE, dtype=np.int32)
    table[:, ORIGIN] = faces.ravel()
    vertices = np.zeros((n_vertices, 3), dtype=np.int32)
    if not _linked(table, vertices):
        raise SurfaceError("the faces are not one oriented manifold: clean the surface")
    return HalfEdges(table, _numbered(table), vertices)


def remaining_faces(links: HalfEdges) -> Faces:
    """Faces that are still there, shape (f, 3), in their old order."""
    corners = links.half_edges[:, ORIGIN].reshape(-1, 3)
    faces: Faces = corners[corners[:, 0] != NONE].astype(np.int64)
    return faces


def boundary_corners(links: HalfEdges) -> Faces:
    """List the ends of boundary edges as their faces run, and the corner opposite, (b, 3)."""
    boundary = np.flatnonzero(links.half_edges[:, OPPOSITE] == NONE)
    turns = np.arange(3)
    sides = boundary[:, None] - boundary[:, None] % 3 + (boundary[:, None] + turns) % 3
    corners: Faces = links.half_edges[sides, ORIGIN].astype(np.int64)
    return corners


@compiled
def following(half_edge: int) -> int:
    """Next half-edge of the same face."""
    return half_edge - 2 if half_edge % 3 == 2 else half_edge + 1


@compiled
def preceding(half_edge: int) -> int:
    """Half-edge before this one in the same face."""
    return half_edge + 2 if half_edge % 3 == 0 else half_edge - 1


@compiled
def neighbours(half_edges: Indices, first: int, ring: Indices) -> int:
    """Put the neighbours of a vertex into `ring`, and count the faces around it.

    The half-edge `first` is the vertex's start; neighbours come counter-clockwise. There is one
    more than faces: the last face lies between the last two. Inside the surface the last
    neighbour is the first one again.
    """
    half_edge = first
    ring[0] = half_edges[following(first), ORIGIN]
    count = 0
    while True:
        before = preceding(half_edge)
        count += 1
        ring[count] = half_edges[before, ORIGIN]
        half_edge = half_edges[before, OPPOSITE]
        if half_edge < 0 or half_edge == first:
            return count


@compiled
def merge(half_edges: Indices, edges: Indices, vertices: Indices, half_edge: int) -> None:
    """Collapse the edge of `half_edge` into its origin; the vertex at its other end is gone.

    The edge must meet the link condition.
    """
    other = half_edges[half_edge, OPPOSITE]
    kept, gone = half_edges[half_edge, ORIGIN], half_edges[following(half_edge), ORIGIN]
    _rename(half_edges, vertices[gone, START], kept)
    edges[half_edges[half_edge, EDGE], SIDE] = NONE
    inner = _close(half_edges, edges, vertices, half_edge)
    if other != NONE:
        across = _close(half_edges, edges, vertices, other)
        inner = inner if inner != NONE else across
    vertices[kept, START] = _first_around(half_edges, inner)


@compiled
def _rename(half_edges: Indices, first: int, name: int) -> None:
    """Let the half-edges that leave the vertex of `first` leave another one."""
    half_edge = first
    while True:
        half_edges[half_edge, ORIGIN] = name
        half_edge = half_edges[preceding(half_edge), OPPOSITE]
        if half_edge < 0 or half_edge == first:
            return


@compiled
def _close(half_edges: Indices, edges: Indices, vertices: Indices, half_edge: int) -> int:
    """Remove the face of a collapsed half-edge; return a half-edge that leaves the kept vertex.

    The other two sides of the face become one edge: their opposites face one another.
    """
    after, before = following(half_edge), preceding(half_edge)
    into, out = half_edges[after, OPPOSITE], half_edges[before, OPPOSITE]
    apex, edge = half_edges[before, ORIGIN], half_edges[before, EDGE]
    edges[half_edges[after, EDGE], SIDE] = NONE
    if into != NONE:
        half_edges[into, OPPOSITE] = out
        half_edges[into, EDGE] = edge
        edges[edge, SIDE] = into
    if out != NONE:
        half_edges[out, OPPOSITE] = into
        half_edges[out, EDGE] = edge
        edges[edge, SIDE] = out
    half_edges[half_edge, ORIGIN] = NONE
    half_edges[after, ORIGIN] = NONE
    half_edges[before, ORIGIN] = NONE
    if vertices[apex, START] == before:
        vertices[apex, START] = into
    return out if out != NONE else following(into)


@compiled
def _first_around(half_edges: Indices, half_edge: int) -> int:
    """Turn clockwise around the origin of `half_edge`, to the boundary or all around."""
    first = half_edge
    while True:
        before = half_edges[first, OPPOSITE]
        if before == NONE:
            return first
        first = following(before)
        if first == half_edge:
            return first


@compiled
def _linked(half_edges: Indices, vertices: Indices) -> bool:
    """Fill in opposites and starts; whether the faces are one oriented manifold piece."""
    offset, leaving, tips = _grouped(half_edges, len(vertices))
    if not _find_opposites(half_edges, offset, leaving, tips):
        return False
    for vertex in range(len(vertices)):
        n_leaving = offset[vertex + 1] - offset[vertex]
        if n_leaving == 0:
            return False
        start = leaving[offset[vertex]]
        for half_edge in leaving[offset[vertex] : offset[vertex + 1]]:
            if half_edges[half_edge, OPPOSITE] == NONE:
                start = half_edge
        vertices[vertex, START] = start
        is_folded = n_leaving == 2 and half_edges[start, OPPOSITE] != NONE  # a face and its back
        if is_folded or _ring_size(half_edges, start) != n_leaving:
            return False
    return _is_one_piece(half_edges)


@compiled
def _grouped(half_edges: Indices, n_vertices: int) -> tuple[Indices, Indices, Indices]:
    """Where each vertex's half-edges begin in the two lists that follow: by origin, their tips."""
    offset = np.zeros(n_vertices + 1, dtype=np.int32)
    for half_edge in range(len(half_edges)):
        offset[half_edges[half_edge, ORIGIN] + 1] += 1
    offset = np.cumsum(offset)
    free = offset[:-1].copy()
    leaving = np.empty(len(half_edges), dtype=np.int32)
    tips = np.empty(len(half_edges), dtype=np.int32)
    for half_edge in range(len(half_edges)):
        vertex = half_edges[half_edge, ORIGIN]
        leaving[free[vertex]] = half_edge
        tips[free[vertex]] = half_edges[following(half_edge), ORIGIN]
        free[vertex] += 1
    return offset, leaving, tips


@compiled
def _find_opposites(half_edges: Indices, offset: Indices, leaving: Indices, tips: Indices) -> bool:
    """Find what faces each half-edge; whether no more than one does.

    Half-edges that run the same way where nothing faces them are left to the count of the ring.
    """
    is_sound = True
    for vertex in range(len(offset) - 1):
        for place in range(offset[vertex], offset[vertex + 1]):
            n_facing = 0
            for other in range(offset[tips[place]], offset[tips[place] + 1]):
                if tips[other] == vertex:
                    half_edges[leaving[place], OPPOSITE] = leaving[other]
                    n_facing += 1
            is_sound &= n_facing <= 1
    return is_sound


@compiled
def _ring_size(half_edges: Indices, first: int) -> int:
    """Count the half-edges around the vertex that `first` leaves, counter-clockwise from it."""
    count = 1
    half_edge = half_edges[preceding(first), OPPOSITE]
    while half_edge != NONE and half_edge != first:
        count += 1
        half_edge = half_edges[preceding(half_edge), OPPOSITE]
    return count


@compiled
def _is_one_piece(half_edges: Indices) -> bool:
    """Whether a walk over edges from the first face reaches all."""
    n_faces = len(half_edges) // 3
    reached = np.zeros(n_faces, dtype=np.bool_)
    found = np.empty(n_faces, dtype=np.int32)
    reached[0], found[0], n_found = True, 0, 1
    n_left = 0
    while n_left < n_found:
        for half_edge in range(3 * found[n_left], 3 * found[n_left] + 3):
            face = half_edges[half_edge, OPPOSITE] // 3  # -1 stays -1
            if face >= 0 and not reached[face]:
                reached[face] = True
                found[n_found] = face
                n_found += 1
        n_left += 1
    return n_found == n_faces


@compiled
def _numbered(half_edges: Indices) -> Indices:
    """Fill in the edge of each half-edge; return the table of edges."""
    edges = np.zeros((len(half_edges), 2), dtype=np.int32)
    n_edges = 0
    for half_edge in range(len(half_edges)):
        if NONE < half_edges[half_edge, OPPOSITE] < half_edge:
            half_edges[half_edge, EDGE] = half_edges[half_edges[half_edge, OPPOSITE], EDGE]
        else:
            half_edges[half_edge, EDGE] = n_edges
            edges[n_edges, SIDE] = half_edge
            n_edges += 1
    return edges[:n_edges].copy()
