"""The plan of an elimination agrees with an elimination by hand."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse

from auricle.spectral.elimination import elimination_plan
from auricle.spectral.supernodes import (
    OrderedPattern,
    column_heights,
    elimination_tree,
    postorder,
)


def random_pattern(n: int, density: float, seed: int) -> np.ndarray:
    marks = np.random.default_rng(seed).random((n, n)) < density
    return marks | marks.T | np.eye(n, dtype=bool)


def filled(pattern: np.ndarray) -> np.ndarray:
    """The pattern after elimination, column by column: every column's rows become a clique."""
    filled = pattern.copy()
    for column in range(len(filled)):
        rows = np.flatnonzero(filled[:, column])
        rows = rows[rows > column]
        filled[np.ix_(rows, rows)] = True
    return np.tril(filled)


sizes = st.integers(1, 40)
densities = st.floats(0.0, 0.4)
seeds = st.integers(0, 10**6)


@settings(max_examples=40, deadline=None)
@given(sizes, densities, seeds)
def test_tree_and_heights_are_those_of_elimination_by_hand(n, density, seed) -> None:
    pattern = random_pattern(n, density, seed)
    columns = sparse.csc_array(pattern.astype(float))
    natural = np.arange(n)
    ordered = OrderedPattern(
        columns.indptr.astype(np.int64), columns.indices.astype(np.int64), natural, natural
    )
    under = np.tril(filled(pattern), -1)
    first_under = np.where(under.any(axis=0), under.argmax(axis=0), -1)
    tree = elimination_tree(ordered)
    np.testing.assert_array_equal(tree, first_under)
    np.testing.assert_array_equal(column_heights(ordered, tree), under.sum(axis=0))


@settings(max_examples=40, deadline=None)
@given(st.lists(st.integers(1, 100), max_size=60))
def test_postorder_keeps_every_subtree_in_one_run_before_its_root(steps) -> None:
    n = len(steps)
    parent = np.arange(n) + np.array(steps, dtype=np.int64)
    parent[parent >= n] = -1
    visited = postorder(parent)
    np.testing.assert_array_equal(np.sort(visited), np.arange(n))
    place = np.argsort(visited)
    size = np.ones(n, dtype=np.int64)
    for node in range(n):
        if parent[node] >= 0:
            size[parent[node]] += size[node]
    for node in range(n):
        if parent[node] >= 0:
            assert place[parent[node]] - size[parent[node]] < place[node] < place[parent[node]]


@settings(max_examples=40, deadline=None)
@given(sizes, densities, seeds)
def test_panels_hold_every_entry_that_elimination_fills(n, density, seed) -> None:
    pattern = random_pattern(n, density, seed)
    plan = elimination_plan(sparse.csc_array(pattern.astype(float)), np.arange(n)[::-1])
    planned = np.zeros((n, n), dtype=bool)
    for s in range(len(plan.parent)):
        columns = np.arange(plan.first_column[s], plan.first_column[s + 1])
        rows = plan.rows[plan.row_start[s] : plan.row_start[s + 1]]
        assert (np.diff(rows) > 0).all()
        planned[np.ix_(np.concatenate([columns, rows]), columns)] = True
        height = len(columns) + len(rows)
        assert plan.panel_start[s + 1] - plan.panel_start[s] == height * len(columns)
        assert plan.parent[s] == -1 or plan.first_column[plan.parent[s]] <= rows[0]
        assert (plan.parent[s] == -1) == (len(rows) == 0)
    needed = filled(pattern[np.ix_(plan.order, plan.order)])
    assert not (needed & ~planned).any()


@settings(max_examples=40, deadline=None)
@given(sizes, densities, seeds)
def test_every_entry_of_the_matrix_has_one_place_in_a_panel(n, density, seed) -> None:
    pattern = random_pattern(n, density, seed)
    matrix = sparse.csc_array(pattern * np.random.default_rng(seed).standard_normal((n, n)))
    plan = elimination_plan(matrix, np.arange(n))
    rebuilt = np.zeros((n, n))
    for s in range(len(plan.parent)):
        columns = np.arange(plan.first_column[s], plan.first_column[s + 1])
        rows = np.concatenate([columns, plan.rows[plan.row_start[s] : plan.row_start[s + 1]]])
        entries = slice(plan.entry_start[s], plan.entry_start[s + 1])
        panel = np.zeros(len(rows) * len(columns))
        panel[plan.entry_target[entries]] = matrix.data[plan.entry_source[entries]]
        rebuilt[np.ix_(rows, columns)] += panel.reshape(len(rows), len(columns))
    reordered = matrix.toarray()[np.ix_(plan.order, plan.order)]
    np.testing.assert_array_equal(rebuilt, np.tril(reordered))
