"""The elimination of a sparse symmetric matrix, planned from its pattern alone."""

from typing import NamedTuple

import numpy as np
from scipy import sparse

from auricle.arrays import Integers
from auricle.compiled import compiled
from auricle.spectral.supernodes import (
    OrderedPattern,
    column_heights,
    elimination_tree,
    postorder,
    relaxed_supernodes,
)

_PANEL_COST, _ROW_COST = 150, 3
"""What a panel and a row under it cost in a solve beside the arithmetic, in entries of the factor.

From 80 to 250 and from 0 to 8 they change the time by little more than the clock's noise.
"""
_WIDEST = 64
"""Columns of a supernode; wider ones are cut into a chain."""


class EliminationPlan(NamedTuple):
    """Supernodes of the factor, and where every number of the matrix goes.

    A supernode is a run of columns treated as dense, all with the same rows under them. Its *panel*
    holds the square of its columns and, below, those rows. Children come before parents, one family
    after another, which lets Schur complements be kept on a stack.

    Attributes
    ----------
    order
        Shape (n,): the row of the matrix that is eliminated first, second, … Everything below
        names rows and columns by their place in it.
    first_column
        Shape (s + 1,): of each supernode, and n.
    parent
        Shape (s,): the supernode that takes in the Schur complement; -1 for none.
    row_start, rows
        Rows under the columns of supernode i: rows[row_start[i] : row_start[i + 1]], ascending.
    places
        Shape of `rows`: where each of them lies among the columns and rows of the parent.
    panel_start
        Shape (s + 1,): entries of all panels before each; the last is that of the factor.
    entry_start, entry_source, entry_target
        The matrix's entries in supernode i are data[entry_source[e]], for e from entry_start[i]
        up to entry_start[i + 1]; each belongs at entry_target[e] of the panel.
    """

    order: Integers
    first_column: Integers
    parent: Integers
    row_start: Integers
    rows: Integers
    places: Integers
    panel_start: Integers
    entry_start: Integers
    entry_source: Integers
    entry_target: Integers


def elimination_plan(matrix: sparse.csc_array, order: Integers) -> EliminationPlan:
    """Plan the elimination of a symmetric matrix, and of all others of its pattern.

    Parameters
    ----------
    matrix
        Shape (n, n), both triangles stored; its values do not matter.
    order
        A fill-reducing order of its rows, shape (n,). The plan's own differs from it, without
        harm to the fill but for a little that wider supernodes are worth.

    References
    ----------
    Liu 1990, "The role of elimination trees in sparse factorization"; Duff & Reid 1983, "The
    multifrontal solution of indefinite sparse symmetric linear equations".
    """
    pattern = _ordered(matrix, order.astype(np.int64))
    tree = elimination_tree(pattern)
    visited = postorder(tree)
    tree, pattern = _renamed(tree, visited), _ordered(matrix, pattern.order[visited])
    group, parent, heights = relaxed_supernodes(
        tree, column_heights(pattern, tree), panel_cost=_PANEL_COST, row_cost=_ROW_COST
    )
    visited = postorder(parent)
    group = _inverse(visited)[group]
    parent, heights = _renamed(parent, visited), heights[visited]
    pattern = _ordered(matrix, pattern.order[np.argsort(group, kind="stable")])
    first_column = _running_total(np.bincount(group))
    row_start = _running_total(heights)
    rows = _ascending(row_start, _rows_under(pattern, first_column, parent, row_start))
    first_column, parent, row_start, rows = _cut(first_column, parent, row_start, rows)
    widths, heights = np.diff(first_column), np.diff(row_start)
    return EliminationPlan(
        pattern.order,
        first_column,
        parent,
        row_start,
        rows,
        _places_in_parent(first_column, parent, row_start, rows),
        _running_total(widths * (widths + heights)),
        *_entries(pattern, first_column, row_start, rows),
    )


def plan_in_order(plan: EliminationPlan, ordered: sparse.csc_array) -> EliminationPlan:
    """The same plan for the matrix whose rows and columns are in the plan's order already."""
    pattern = _ordered(ordered, np.arange(len(plan.order)))
    entry_start, source, target = _entries(pattern, plan.first_column, plan.row_start, plan.rows)
    return plan._replace(
        order=pattern.order, entry_start=entry_start, entry_source=source, entry_target=target
    )


def _ordered(matrix: sparse.csc_array, order: Integers) -> OrderedPattern:
    starts, neighbours = matrix.indptr.astype(np.int64), matrix.indices.astype(np.int64)
    return OrderedPattern(starts, neighbours, order, _inverse(order))


def _inverse(order: Integers) -> Integers:
    inverse = np.empty_like(order)
    inverse[order] = np.arange(len(order))
    return inverse


def _running_total(sizes: Integers) -> Integers:
    return np.concatenate([np.zeros(1, np.int64), np.cumsum(sizes, dtype=np.int64)])


def _renamed(parent: Integers, visited: Integers) -> Integers:
    """Parents by the new names of nodes, `visited` being the old names in the new order."""
    moved = parent[visited]
    return np.where(moved < 0, -1, _inverse(visited)[moved])


