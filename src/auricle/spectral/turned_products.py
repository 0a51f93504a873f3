"""Products of sixteen long vectors with four: a register of two vertices for every four vectors.

A number of one vector meets the four of a vertex if these are turned past it in a circle, so that
a register of eight numbers does what eight registers would, each filled with one of them. Vectors
lie in groups of four, as `auricle.spectral.narrow_products` takes them.
"""

from typing import TypeAlias

from auricle.arrays import Floats
from auricle.compiled import compiled_in_place, compiled_inline
from auricle.spectral.lanes import (
    Lanes,
    added,
    added_product,
    eight,
    load,
    prefetch,
    store,
    turned_once,
    turned_thrice,
    turned_twice,
)

SIXTEEN = 4
"""Groups that are taken together."""
PAIR = 8
"""Numbers of two vertices."""
_AHEAD = 512
"""How far ahead numbers are asked for."""
_Four: TypeAlias = tuple[Lanes, Lanes, Lanes, Lanes]
_Part: TypeAlias = tuple[Floats, int, int]
"""Part of some groups: the numbers, where the first group's part begins, and how far apart those of
two groups are."""


@compiled_in_place
def project_sixteen(
    basis: _Part, block: tuple[Floats, int], count: int, target: tuple[Floats, int, Floats]
) -> None:
    """Add the products of four groups with another, over `count` vertices, to 16 by 4 sums.

    `target` is their array, where in it they begin, and room for two vertices.
    """
    numbers, p, apart = basis
    others, q = block
    zero = eight(0.0)
    nothing = (zero, zero, zero, zero)
    a, b, c, d = nothing, nothing, nothing, nothing
    for _ in range(count // 2):
        for group in range(SIXTEEN):
            prefetch(numbers, p + group * apart + _AHEAD)
        x = load(zero, others, q)
        turned = (x, turned_once(x), turned_twice(x), turned_thrice(x))
        a = _met(a, load(zero, numbers, p), turned)
        b = _met(b, load(zero, numbers, p + apart), turned)
        c = _met(c, load(zero, numbers, p + 2 * apart), turned)
        d = _met(d, load(zero, numbers, p + 3 * apart), turned)
        p, q = p + PAIR, q + PAIR
    sums, place, room = target
    for group, found in enumerate((a, b, c, d)):
        _add_turned(found, sums, place + group * 16, room)
    if count % 2 == 1:
        for row in range(16):
            number = numbers[p + row // 4 * apart + row % 4]
            for i in range(4):
                sums[place + row * 4 + i] += number * others[q + i]


@compiled_in_place
def project_itself(
    block: tuple[Floats, int], count: int, target: tuple[Floats, int, Floats]
) -> None:
    """Add the products of a group with itself, over `count` vertices, to 4 by 4 symmetric sums.

    The product of two vectors is found once, and put in both of its places.
    """
    others, q = block
    zero = eight(0.0)
    a, b, c = zero, zero, zero
    for _ in range(count // 2):
        x = load(zero, others, q)
        a, b = added_product(a, x, x), added_product(b, x, turned_once(x))
        c = added_product(c, x, turned_twice(x))
        q += PAIR
    sums, place, room = target
    _add_turned((a, b, c, zero), sums, place, room)
    for j in range(4):
        sums[place + 4 * ((j + 1) % 4) + j] = sums[place + 4 * j + (j + 1) % 4]
    if count % 2 == 1:
        for j in range(4):
            for i in range(4):
                sums[place + j * 4 + i] += others[q + j] * others[q + i]


@compiled_inline
def _met(sums: _Four, line: Lanes, turned: _Four) -> _Four:
    """Sums with the products of a register and four others."""
    a, b, c, d = sums
    x, y, z, w = turned
    return (
        added_product(a, line, x),
        added_product(b, line, y),
        added_product(c, line, z),
        added_product(d, line, w),
    )


@compiled_in_place
def _add_turned(found: _Four, sums: Floats, place: int, room: Floats) -> None:
    """Add to 4 by 4 sums what they were turned to: of row j column j, j + 1, j + 2, j + 3."""
    for turn, lanes in enumerate(found):
        store(lanes, room, 0)
        for j in range(4):
            sums[place + 4 * j + (j + turn) % 4] += room[j] + room[4 + j]


@compiled_in_place
def subtract_sixteen(
    basis: _Part, source: tuple[Floats, int, Floats], block: tuple[Floats, int], count: int
) -> None:
    """Take multiples of the vectors of four groups out of another.

    `source` is an array, where in it 16 by 4 factors begin, and room for two vertices.
    """
    numbers, p, apart = basis
    factors, place, room = source
    others, q = block
    zero = eight(0.0)
    a, b = _turned_rows(factors, place, room), _turned_rows(factors, place + 16, room)
    c, d = _turned_rows(factors, place + 32, room), _turned_rows(factors, place + 48, room)
    for _ in range(count // 2):
        for group in range(SIXTEEN):
            prefetch(numbers, p + group * apart + _AHEAD)
        sums = _met((load(zero, others, q), zero, zero, zero), load(zero, numbers, p), a)
        sums = _met(sums, load(zero, numbers, p + apart), b)
        sums = _met(sums, load(zero, numbers, p + 2 * apart), c)
        x, y, z, w = _met(sums, load(zero, numbers, p + 3 * apart), d)
        x, z = added(x, turned_thrice(y)), added(turned_twice(z), turned_once(w))
        store(added(x, z), others, q)
        p, q = p + PAIR, q + PAIR
    if count % 2 == 1:
        for row in range(16):
            number = numbers[p + row // 4 * apart + row % 4]
            for i in range(4):
                others[q + i] -= factors[place + row * 4 + i] * number


@compiled_in_place
def _turned_rows(factors: Floats, place: int, room: Floats) -> _Four:
    """Of 4 by 4 factors with their sign changed, what turned sums are made of."""
    a = _turned_row(factors, place, 0, room)
    b, c = _turned_row(factors, place, 1, room), _turned_row(factors, place, 2, room)
    return a, b, c, _turned_row(factors, place, 3, room)


@compiled_in_place
def _turned_row(factors: Floats, place: int, turn: int, room: Floats) -> Lanes:
    for j in range(4):
        room[j] = room[4 + j] = -factors[place + 4 * j + (j + turn) % 4]
    return load(eight(0.0), room, 0)
