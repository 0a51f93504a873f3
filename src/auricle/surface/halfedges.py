"""Half-edges: the connectivity of a manifold, kept up while edges collapse.

Edge e has two half-edges, 2e and 2e + 1, which run opposite ways: from one end of it to the other
and back. Each belongs to the face on its left; at a boundary one of the two has none. Around a
vertex, half-edges that leave it follow one another counter-clockwise; at a boundary vertex the
first of them is the one with no face on its right, and the last has none on its left.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from auricle.arrays import Faces
from auricle.compiled import compiled, compiled_in_place
from auricle.errors import SurfaceError

Indices = NDArray[np.int32]
"""What is wanted all over a table at random is fetched faster in 32 bits."""

NONE = -1
ORIGIN, AFTER, BEFORE, WAITS = 0, 1, 2, 3


class HalfEdges(NamedTuple):
    """Connectivity in two tables, which the functions below change in place.

    Attributes
    ----------
    half_edges
        Shape (2e, 4), so that both of an edge come from memory at once. ``ORIGIN``: the vertex
        each one leaves, -1 once its edge is gone; ``AFTER`` and ``BEFORE``: the next and the last
        one around its face, -1 where it has none; ``WAITS``: 0, for those who work with the edges.
    starts
        Shape (n,): a half-edge that leaves each vertex, the first one at a boundary.
    """

    half_edges: Indices
    starts: Indices


def half_edges(faces: Faces, n_vertices: int) -> HalfEdges:
    """Work out the connectivity of faces.

    Edges are numbered as they come up along the faces; the first half-edge of each is the one
    that came up.

    Raises
    ------
    SurfaceError
        If the faces are not one oriented manifold piece that uses every vertex.

    Examples
    --------
    >>> links = half_edges(np.array([[0, 1, 2], [2, 1, 3]]), 4)
    >>> links.half_edges[:4, ORIGIN].tolist(), links.half_edges[:4, AFTER].tolist()
    ([0, 1, 1, 2], [2, -1, 4, 6])
    """
    origins = faces.astype(np.int32).ravel()
    opposite = np.full(len(origins), NONE, dtype=np.int32)
    starts = np.empty(n_vertices, dtype=np.int32)
    if not _linked(origins, opposite, starts):
        raise SurfaceError("the faces are not one oriented manifold: clean the surface")
    n_edges = (len(origins) + int(np.count_nonzero(opposite == NONE))) // 2
    table = np.full((2 * n_edges, 4), NONE, dtype=np.int32)
    _fill(table, starts, origins, opposite)
    return HalfEdges(table, starts)


def boundary_corners(links: HalfEdges) -> Faces:
    """List the ends of boundary edges as their faces run, and the corner opposite, (b, 3)."""
    table = links.half_edges
    outside = np.flatnonzero(table[:, AFTER] == NONE)
    inside = outside ^ 1
    ends = (table[inside, ORIGIN], table[outside, ORIGIN], table[table[inside, BEFORE], ORIGIN])
    corners: Faces = np.column_stack(ends).astype(np.int64)
    return corners


@compiled_in_place
def neighbours(half_edges: Indices, first: int, ring: Indices) -> int:
    """Put the neighbours of a vertex into `ring`, and count the faces around it.

    The half-edge `first` is the vertex's start; neighbours come counter-clockwise. There is one
    more than faces: the last face lies between the last two. Inside the surface the last
    neighbour is the first one again.
    """
    ring[0] = half_edges[first ^ 1, ORIGIN]
    before, count = half_edges[first, BEFORE], 0
    while True:
        count += 1
        ring[count] = half_edges[before, ORIGIN]
        half_edge = before ^ 1
        before = half_edges[half_edge, BEFORE]
        if before == NONE or half_edge == first:
            return count


@compiled_in_place
def merge(half_edges: Indices, starts: Indices, half_edge: int) -> None:
    """Collapse the edge of `half_edge` into its origin; the vertex at its other end is gone.

    The half-edge must have a face, and the edge meet the link condition.
    """
    other = half_edge ^ 1
    kept, gone = half_edges[half_edge, ORIGIN], half_edges[other, ORIGIN]
    is_inside = half_edges[starts[kept] ^ 1, AFTER] != NONE
    is_inside &= half_edges[starts[gone] ^ 1, AFTER] != NONE
    _rename(half_edges, starts[gone], kept)
    inner = _close(half_edges, starts, half_edge)
    if half_edges[other, AFTER] != NONE:
        _close(half_edges, starts, other)
    half_edges[half_edge, ORIGIN] = NONE
    half_edges[other, ORIGIN] = NONE
    starts[kept] = inner if is_inside else _first_around(half_edges, inner)


@compiled_in_place
def flip(half_edges: Indices, half_edge: int) -> None:
    """Let an edge join the other two corners of the faces beside it, both of which it must have.

    It turns clockwise. The starts of the two vertices that it leaves are not kept up.
    """
    other = half_edge ^ 1
    after, before = half_edges[half_edge, AFTER], half_edges[half_edge, BEFORE]
    after_other, before_other = half_edges[other, AFTER], half_edges[other, BEFORE]
    half_edges[half_edge, ORIGIN] = half_edges[before_other, ORIGIN]
    half_edges[other, ORIGIN] = half_edges[before, ORIGIN]
    _surround(half_edges, half_edge, before, after_other)
    _surround(half_edges, other, before_other, after)


@compiled_in_place
def _surround(half_edges: Indices, first: int, second: int, third: int) -> None:
    """Let three half-edges follow one another around a face."""
    half_edges[first, AFTER], half_edges[second, AFTER] = second, third
    half_edges[third, AFTER], half_edges[first, BEFORE] = first, third
    half_edges[second, BEFORE], half_edges[third, BEFORE] = first, second


@compiled_in_place
def _rename(half_edges: Indices, first: int, name: int) -> None:
    """Let the half-edges that leave the vertex of `first` leave another one."""
    half_edge = first
    while True:
        half_edges[half_edge, ORIGIN] = name
        if half_edges[half_edge, BEFORE] == NONE:
            return
        half_edge = half_edges[half_edge, BEFORE] ^ 1
        if half_edge == first:
            return


@compiled_in_place
def _close(half_edges: Indices, starts: Indices, half_edge: int) -> int:
    """Remove the face of a collapsed half-edge; return one that leaves the vertex it came from.

    The other two sides of the face become one edge: that of the side before stays, and takes the
    place of the other's outer half-edge.
    """
    before = half_edges[half_edge, BEFORE]
    inner = half_edges[half_edge, AFTER]
    outer = inner ^ 1
    after_outer, before_outer = half_edges[outer, AFTER], half_edges[outer, BEFORE]
    half_edges[before, AFTER] = after_outer
    half_edges[before, BEFORE] = before_outer
    if after_outer != NONE:
        half_edges[after_outer, BEFORE] = before
        half_edges[before_outer, AFTER] = before
    apex = half_edges[before, ORIGIN]
    if starts[apex] == outer:
        starts[apex] = before
    half_edges[inner, ORIGIN] = NONE
    half_edges[outer, ORIGIN] = NONE
    return int(before ^ 1)


@compiled_in_place
def _first_around(half_edges: Indices, half_edge: int) -> int:
    """Turn clockwise around the origin of `half_edge`, to the boundary or all around."""
    first = half_edge
    while True:
        clockwise = int(half_edges[first ^ 1, AFTER])
        if clockwise == NONE:
            return first
        first = clockwise
        if first == half_edge:
            return first


@compiled_in_place
def _next_corner(corner: int) -> int:
    return corner - 2 if corner % 3 == 2 else corner + 1


@compiled_in_place
def _last_corner(corner: int) -> int:
    return corner + 2 if corner % 3 == 0 else corner - 1


@compiled
def _linked(origins: Indices, opposite: Indices, starts: Indices) -> bool:
    """Find what faces the side that follows each corner, and a corner to start from at each vertex.

    Whether the faces are one oriented manifold piece.
    """
    offset, leaving, tips = _grouped(origins, len(starts))
    if not _find_opposites(opposite, offset, leaving, tips):
        return False
    for vertex in range(len(starts)):
        n_leaving = offset[vertex + 1] - offset[vertex]
        if n_leaving == 0:
            return False
        start = leaving[offset[vertex]]
        for corner in leaving[offset[vertex] : offset[vertex + 1]]:
            if opposite[corner] == NONE:
                start = corner
        starts[vertex] = start
        is_folded = n_leaving == 2 and opposite[start] != NONE  # a face and its back
        if is_folded or _ring_size(opposite, start) != n_leaving:
            return False
    return _is_one_piece(opposite)


@compiled
def _grouped(origins: Indices, n_vertices: int) -> tuple[Indices, Indices, Indices]:
    """Sort corners by vertex: where each vertex begins, which corners, and what comes next."""
    offset = np.zeros(n_vertices + 1, dtype=np.int32)
    for origin in origins:
        offset[origin + 1] += 1
    offset = np.cumsum(offset).astype(np.int32)
    free = offset[:-1].copy()
    leaving = np.empty(len(origins), dtype=np.int32)
    tips = np.empty(len(origins), dtype=np.int32)
    for corner in range(len(origins)):
        vertex = origins[corner]
        leaving[free[vertex]] = corner
        tips[free[vertex]] = origins[_next_corner(corner)]
        free[vertex] += 1
    return offset, leaving, tips


@compiled_in_place
def _find_opposites(opposite: Indices, offset: Indices, leaving: Indices, tips: Indices) -> bool:
    """Find what faces each side; whether no more than one does.

    Sides that run the same way where nothing faces them are left to the count of the ring.
    """
    is_sound = True
    for vertex in range(len(offset) - 1):
        for place in range(offset[vertex], offset[vertex + 1]):
            n_facing = 0
            for other in range(offset[tips[place]], offset[tips[place] + 1]):
                if tips[other] == vertex:
                    opposite[leaving[place]] = leaving[other]
                    n_facing += 1
            is_sound &= n_facing <= 1
    return is_sound


@compiled_in_place
def _ring_size(opposite: Indices, first: int) -> int:
    """Count the corners at the vertex of `first`, counter-clockwise from it."""
    count = 1
    corner = opposite[_last_corner(first)]
    while corner != NONE and corner != first:
        count += 1
        corner = opposite[_last_corner(corner)]
    return count


@compiled
def _is_one_piece(opposite: Indices) -> bool:
    """Whether a walk over edges from the first face reaches all."""
    n_faces = len(opposite) // 3
    reached = np.zeros(n_faces, dtype=np.bool_)
    found = np.empty(n_faces, dtype=np.int32)
    reached[0], found[0], n_found = True, 0, 1
    n_left = 0
    while n_left < n_found:
        for corner in range(3 * found[n_left], 3 * found[n_left] + 3):
            face = opposite[corner] // 3  # -1 stays -1
            if face >= 0 and not reached[face]:
                reached[face] = True
                found[n_found] = face
                n_found += 1
        n_left += 1
    return n_found == n_faces


@compiled
def _fill(half_edges: Indices, starts: Indices, origins: Indices, opposite: Indices) -> None:
    """Fill in the table of half-edges, and let starts be half-edges instead of corners."""
    number = np.empty(len(origins), dtype=np.int32)
    n_numbered = 0
    for corner in range(len(origins)):
        if NONE < opposite[corner] < corner:
            number[corner] = number[opposite[corner]] ^ 1
        else:
            number[corner] = n_numbered
            n_numbered += 2
    for corner in range(len(origins)):
        half_edge, after = number[corner], _next_corner(corner)
        half_edges[half_edge, ORIGIN] = origins[corner]
        half_edges[half_edge ^ 1, ORIGIN] = origins[after]
        half_edges[half_edge, AFTER] = number[after]
        half_edges[half_edge, BEFORE] = number[_last_corner(corner)]
        half_edges[half_edge, WAITS] = 0
    for vertex in range(len(starts)):
        starts[vertex] = number[starts[vertex]]
