"""A minimum vertex cut parts source from sink, and has as many vertices as disjoint paths."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse
from scipy.sparse.csgraph import connected_components, maximum_flow

from auricle.spectral.vertex_cut import CUT, SINK, SOURCE, Band, minimum_vertex_cut


def band(adjacent: np.ndarray, at_source: np.ndarray, at_sink: np.ndarray) -> Band:
    graph = sparse.csr_array(adjacent)
    return Band(graph.indptr.astype(np.int64), graph.indices.astype(np.int64), at_source, at_sink)


def paths_by_maximum_flow(adjacent, at_source, at_sink) -> int:
    """Each vertex split in entry and exit with an arc of capacity 1 between."""
    n = len(adjacent)
    capacity = np.zeros((2 * n + 2, 2 * n + 2), dtype=np.int32)
    capacity[np.arange(n), n + np.arange(n)] = 1
    capacity[n : 2 * n, :n] = adjacent * n
    capacity[2 * n, :n] = at_source * n
    capacity[n : 2 * n, 2 * n + 1] = at_sink * n
    return maximum_flow(sparse.csr_array(capacity), 2 * n, 2 * n + 1).flow_value


@settings(max_examples=60, deadline=None)
@given(n=st.integers(1, 25), density=st.floats(0.02, 0.5), seed=st.integers(0, 10**6))
def test_the_cut_is_as_small_as_the_flow_is_large_and_parts_the_graph(n, density, seed) -> None:
    rng = np.random.default_rng(seed)
    adjacent = np.triu(rng.random((n, n)) < density, 1)
    adjacent = adjacent | adjacent.T
    at_source, at_sink = rng.random((2, n)) < 0.25
    sides = minimum_vertex_cut(band(adjacent, at_source, at_sink))
    assert (sides == CUT).sum() == paths_by_maximum_flow(adjacent, at_source, at_sink)
    assert not adjacent[np.ix_(sides == SOURCE, sides == SINK)].any()
    assert not (at_sink & (sides == SOURCE)).any()
    assert not (at_source & (sides == SINK)).any()


@pytest.mark.parametrize("width", [1, 5, 12])
def test_a_strip_is_cut_straight_across(width) -> None:
    length = 30
    cells = np.arange(width * length).reshape(length, width)
    adjacent = np.zeros((cells.size, cells.size), dtype=bool)
    for one, other in ((cells[1:], cells[:-1]), (cells[:, 1:], cells[:, :-1])):
        adjacent[one.ravel(), other.ravel()] = adjacent[other.ravel(), one.ravel()] = True
    at_source, at_sink = np.zeros((2, cells.size), dtype=bool)
    at_source[cells[0]], at_sink[cells[-1]] = True, True
    sides = minimum_vertex_cut(band(adjacent, at_source, at_sink))
    assert (sides == CUT).sum() == width
    kept = sides != CUT
    _, piece = connected_components(sparse.csr_array(adjacent[np.ix_(kept, kept)]))
    assert not set(piece[sides[kept] == SOURCE]) & set(piece[sides[kept] == SINK])
