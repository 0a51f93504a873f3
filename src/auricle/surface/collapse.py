"""Edge collapse: the cheapest edge of a surface made a vertex, again and again.

An edge's cost is the least sum of its ends' quadrics. Quadrics only grow, so a cost worked out
earlier is never too high: the queue keeps it until the edge comes first, and it is worked out anew
only then. This visits edges in the same order as keeping every cost up to date.

An edge refused (`auricle.surface.collapse_safety`) waits until a neighbour changes. Only when
every edge waits may faces turn, and only when that is not enough, thin.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from auricle.arrays import Floats, Integers
from auricle.compiled import compiled_in_place
from auricle.surface.collapse_safety import LIMITS, Rings, is_safe
from auricle.surface.halfedges import (
    AFTER,
    BEFORE,
    NONE,
    ORIGIN,
    WAITS,
    HalfEdges,
    Indices,
    merge,
    neighbours,
)
from auricle.surface.priority_queue import (
    N_IN_HEAP,
    Queue,
    drop_first,
    next_bucket,
    put,
    queue_for,
)
from auricle.surface.quadric import Quadrics, optimum, unite, workspace


class Collapses(NamedTuple):
    """Collapses in the order they were done.

    Attributes
    ----------
    kept, gone
        Vertices of each edge, shape (c,): the one that stands for both from then on, and the other.
    places
        Where the kept vertex went, shape (c, d).
    growth
        What the sum of all squared distances to planes grew by, shape (c,), mm⁴.
    """

    kept: Integers
    gone: Integers
    places: Floats
    growth: Floats


class Spaces(NamedTuple):
    """What the search works with.

    Attributes
    ----------
    ring, other_ring
        Neighbours of either end, as `neighbours` has them.
    batch
        A bucket of edges; all vertices once, where edges are given another chance.
    waiting
        Shape (n,): 1 where an edge waits.
    room
        Workspace of `optimum`.
    """

    ring: Indices
    other_ring: Indices
    batch: Indices
    waiting: NDArray[np.uint8]
    room: Floats


def collapse_edges(links: HalfEdges, quadrics: Quadrics, *, n_collapses: int) -> Collapses:
    """Collapse edges, cheapest first, until so many are done or none is left that may.

    Parameters
    ----------
    links, quadrics
        Connectivity and quadrics, as `half_edges` and `vertex_quadrics` have them; both are
        changed to those of the surface that is left.
    n_collapses
        How many to do at most.
    """
    n_vertices, dimension = quadrics.places.shape
    n_edges = len(links.half_edges) // 2
    spaces = Spaces(
        np.empty(n_vertices + 2, dtype=np.int32),
        np.empty(n_vertices + 2, dtype=np.int32),
        np.arange(max(n_edges, n_vertices), dtype=np.int32),
        np.zeros(n_vertices, dtype=np.uint8),
        workspace(dimension),
    )
    record = Collapses(
        np.empty(n_collapses, dtype=np.int64),
        np.empty(n_collapses, dtype=np.int64),
        np.empty((n_collapses, dimension)),
        np.empty(n_collapses),
    )
    n_done = _collapse_all(links, queue_for(n_edges), quadrics, spaces, record)
    return Collapses(
        record.kept[:n_done],
        record.gone[:n_done],
        record.places[:n_done],
        record.growth[:n_done],
    )


@compiled_in_place
def _collapse_all(
    links: HalfEdges, queue: Queue, quadrics: Quadrics, spaces: Spaces, record: Collapses
) -> int:
    """Fill the record; return how far."""
    half_edges, starts = links
    n_done, laxity = 0, 0
    _put_all(queue, links, quadrics, spaces, len(half_edges) // 2)
    while n_done < len(record.kept):
        edge = _cheapest(queue, links, quadrics, spaces)
        if edge == NONE:
            laxity += 1
            if laxity == len(LIMITS):
                break
            for vertex in range(len(starts)):
                spaces.batch[vertex] = vertex
            _requeue(links, queue, quadrics, spaces, spaces.batch[: len(starts)])
            continue
        half_edge = 2 * edge + (half_edges[2 * edge, AFTER] == NONE)
        rings = _around(links, spaces, half_edge)
        is_inside = half_edges[half_edge ^ 1, AFTER] != NONE
        if is_safe(quadrics.places, rings, spaces.room, is_inside, laxity):
            _collapse(links, quadrics, spaces, record, (half_edge, n_done))
            n_done += 1
            if _someone_waits(rings, spaces.waiting):
                _requeue(links, queue, quadrics, spaces, rings.ring[: rings.size + 1])
                _requeue(links, queue, quadrics, spaces, rings.other_ring[: rings.other_size + 1])
        else:
            half_edges[2 * edge, WAITS] = 1
            spaces.waiting[rings.one] = spaces.waiting[rings.other] = 1
    return n_done


@compiled_in_place
def _around(links: HalfEdges, spaces: Spaces, half_edge: int) -> Rings:
    half_edges, starts = links
    one, other = half_edges[half_edge, ORIGIN], half_edges[half_edge ^ 1, ORIGIN]
    size = neighbours(half_edges, starts[one], spaces.ring)
    other_size = neighbours(half_edges, starts[other], spaces.other_ring)
    return Rings(one, other, size, other_size, spaces.ring, spaces.other_ring)


@compiled_in_place
def _collapse(
    links: HalfEdges, quadrics: Quadrics, spaces: Spaces, record: Collapses, which: tuple[int, int]
) -> None:
    """Collapse a half-edge to ``room[-1]``, and record it under its number."""
    half_edge, number = which
    one, other = links.half_edges[half_edge, ORIGIN], links.half_edges[half_edge ^ 1, ORIGIN]
    record.kept[number], record.gone[number] = one, other
    for i in range(spaces.room.shape[1]):
        record.places[number, i] = spaces.room[-1, i]
    places, planes, points = quadrics
    record.growth[number] = unite(places, planes, points, one, other, spaces.room)
    merge(links.half_edges, links.starts, half_edge)
    spaces.waiting[one] |= spaces.waiting[other]
    spaces.waiting[other] = 0


@compiled_in_place
def _someone_waits(rings: Rings, waiting: NDArray[np.uint8]) -> bool:
    """Whether an edge waits at an end or a neighbour; either end is in the other's ring."""
    found = 0
    for i in range(rings.size + 1):
        found |= waiting[rings.ring[i]]
    for i in range(rings.other_size + 1):
        found |= waiting[rings.other_ring[i]]
    return found > 0


