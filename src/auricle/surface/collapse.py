"""Edge collapse: the cheapest edge of a surface made a vertex, again and again.

An edge's cost is the least sum of its ends' quadrics. Quadrics only grow, so a cost worked out
earlier is never too high: the queue keeps it until the edge comes first, and works it out anew
only then. This visits edges in the same order as keeping every cost up to date.

An edge collapses only if the surface stays what it is: the link condition keeps pieces, holes
and handles (Dey, Edelsbrunner, Guha and Nekhayev, *Topology preserving edge contraction*, 1999);
no face around may turn far, nor become a sliver. An edge refused waits until a neighbour changes.
Only when every edge waits may faces turn, and only when that is not enough, thin.
"""

from typing import NamedTuple

import numpy as np

from auricle.arrays import Floats, Integers
from auricle.compiled import borrowed, compiled
from auricle.surface.halfedges import (
    EDGE,
    MARK,
    NONE,
    OPPOSITE,
    ORIGIN,
    SIDE,
    START,
    WAITING,
    WAITS,
    HalfEdges,
    Indices,
    following,
    merge,
    neighbours,
    preceding,
)
from auricle.surface.priority_queue import Queue, drop_first, put, queue_of
from auricle.surface.quadric import Quadrics, optimum, unite, workspace
from auricle.surface.volume_preservation import preserve_volume

LEAST_COSINES = (0.2, -1.0, -1.0)
"""Of the angle by which a face may turn in one collapse: 78°; any once no edge is left else."""
LEAST_QUALITIES = (0.1, 0.1, 0.0)
"""4√3·area / Σ edge² below which no face may come that was better; any once no edge is left."""

TWICE_ROOT_3 = 2.0 * 3.0**0.5


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
    room = workspace(dimension)
    queue = queue_of(_costs(links.half_edges, links.edges, quadrics.places, quadrics.planes, room))
    near_one, near_other = np.empty((2, n_vertices + 2), dtype=np.int32)
    record = Collapses(
        np.empty(n_collapses, dtype=np.int64),
        np.empty(n_collapses, dtype=np.int64),
        np.empty((n_collapses, dimension)),
        np.empty(n_collapses),
    )
    n_done = _collapse_all(links, queue, quadrics, (near_one, near_other, room), record)
    return Collapses(
        record.kept[:n_done],
        record.gone[:n_done],
        record.places[:n_done],
        record.growth[:n_done],
    )


@compiled
def _costs(
    half_edges: Indices, edges: Indices, places: Floats, planes: Floats, room: Floats
) -> Floats:
    costs = np.empty(len(edges))
    for edge in range(len(edges)):
        side = edges[edge, SIDE]
        one, other = half_edges[side, ORIGIN], half_edges[following(side), ORIGIN]
        costs[edge] = optimum(places, planes, one, other, room)
    return costs


@compiled
def _collapse_all(
    links: HalfEdges,
    queue: Queue,
    quadrics: Quadrics,
    spaces: tuple[Indices, Indices, Floats],
    record: Collapses,
) -> int:
    """Fill the record; return how far."""
    return _collapsed(
        HalfEdges(borrowed(links.half_edges), borrowed(links.edges), borrowed(links.vertices)),
        Queue(
            borrowed(queue.listed_keys),
            borrowed(queue.listed_items),
            borrowed(queue.keys),
            borrowed(queue.items),
            borrowed(queue.counts),
        ),
        Quadrics(borrowed(quadrics.places), borrowed(quadrics.planes), borrowed(quadrics.points)),
        (borrowed(spaces[0]), borrowed(spaces[1]), borrowed(spaces[2])),
        record,
    )


