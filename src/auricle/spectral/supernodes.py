"""Supernodes of a sparse elimination: runs of columns that share the rows under them."""

from typing import NamedTuple

import numpy as np

from auricle.arrays import Integers
from auricle.compiled import compiled


class OrderedPattern(NamedTuple):
    """Where a symmetric matrix is not zero, and the order in which it is eliminated.

    Attributes
    ----------
    starts, neighbours
        Compressed columns of the pattern, both triangles.
    order
        Shape (n,): the column that is eliminated first, second, …
    position
        Its inverse. Below, columns and rows are named by their position.
    """

    starts: Integers
    neighbours: Integers
    order: Integers
    position: Integers


class Supernodes(NamedTuple):
    """Columns in groups, each as wide as its columns and as high as the rows under them all.

    Attributes
    ----------
    group
        Shape (n,): supernode of each column.
    parent
        Shape (s,): supernode of the first row under it, or -1.
    heights
        Shape (s,): number of rows under its columns.
    """

    group: Integers
    parent: Integers
    heights: Integers


@compiled
def elimination_tree(pattern: OrderedPattern) -> Integers:
    """First row under each diagonal that elimination leaves non-zero, shape (n,); -1 for none.

    References
    ----------
    Liu 1990, "The role of elimination trees in sparse factorization", algorithm 4.2.
    """
    n = len(pattern.order)
    parent = np.full(n, -1)
    ancestor = np.full(n, -1)
    for row in range(n):
        old = pattern.order[row]
        for e in range(pattern.starts[old], pattern.starts[old + 1]):
            column = pattern.position[pattern.neighbours[e]]
            while column != -1 and column < row:
                following = ancestor[column]
                ancestor[column] = row
                if following == -1:
                    parent[column] = row
                column = following
    return parent


@compiled
def postorder(parent: Integers) -> Integers:
    """List the nodes of a forest, shape (n,): every subtree in one run, its root last."""
    n = len(parent)
    first_child = np.full(n + 1, -1)
    next_sibling = np.full(n, -1)
    for node in range(n - 1, -1, -1):
        # The last place stands for a root above all roots.
        next_sibling[node] = first_child[parent[node]]
        first_child[parent[node]] = node
    visited = np.empty(n, np.int64)
    n_visited, node = 0, n
    while n_visited < n:
        while first_child[node] != -1:
            child = first_child[node]
            first_child[node] = next_sibling[child]
            node = child
        visited[n_visited] = node
        n_visited += 1
        node = parent[node] if parent[node] != -1 else n
    return visited


@compiled
def column_heights(pattern: OrderedPattern, parent: Integers) -> Integers:
    """Count the entries of the factor under each diagonal, shape (n,), by the elimination tree."""
    n = len(parent)
    heights = np.zeros(n, np.int64)
    last_row = np.arange(n)
    for row in range(n):
        old = pattern.order[row]
        for e in range(pattern.starts[old], pattern.starts[old + 1]):
            column = min(pattern.position[pattern.neighbours[e]], row)
            while last_row[column] != row:
                heights[column] += 1
                last_row[column] = row
                column = parent[column]
    return heights


def relaxed_supernodes(
    parent: Integers, heights: Integers, *, panel_cost: int, row_cost: int
) -> Supernodes:
    """Group columns into supernodes, and these with their parents where that saves time.

    Neighbouring columns with the same rows under them make a supernode. One of w columns over m
    rows costs (w + m)·w for its entries, `row_cost`·m for its rows and `panel_cost` besides. A
    child is joined to its parent, zeros and all, where that costs no more than the two apart.

    Parameters
    ----------
    parent, heights
        Elimination tree in postorder, and number of entries under each diagonal.
    panel_cost, row_cost
        In entries of the factor.

    References
    ----------
    Ashcraft & Grimes 1989, "The influence of relaxed supernode partitions on the multifrontal
    method".
    """
    n = len(parent)
    alike = (parent[:-1] == np.arange(1, n)) & (heights[:-1] == heights[1:] + 1)
    first = np.flatnonzero(np.concatenate([[True], ~alike]))
    last = np.append(first[1:], n) - 1
    group = np.repeat(np.arange(len(first)), last - first + 1)
    mother = np.where(parent[last] < 0, -1, group[parent[last]])
    joined = _joined(mother, last - first + 1, heights[last], panel_cost, row_cost)
    kept = np.flatnonzero(joined == np.arange(len(first)))
    number = np.searchsorted(kept, joined)
    return Supernodes(
        number[group],
        np.where(mother[kept] < 0, -1, number[mother[kept]]),
        heights[last][kept],
    )


@compiled
def _joined(
    parent: Integers, widths: Integers, heights: Integers, panel_cost: int, row_cost: int
) -> Integers:
    """Name the supernode that each becomes part of in the end, itself where it stays apart."""
    width = widths.copy()
    joined = np.arange(len(parent))
    for child in range(len(parent)):
        mother = parent[child]
        if mother != -1:
            w, m, v, k = width[child], heights[child], width[mother], heights[mother]
            apart = (w + m) * w + row_cost * m + panel_cost + (v + k) * v
            if (w + v + k) * (w + v) <= apart:
                joined[child] = mother
                width[mother] += w
    for child in range(len(parent) - 1, -1, -1):
        joined[child] = joined[joined[child]]
    return joined