def _ascending(row_start: Integers, rows: Integers) -> Integers:
    """Each supernode's rows sorted."""
    shape = (len(row_start) - 1, int(rows.max(initial=0)) + 1)
    listed = sparse.csr_array((np.ones(len(rows), np.int8), rows, row_start), shape=shape)
    listed.sort_indices()
    return listed.indices.astype(np.int64)


@compiled
def _rows_under(
    pattern: OrderedPattern, first_column: Integers, parent: Integers, row_start: Integers
) -> Integers:
    """Rows under each supernode, one supernode after another, in no order."""
    rows = np.empty(row_start[-1], np.int64)
    filled = row_start.copy()
    met_by = np.full(len(pattern.order), -1)
    last_child = np.full(len(parent) + 1, -1)
    previous_sibling = np.full(len(parent), -1)
    for s in range(len(parent)):
        end = first_column[s + 1]
        for column in range(first_column[s], end):
            old = pattern.order[column]
            for e in range(pattern.starts[old], pattern.starts[old + 1]):
                row = pattern.position[pattern.neighbours[e]]
                if row >= end and met_by[row] != s:
                    met_by[row] = s
                    rows[filled[s]] = row
                    filled[s] += 1
        child = last_child[s]
        while child != -1:
            for k in range(row_start[child], row_start[child + 1]):
                if rows[k] >= end and met_by[rows[k]] != s:
                    met_by[rows[k]] = s
                    rows[filled[s]] = rows[k]
                    filled[s] += 1
            child = previous_sibling[child]
        previous_sibling[s] = last_child[parent[s]]
        last_child[parent[s]] = s
    return rows


def _cut(
    first_column: Integers, parent: Integers, row_start: Integers, rows: Integers
) -> tuple[Integers, Integers, Integers, Integers]:
    """Cut wide supernodes into chains of narrow ones: first columns, parents, row starts, rows."""
    widths, heights = np.diff(first_column), np.diff(row_start)
    n_links = -(-widths // _WIDEST)
    end_of_chain = np.cumsum(n_links)
    whole = np.repeat(np.arange(len(widths)), n_links)
    link = np.arange(len(whole)) - (end_of_chain - n_links)[whole]
    first = np.append(
        first_column[whole] + link * widths[whole] // n_links[whole], first_column[-1]
    )
    parent_link = np.arange(1, len(whole) + 1)
    parent_link[end_of_chain - 1] = np.where(parent < 0, -1, (end_of_chain - n_links)[parent])
    n_own = first_column[whole + 1] - first[1:]
    start = _running_total(n_own + heights[whole])
    # A link's rows: the columns of the links after it, then the rows under the whole chain.
    owner = np.repeat(np.arange(len(whole)), np.diff(start))
    rank = np.arange(start[-1]) - start[owner]
    under = np.maximum(rank - n_own[owner], 0) + row_start[whole[owner]]
    padded = np.append(rows, 0)
    inside = rank < n_own[owner]
    return first, parent_link, start, np.where(inside, first[owner + 1] + rank, padded[under])


@compiled
def _places_in_parent(
    first_column: Integers, parent: Integers, row_start: Integers, rows: Integers
) -> Integers:
    """Where each row of a supernode lies among the columns and rows of its parent."""
    places = np.empty(len(rows), np.int64)
    for s in range(len(parent)):
        mother = parent[s]
        if mother != -1:
            end = first_column[mother + 1]
            width = end - first_column[mother]
            target = row_start[mother]
            for k in range(row_start[s], row_start[s + 1]):
                if rows[k] < end:
                    places[k] = rows[k] - first_column[mother]
                else:
                    while rows[target] < rows[k]:
                        target += 1
                    places[k] = width + target - row_start[mother]
    return places


@compiled
def _entries(
    pattern: OrderedPattern, first_column: Integers, row_start: Integers, rows: Integers
) -> tuple[Integers, Integers, Integers]:
    """Entries on and under the diagonal, by supernode: where each begins, source and target."""
    entry_start = np.zeros(len(first_column), np.int64)
    source = np.empty(len(pattern.neighbours), np.int64)
    target = np.empty(len(pattern.neighbours), np.int64)
    place = np.empty(len(pattern.order), np.int64)
    filled = 0
    for s in range(len(first_column) - 1):
        first, width = first_column[s], first_column[s + 1] - first_column[s]
        for k in range(width):
            place[first + k] = k
        for k in range(row_start[s], row_start[s + 1]):
            place[rows[k]] = width + k - row_start[s]
        for column in range(first, first + width):
            old = pattern.order[column]
            for e in range(pattern.starts[old], pattern.starts[old + 1]):
                row = pattern.position[pattern.neighbours[e]]
                if row >= column:
                    source[filled] = e
                    target[filled] = place[row] * width + column - first
                    filled += 1
        entry_start[s + 1] = filled
    return entry_start, source[:filled].copy(), target[:filled].copy()
