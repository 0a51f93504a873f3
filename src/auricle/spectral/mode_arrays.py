"""Eigenvectors turned into modes where they lie, since memory costs time to be had."""

import numpy as np

from auricle.arrays import Floats, Integers, Modes, PerVertex, frozen
from auricle.compiled import compiled, compiled_inline
from auricle.spectral.lanes import added_product, eight, load, prefetch, store
from auricle.spectral.workers import Workers, slices

_LANES = 8
_MOST_UNUSED = 0.25
"""Share of the room that may stay unused behind the modes; else they are copied out of it."""


def modes_in_place(
    room: Floats, count: int, order: Integers, areas: PerVertex, workers: Workers
) -> Modes:
    """Eigenvectors of the symmetrised matrix as orthonormal under the areas, with their sign.

    Parameters
    ----------
    room
        Eigenvectors, one a column, at least `count`, shape (n, c), contiguous; used up.
    count
        How many are wanted.
    order
        Vertices that the rows belong to, shape (n,).
    areas
        Of the vertices, mm², shape (n,).
    workers
        Who share the columns.

    Returns
    -------
    Modes
        Shape (n, count), frozen, in the memory of `room`. The entry of largest magnitude of each
        is positive.

    Examples
    --------
    >>> room = np.array([[-3.0, 0.0], [1.0, 0.0]])
    >>> with Workers(1) as workers:
    ...     modes_in_place(room, 1, np.array([1, 0]), np.array([1.0, 4.0]), workers).tolist()
    [[-1.0], [1.5]]
    """
    order = np.ascontiguousarray(order, dtype=np.int64)
    roots = 1 / np.sqrt(areas[order])
    n, n_columns = room.shape
    numbers = room.reshape(-1)
    if n_columns > count:
        _close_up(numbers, n_columns, count, n)
    modes = numbers[: n * count].reshape(n, count)

    def extremes(some: slice) -> Floats:
        return _extremes(modes[some], roots[some])

    found = np.stack(workers.each(extremes, slices(n, -(-n // workers.threads))))
    signs = np.where(found[:, 0].min(axis=0) < -found[:, 1].max(axis=0), -1.0, 1.0)

    def turn(some: slice) -> None:
        _turn(modes, some.start, some.stop, order, roots, signs)

    workers.each(turn, slices(count, -(-count // workers.threads)))
    if n_columns - count > _MOST_UNUSED * n_columns:
        return frozen(modes.copy())
    frozen(room)
    return frozen(modes)


@compiled
def _close_up(numbers: Floats, old: int, new: int, n_rows: int) -> None:
    """Move rows of `old` numbers together, so that only the first `new` of each are left."""
    for p in range(n_rows):
        source, target = numbers[p * old : p * old + new], numbers[p * new : (p + 1) * new]
        for j in range(new):
            target[j] = source[j]


@compiled
def _extremes(modes: Modes, roots: PerVertex) -> Floats:
    """Of the entries of each mode, scaled, the least and the largest, or 0; shape (2, k)."""
    extremes = np.zeros((2, modes.shape[1]))
    low, high = extremes[0], extremes[1]
    for p in range(len(modes)):
        row, root = modes[p], roots[p]
        for j in range(len(row)):
            value = row[j] * root
            high[j] = max(high[j], value)
            low[j] = min(low[j], value)
    return extremes


@compiled
def _turn(
    modes: Floats, begin: int, end: int, order: Integers, roots: PerVertex, signs: Floats
) -> None:
    """Scale the entries of some columns, and put each row where its vertex is.

    Each cycle of the permutation is gone round once, with one row in hand and the next asked for.
    """
    width, step = end - begin, modes.shape[1]
    held, placed = np.empty(width), np.zeros(len(order), np.bool_)
    for start in range(len(order)):
        if placed[start]:
            continue
        held[:] = modes[start, begin:end]
        p = start
        while not placed[p]:
            placed[p] = True
            places = (order[p] * step + begin, order[order[p]] * step + begin)
            _exchange(modes, places, held, roots[p], signs[begin:end])
            p = order[p]


@compiled_inline
def _exchange(
    modes: Floats, places: tuple[int, int], held: Floats, root: float, signs: Floats
) -> None:
    """Put what is held, scaled, in the first place, and hold what was there; ask for the next."""
    place, ahead = places
    zero, roots, n_whole = eight(0.0), eight(root), len(held) // _LANES * _LANES
    for j in range(0, n_whole, _LANES):
        prefetch(modes, ahead + j)
        found = load(zero, modes, place + j)
        scaled = added_product(zero, load(zero, held, j), roots)
        store(added_product(zero, scaled, load(zero, signs, j)), modes, place + j)
        store(found, held, j)
    numbers = modes.reshape(-1)
    for j in range(n_whole, len(held)):
        value = signs[j] * (held[j] * root)
        held[j] = numbers[place + j]
        numbers[place + j] = value
