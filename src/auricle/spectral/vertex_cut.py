"""The fewest vertices that part one side of a graph from the other: a minimum vertex cut."""

from typing import NamedTuple

import numpy as np

from auricle.arrays import Integers, Truths
from auricle.compiled import compiled, compiled_in_place, compiled_inline

SOURCE, CUT, SINK = 0, 1, 2
"""Sides of a parted graph: with the source, of the cut itself, with the sink."""


class Band(NamedTuple):
    """The vertices among which a cut is sought, with the source before and the sink behind them.

    Attributes
    ----------
    starts, neighbours
        Neighbours of vertex v within the band: neighbours[starts[v] : starts[v + 1]].
    at_source, at_sink
        Shape (n,): whether a vertex has a neighbour in the source, or in the sink.
    """

    starts: Integers
    neighbours: Integers
    at_source: Truths
    at_sink: Truths


class _Flow(NamedTuple):
    """Disjoint paths from source to sink, and room for the search of more.

    A vertex lets one path through, from its entry, numbered 2v, to its exit, 2v + 1.

    Attributes
    ----------
    before
        Shape (n,): the vertex before this one on its path, itself where the path begins, -1 where
        there is no path.
    level
        Shape (2n,): steps from the source in the residual graph, or -1.
    tried
        Shape (2n,): how many ways on have been tried.
    queue
        Shape (2n,): entries and exits by level, or those of the path under way.
    """

    before: Integers
    level: Integers
    tried: Integers
    queue: Integers


@compiled
def minimum_vertex_cut(band: Band) -> Integers:
    """`SOURCE`, `CUT` or `SINK` for each vertex of the band, with as few in the cut as can be.

    Of several such cuts it is the one nearest to the source. There are as many vertices in it as
    disjoint paths from source to sink (Menger), which are found level by level.

    References
    ----------
    Even & Tarjan 1975, "Network flow and testing graph connectivity".
    """
    n = len(band.at_source)
    flow = _Flow(
        np.full(n, -1), np.full(2 * n, -1), np.zeros(2 * n, np.int64), np.empty(2 * n, np.int64)
    )
    while _set_levels(band, flow):
        flow.tried[:] = 0
        for v in range(n):
            if band.at_source[v] and flow.level[2 * v] == 0:
                _search_path(band, flow, v)
    sides = np.full(n, SINK)
    for v in range(n):
        if flow.level[2 * v + 1] != -1:
            sides[v] = SOURCE
        elif flow.level[2 * v] != -1:
            sides[v] = CUT
    return sides


@compiled_in_place
def _set_levels(band: Band, flow: _Flow) -> bool:
    """Search the residual graph breadth first; whether the sink is reached."""
    flow.level[:] = -1
    n_seen, n_done, reached = 0, 0, False
    for v in range(len(band.at_source)):
        if band.at_source[v]:
            flow.level[2 * v] = 0
            flow.queue[n_seen] = 2 * v
            n_seen += 1
    while n_done < n_seen:
        here = flow.queue[n_done]
        n_done += 1
        reached = reached or (here & 1 == 1 and band.at_sink[here >> 1])
        for k in range(_n_ways(band, here)):
            there = _way(band, flow.before, here, k)
            if there != -1 and flow.level[there] == -1:
                flow.level[there] = flow.level[here] + 1
                flow.queue[n_seen] = there
                n_seen += 1
    return reached


@compiled_inline
def _n_ways(band: Band, here: int) -> int:
    """How many ways on there may be: one from an entry, one more than neighbours from an exit."""
    v = here >> 1
    return 1 if here & 1 == 0 else 1 + band.starts[v + 1] - band.starts[v]


@compiled_inline
def _way(band: Band, before: Integers, here: int, k: int) -> int:
    """Where the k-th way on leads in the residual graph, or -1 if it is barred."""
    v = here >> 1
    if here & 1 == 1:
        if k > 0:
            neighbour: int = band.neighbours[band.starts[v] + k - 1]
            return 2 * neighbour
        return 2 * v if before[v] != -1 else -1
    if before[v] == -1:
        return 2 * v + 1
    return 2 * before[v] + 1 if before[v] != v else -1


@compiled_in_place
def _search_path(band: Band, flow: _Flow, start: int) -> None:
    """Look for a path from the entry of `start` to the sink, level by level, and take it."""
    path, level = flow.queue, flow.level
    path[0], length = 2 * start, 1
    while length > 0:
        here = path[length - 1]
        if here & 1 == 1 and band.at_sink[here >> 1]:
            _take(flow, length)
            return
        there = -1
        while there == -1 and flow.tried[here] < _n_ways(band, here):
            there = _way(band, flow.before, here, flow.tried[here])
            flow.tried[here] += 1
            if there != -1 and level[there] != level[here] + 1:
                there = -1
        if there != -1:
            path[length] = there
            length += 1
        else:
            level[here] = -1
            length -= 1


@compiled_inline
def _take(flow: _Flow, length: int) -> None:
    """Add the path under way to the flow."""
    for i in range(length):
        here = flow.queue[i]
        flow.level[here] = -1
        if here & 1 == 0:
            v = here >> 1
            came_from = flow.queue[i - 1] >> 1 if i > 0 else -2
            # Coming to the entry from the vertex's own exit gives up the path through it.
            flow.before[v] = v if i == 0 else (-1 if came_from == v else came_from)
