"""Sums of products along a stream of numbers: several lines of a matrix, each with several vectors.

The stream holds a matrix in tiles of eight lines, of each tile one column after another, so that
all it is read for is one long walk through memory. A matrix library's products of such size spend
more time on their preparation.
"""

from typing import TypeAlias

from auricle.arrays import Floats
from auricle.compiled import compiled_inline
from auricle.spectral.lanes import (
    Lanes,
    added_multiple,
    added_product,
    dealt_first,
    dealt_fourth,
    dealt_second,
    dealt_third,
    eight,
    four,
    load,
    load_fours,
    prefetch,
    store,
    turned_once,
    turned_thrice,
    turned_twice,
    width,
)

Rows: TypeAlias = tuple[Floats, int, int]
"""Rows of as many numbers as there are lanes: an array, where in it the first begins, and how far
apart two of them are."""
TILE = 8
"""Lines side by side; the last of a matrix are four where that is enough."""
_AHEAD = 4096
"""By how many numbers a stream is asked for before it is used."""


@compiled_inline
def tile_width(n_left: int) -> int:
    """Lines of the next tile where so many are left, with what fills them up."""
    return TILE if n_left > TILE // 2 else TILE // 2


@compiled_inline
def lines_at_once(n_left: int, zero: Lanes) -> int:
    """Lines that are gone through at once where so many are left, with what fills them up."""
    if width(zero) == 4 and n_left > TILE + TILE // 2:
        return 2 * TILE
    return tile_width(n_left)


@compiled_inline
def sum_lines(
    numbers: Floats, part: tuple[int, int, int], vectors: Rows, sums: Rows, zero: Lanes
) -> None:
    """Of some lines of a stream, sums of their numbers each times its row of `vectors`.

    `part` is where in the stream the lines begin, how many they are (as `lines_at_once` says), and
    how many numbers each has. Sums are put into rows too, one a line.
    """
    place, n_lines, count = part
    if width(zero) == 4:
        if n_lines == 2 * TILE:
            _sum_two_turned(numbers, place, count, vectors, sums, eight(0.0))
        elif n_lines == TILE:
            _sum_turned(numbers, place, count, vectors, sums, eight(0.0))
        else:
            _sum_turned(numbers, place, count, vectors, sums, four(0.0))
    elif n_lines == TILE:
        _sum_eight(numbers, place, count, vectors, sums, zero)
    else:
        _sum_four(numbers, place, count, vectors, sums, zero)


@compiled_inline
def _sum_eight(
    numbers: Floats,
    place: int,
    count: int,
    vectors: Rows,
    sums: Rows,
    zero: Lanes,
) -> None:
    """Eight lines and eight vectors: a number for a register, and a register for a line."""
    rows, begin, apart = vectors
    a, b, c, d, e, f, g, h = zero, zero, zero, zero, zero, zero, zero, zero
    for _ in range(count):
        prefetch(numbers, place + _AHEAD)
        x = load(zero, rows, begin)
        a, b = added_multiple(a, numbers, place, x), added_multiple(b, numbers, place + 1, x)
        c, d = added_multiple(c, numbers, place + 2, x), added_multiple(d, numbers, place + 3, x)
        e, f = added_multiple(e, numbers, place + 4, x), added_multiple(f, numbers, place + 5, x)
        g, h = added_multiple(g, numbers, place + 6, x), added_multiple(h, numbers, place + 7, x)
        place, begin = place + TILE, begin + apart
    found, first, step = sums
    _put((a, b, c, d), found, first, step)
    _put((e, f, g, h), found, first + 4 * step, step)


@compiled_inline
def _sum_four(
    numbers: Floats,
    place: int,
    count: int,
    vectors: Rows,
    sums: Rows,
    zero: Lanes,
) -> None:
    """The same with four lines."""
    rows, begin, apart = vectors
    a, b, c, d = zero, zero, zero, zero
    for _ in range(count):
        prefetch(numbers, place + _AHEAD)
        x = load(zero, rows, begin)
        a, b = added_multiple(a, numbers, place, x), added_multiple(b, numbers, place + 1, x)
        c, d = added_multiple(c, numbers, place + 2, x), added_multiple(d, numbers, place + 3, x)
        place, begin = place + TILE // 2, begin + apart
    found, first, step = sums
    _put((a, b, c, d), found, first, step)


@compiled_inline
def _sum_turned(
    numbers: Floats,
    place: int,
    count: int,
    vectors: Rows,
    sums: Rows,
    zero: Lanes,
) -> None:
    """Four vectors and as many lines as `zero` has lanes: a register for all lines.

    It meets every vector as these are turned in a circle past it.
    """
    rows, begin, apart = vectors
    a, b, c, d = zero, zero, zero, zero
    for _ in range(count):
        prefetch(numbers, place + _AHEAD)
        x, line = load_fours(zero, rows, begin), load(zero, numbers, place)
        a, b = added_product(a, line, x), added_product(b, line, turned_once(x))
        c, d = added_product(c, line, turned_twice(x)), added_product(d, line, turned_thrice(x))
        place, begin = place + width(zero), begin + apart
    found, first, _ = sums
    _put(_dealt(a, b, c, d), found, first, width(zero))


@compiled_inline
def _sum_two_turned(
    numbers: Floats,
    place: int,
    count: int,
    vectors: Rows,
    sums: Rows,
    zero: Lanes,
) -> None:
    """The same with two tiles, of eight lines each."""
    rows, begin, apart = vectors
    a, b, c, d, e, f, g, h = zero, zero, zero, zero, zero, zero, zero, zero
    other = place + TILE * count
    for _ in range(count):
        prefetch(numbers, place + _AHEAD)
        prefetch(numbers, other + _AHEAD)
        x = load_fours(zero, rows, begin)
        y, z, w = turned_once(x), turned_twice(x), turned_thrice(x)
        line = load(zero, numbers, place)
        a, b = added_product(a, line, x), added_product(b, line, y)
        c, d = added_product(c, line, z), added_product(d, line, w)
        line = load(zero, numbers, other)
        e, f = added_product(e, line, x), added_product(f, line, y)
        g, h = added_product(g, line, z), added_product(h, line, w)
        place, other, begin = place + TILE, other + TILE, begin + apart
    found, first, _ = sums
    _put(_dealt(a, b, c, d), found, first, TILE)
    _put(_dealt(e, f, g, h), found, first + 4 * TILE, TILE)


@compiled_inline
def _dealt(a: Lanes, b: Lanes, c: Lanes, d: Lanes) -> tuple[Lanes, Lanes, Lanes, Lanes]:
    """What was turned in place again, line by line."""
    return (
        dealt_first(a, b, c, d),
        dealt_second(a, b, c, d),
        dealt_third(a, b, c, d),
        dealt_fourth(a, b, c, d),
    )


@compiled_inline
def _put(lanes: tuple[Lanes, Lanes, Lanes, Lanes], found: Floats, place: int, step: int) -> None:
    a, b, c, d = lanes
    store(a, found, place)
    store(b, found, place + step)
    store(c, found, place + 2 * step)
    store(d, found, place + 3 * step)
