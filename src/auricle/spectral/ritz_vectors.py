"""Ritz vectors from a basis: of many long vectors a few combinations."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from auricle.arrays import Floats
from auricle.compiled import compiled
from auricle.spectral.lanes import Lanes, added_multiple, eight, load, prefetch, store, zeros
from auricle.spectral.narrow_products import Groups, copy_entries
from auricle.spectral.side_by_side import set_side_by_side

_AT_ONCE, _STRIP = 8, 128
"""Combinations that a register holds; entries of all vectors that stay in the cache."""
_NOTHING = 1e-16
"""Of a combination of length one, length of its end that is left out."""


class Combinations(NamedTuple):
    """What many long vectors are combined to, in the order in which that is computed.

    Attributes
    ----------
    side_by_side
        Weights of eight combinations at a time, shape (ceil(c / 8), m, 8).
    needed
        Of each eight, how many vectors any of them has a part in.
    """

    side_by_side: Floats
    needed: NDArray[np.int64]

    @classmethod
    def of(cls, weights: Floats) -> "Combinations":
        """From weights of vectors, shape (c, m); each row of length one.

        A Ritz vector near the shift has converged long before the last of its basis was made, and
        has next to no part in that: what ends a sum with no more than 1e-16 of its length is left
        out.
        """
        side_by_side = np.zeros((-(-len(weights) // _AT_ONCE), weights.shape[1], _AT_ONCE))
        for i, eights in enumerate(side_by_side):
            combined = weights[i * _AT_ONCE : (i + 1) * _AT_ONCE]
            set_side_by_side(combined, eights.reshape(-1), _AT_ONCE)
        return cls(side_by_side, _needed(side_by_side))


def fill_combinations(
    groups: Groups, combinations: Combinations, columns: Floats, some: slice
) -> None:
    """Set some entries of `columns` to those of weighted sums of vectors.

    Parameters
    ----------
    groups
        Orthonormal vectors, shape (g, n, lanes).
    combinations
        Of these.
    columns
        One sum a column, shape (n, c).
    some
        Of the n entries, those that are set.

    Examples
    --------
    >>> basis, columns = np.zeros((1, 3, 4)), np.zeros((3, 1))
    >>> basis[0, :3, :3] = np.eye(3)
    >>> sums = Combinations.of(np.array([[0.6, 0.8, 0.0, 0.0]]))
    >>> fill_combinations(basis, sums, columns, slice(1, 3))
    >>> columns.tolist()
    [[0.0], [0.8], [0.0]]
    """
    _fill(groups, combinations, columns, (some.start, some.stop), (0.0,) * groups.shape[2])


@compiled
def _fill(
    groups: Groups,
    combinations: Combinations,
    columns: Floats,
    some: tuple[int, int],
    like: tuple[float, ...],
) -> None:
    side_by_side, needed = combinations
    entries = np.zeros((_STRIP, side_by_side.shape[1]))
    for begin in range(some[0], some[1], _STRIP):
        strip = columns[begin : min(begin + _STRIP, some[1])]
        copy_entries(groups, begin, entries[: len(strip)], zeros(like))
        _fill_strip(entries, side_by_side, needed, strip)


def _needed(side_by_side: Floats) -> NDArray[np.int64]:
    """Of each eight combinations, how many vectors any of them has a part in."""
    ends = np.cumsum(side_by_side[:, ::-1] ** 2, axis=1)[:, ::-1]
    return np.asarray((ends > _NOTHING**2).any(axis=2).sum(axis=1))


@compiled
def _fill_strip(
    entries: Floats, side_by_side: Floats, needed: NDArray[np.int64], columns: Floats
) -> None:
    numbers, weights, zero = entries.reshape(-1), side_by_side.reshape(-1), eight(0.0)
    n_vectors, tile = entries.shape[1], np.empty(_AT_ONCE * _AT_ONCE)
    for c in range(len(needed)):
        vectors = (weights, c * n_vectors * _AT_ONCE, _AT_ONCE)
        n_here = min(_AT_ONCE, columns.shape[1] - c * _AT_ONCE)
        for p in range(0, len(columns), _AT_ONCE):
            places = (p * n_vectors, n_vectors, 1, (p + _AT_ONCE) * n_vectors)
            sums = _eight_dots(numbers, places, needed[c], vectors, zero)
            for i in range(_AT_ONCE):
                store(sums[i], tile, i * _AT_ONCE)
            for i in range(min(_AT_ONCE, len(columns) - p)):
                entry = columns[p + i]
                for j in range(n_here):
                    entry[c * _AT_ONCE + j] = tile[i * _AT_ONCE + j]


@compiled
def _eight_dots(
    numbers: Floats,
    places: tuple[int, int, int, int],
    count: int,
    vectors: tuple[Floats, int, int],
    zero: Lanes,
) -> tuple[Lanes, Lanes, Lanes, Lanes, Lanes, Lanes, Lanes, Lanes]:
    """Of eight lines, sums of `count` numbers each times its row of `vectors`.

    `places` are where the first line begins, how far apart lines are, the step along them, and
    what will be wanted next; `vectors` are the array, where in it the first row begins, and how
    far apart rows are.
    """
    place, line, step, ahead = places
    rows, begin, apart = vectors
    a, b, c, d, e, f, g, h = zero, zero, zero, zero, zero, zero, zero, zero
    for _ in range(count):
        prefetch(numbers, ahead)
        x = load(zero, rows, begin)
        a = added_multiple(a, numbers, place, x)
        b = added_multiple(b, numbers, place + line, x)
        c = added_multiple(c, numbers, place + 2 * line, x)
        d = added_multiple(d, numbers, place + 3 * line, x)
        e = added_multiple(e, numbers, place + 4 * line, x)
        f = added_multiple(f, numbers, place + 5 * line, x)
        g = added_multiple(g, numbers, place + 6 * line, x)
        h = added_multiple(h, numbers, place + 7 * line, x)
        place, begin, ahead = place + step, begin + apart, ahead + 8
    return a, b, c, d, e, f, g, h