@compiled
def _collapsed(
    links: HalfEdges,
    queue: Queue,
    quadrics: Quadrics,
    spaces: tuple[Indices, Indices, Floats],
    record: Collapses,
) -> int:
    """Do as `_collapse_all`, with borrowed arrays."""
    half_edges, edges, vertices = links
    places, planes, points = quadrics
    near_one, _, room = spaces
    kept, gone, new_places, growth = record
    n_done, laxity = 0, 0
    while n_done < len(kept):
        half_edge = _cheapest(queue, links, quadrics, room)
        if half_edge == NONE:
            laxity += 1
            if laxity == len(LEAST_COSINES):
                break
            _requeue(links, queue, quadrics, room, np.arange(len(vertices), dtype=np.int32))
            continue
        limits = (LEAST_COSINES[laxity], LEAST_QUALITIES[laxity])
        if not _may_collapse(links, quadrics.places, spaces, half_edge, limits):
            _let_wait(half_edges, edges, vertices, half_edge)
            continue
        one, other = half_edges[half_edge, ORIGIN], half_edges[following(half_edge), ORIGIN]
        kept[n_done], gone[n_done] = one, other
        for i in range(room.shape[1]):
            new_places[n_done, i] = room[-1, i]
        growth[n_done] = unite(places, planes, points, one, other, room)
        merge(half_edges, edges, vertices, half_edge)
        vertices[one, WAITING] |= vertices[other, WAITING]
        vertices[other, WAITING] = 0
        n_near = neighbours(half_edges, vertices[one, START], near_one) + 2
        near_one[n_near - 1] = one
        if _someone_waits(vertices, near_one, n_near):
            _requeue(links, queue, quadrics, room, near_one[:n_near])
        n_done += 1
    return n_done


@compiled
def _cheapest(queue: Queue, links: HalfEdges, quadrics: Quadrics, room: Floats) -> int:
    """Take the cheapest edge off the queue; its best place goes into ``room[-1]``."""
    listed_keys, listed_items, keys, items, counts = queue
    half_edges, edges, _ = links
    places, planes, _ = quadrics
    while True:
        if listed_keys[counts[0]] <= keys[0]:
            edge = listed_items[counts[0]]
            if edge == NONE:
                return NONE
            counts[0] += 1
        else:
            edge = items[0]
            drop_first(keys, items, counts)
        side = edges[edge, SIDE]
        if side == NONE:
            continue
        one, other = half_edges[side, ORIGIN], half_edges[following(side), ORIGIN]
        cost = optimum(places, planes, one, other, room)
        if cost <= min(listed_keys[counts[0]], keys[0]):
            return int(side)
        put(keys, items, counts, cost, edge)


@compiled
def _let_wait(half_edges: Indices, edges: Indices, vertices: Indices, half_edge: int) -> None:
    edges[half_edges[half_edge, EDGE], WAITS] = 1
    vertices[half_edges[half_edge, ORIGIN], WAITING] = 1
    vertices[half_edges[following(half_edge), ORIGIN], WAITING] = 1


@compiled
def _someone_waits(vertices: Indices, ring: Indices, size: int) -> bool:
    waiting = 0
    for i in range(size):
        waiting |= vertices[ring[i], WAITING]
    return waiting > 0


@compiled
def _requeue(
    links: HalfEdges, queue: Queue, quadrics: Quadrics, room: Floats, candidates: Indices
) -> None:
    """Give every edge that waits at one of the vertices another chance."""
    half_edges, _, vertices = links
    for vertex in candidates:
        if not vertices[vertex, WAITING]:
            continue
        vertices[vertex, WAITING] = 0
        first = vertices[vertex, START]
        half_edge = first
        while half_edge != NONE:
            before = preceding(half_edge)
            _requeue_edge(links, queue, quadrics, room, half_edges[half_edge, EDGE])
            _requeue_edge(links, queue, quadrics, room, half_edges[before, EDGE])
            half_edge = half_edges[before, OPPOSITE]
            if half_edge == first:
                break


@compiled
def _requeue_edge(
    links: HalfEdges, queue: Queue, quadrics: Quadrics, room: Floats, edge: int
) -> None:
    half_edges, edges, _ = links
    if edges[edge, WAITS]:
        edges[edge, WAITS] = 0
        side = edges[edge, SIDE]
        one, other = half_edges[side, ORIGIN], half_edges[following(side), ORIGIN]
        put(
            queue.keys,
            queue.items,
            queue.counts,
            optimum(quadrics.places, quadrics.planes, one, other, room),
            edge,
        )