@compiled_in_place
def _cost(links: HalfEdges, quadrics: Quadrics, room: Floats, edge: int) -> float:
    half_edges, _ = links
    places, planes, _ = quadrics
    one, other = half_edges[2 * edge, ORIGIN], half_edges[2 * edge + 1, ORIGIN]
    return optimum(places, planes, one, other, room)


@compiled_in_place
def _put_all(
    queue: Queue, links: HalfEdges, quadrics: Quadrics, spaces: Spaces, n_edges: int
) -> None:
    """Put the first edges of the batch that are still there into the queue."""
    half_edges, _ = links
    batch, room = spaces.batch, spaces.room
    for i in range(n_edges):
        edge = batch[i]
        if half_edges[2 * edge, ORIGIN] != NONE:
            put(queue, _cost(links, quadrics, room, edge), edge)


@compiled_in_place
def _cheapest(queue: Queue, links: HalfEdges, quadrics: Quadrics, spaces: Spaces) -> int:
    """Take the cheapest edge off the queue; its best place goes into ``room[-1]``."""
    half_edges, _ = links
    while True:
        if queue.counts[N_IN_HEAP] == 0:
            n_edges = next_bucket(queue, spaces.batch)
            if n_edges == 0:
                return NONE
            _put_all(queue, links, quadrics, spaces, n_edges)
            continue
        edge, known = queue.items[0], queue.keys[0]
        drop_first(queue)
        if half_edges[2 * edge, ORIGIN] == NONE:
            continue
        cost = _cost(links, quadrics, spaces.room, edge)
        if not cost > known:
            return int(edge)
        put(queue, cost, edge)


@compiled_in_place
def _requeue(
    links: HalfEdges, queue: Queue, quadrics: Quadrics, spaces: Spaces, candidates: Indices
) -> None:
    """Give every edge that waits at one of the vertices another chance."""
    half_edges, starts = links
    for vertex in candidates:
        if not spaces.waiting[vertex]:
            continue
        spaces.waiting[vertex] = 0
        half_edge = starts[vertex]
        while True:
            edge = half_edge >> 1
            if half_edges[2 * edge, WAITS]:
                half_edges[2 * edge, WAITS] = 0
                put(queue, _cost(links, quadrics, spaces.room, edge), edge)
            before = half_edges[half_edge, BEFORE]
            half_edge = before ^ 1
            if before == NONE or half_edge == starts[vertex]:
                break