@compiled
def _may_collapse(
    links: HalfEdges,
    places: Floats,
    spaces: tuple[Indices, Indices, Floats],
    half_edge: int,
    limits: tuple[float, float],
) -> bool:
    """Whether the surface stays what it is if an edge collapses.

    To ``room[-1]``, which inside the surface is moved so that the volume stays the same. The
    limits are the least cosine and the least quality.
    """
    near_one, near_other, room = spaces
    half_edges, _, vertices = links
    one, other = half_edges[half_edge, ORIGIN], half_edges[following(half_edge), ORIGIN]
    n_one = neighbours(half_edges, vertices[one, START], near_one)
    n_other = neighbours(half_edges, vertices[other, START], near_other)
    is_inside = half_edges[half_edge, OPPOSITE] != NONE
    if not _keeps_topology(vertices, near_one, near_other, n_one, n_other, is_inside):
        return False
    if near_one[0] == near_one[n_one] and near_other[0] == near_other[n_other]:
        preserve_volume(places, near_one, near_other, (one, other, n_one, n_other), room)
    least = min(
        _worst_after(places, (one, other), near_one, n_one, room, limits),
        _worst_after(places, (other, one), near_other, n_other, room, limits),
    )
    if least >= limits[1]:
        return True
    before = min(_worst(places, one, near_one, n_one), _worst(places, other, near_other, n_other))
    return least >= before


@compiled
def _keeps_topology(
    vertices: Indices,
    near_one: Indices,
    near_other: Indices,
    n_one: int,
    n_other: int,
    is_inside: bool,
) -> bool:
    """Whether the ends share no neighbours but the corners opposite their edge.

    An edge inside may not join two boundary vertices, and a tetrahedron or a lone triangle stays.
    """
    for i in range(n_one + 1):
        vertices[near_one[i], MARK] = 1
    one_inside = near_one[0] == near_one[n_one]
    other_inside = near_other[0] == near_other[n_other]
    n_shared = 0
    for i in range(n_other + (not other_inside)):
        n_shared += vertices[near_other[i], MARK]
    for i in range(n_one + 1):
        vertices[near_one[i], MARK] = 0
    is_chord = is_inside and not (one_inside or other_inside)
    n_least = 3 if is_inside else 2
    is_least = n_one + (not one_inside) == n_least and n_other + (not other_inside) == n_least
    return n_shared == 1 + is_inside and not is_chord and not is_least


@compiled
def _worst_after(
    places: Floats,
    ends: tuple[int, int],
    ring: Indices,
    n_faces: int,
    room: Floats,
    limits: tuple[float, float],
) -> float:
    """Least quality of the faces around the first end that stay when it moves to ``room[-1]``.

    Below 0 if one of them turns too far; a sliver has no normal to speak of and may turn.
    """
    vertex, partner = ends
    cosine, quality = limits
    least = 1.0
    for i in range(n_faces):
        second, third = ring[i], ring[i + 1]
        if second == partner or third == partner:
            continue
        u, v, w = _side(places, second, third)
        x, y, z = _side(places, vertex, second)
        before = _shape(x, y, z, u, v, w)
        x = places[second, 0] - room[-1, 0]
        y = places[second, 1] - room[-1, 1]
        z = places[second, 2] - room[-1, 2]
        after = _shape(x, y, z, u, v, w)
        aligned = before[0] * after[0] + before[1] * after[1] + before[2] * after[2]
        if aligned < cosine * before[3] * after[3] and before[4] >= quality:
            return -1.0
        least = min(least, after[4])
    return least


@compiled
def _worst(places: Floats, vertex: int, ring: Indices, n_faces: int) -> float:
    """Least quality of the faces around a vertex."""
    least = 1.0
    for i in range(n_faces):
        u, v, w = _side(places, ring[i], ring[i + 1])
        x, y, z = _side(places, vertex, ring[i])
        least = min(least, _shape(x, y, z, u, v, w)[4])
    return least


@compiled
def _side(places: Floats, one: int, other: int) -> tuple[float, float, float]:
    x, y, z = places[other, 0], places[other, 1], places[other, 2]
    return x - places[one, 0], y - places[one, 1], z - places[one, 2]


@compiled
def _shape(
    x: float, y: float, z: float, u: float, v: float, w: float
) -> tuple[float, float, float, float, float]:
    """Cross product of two sides in turn, its length, and the triangle's quality."""
    a, b, c = y * w - z * v, z * u - x * w, x * v - y * u
    third = (x + u) ** 2 + (y + v) ** 2 + (z + w) ** 2
    squares = x * x + y * y + z * z + u * u + v * v + w * w + third
    size = np.sqrt(a * a + b * b + c * c)
    quality = TWICE_ROOT_3 * size / squares if squares > 0.0 else 0.0
    return a, b, c, size, quality
