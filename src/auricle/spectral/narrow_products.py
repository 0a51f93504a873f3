"""Products of many long vectors with few: taken together, and taken from each other.

Vectors lie in groups of four or eight, entry beside entry: an array of shape (g, n, lanes) holds g
groups. So a group is read as one stream of whole registers, and what multiplies a register is one
number of another group. Tall and narrow products leave a matrix library waiting for memory; these
kernels keep eight vectors' products with sixteen in registers, and read the many once a pass.
"""

from typing import TypeAlias

import numpy as np

from auricle.arrays import Floats
from auricle.compiled import compiled, compiled_in_place
from auricle.spectral.lanes import (
    Lanes,
    added,
    added_multiple,
    aligned,
    load,
    prefetch,
    store,
    subtracted,
    width,
)
from auricle.spectral.turned_products import (
    PAIR,
    SIXTEEN,
    project_itself,
    project_sixteen,
    subtract_sixteen,
)

Groups: TypeAlias = Floats
"""Vectors in groups, shape (g, n, lanes), contiguous; four or eight lanes."""
_Strip: TypeAlias = tuple[Floats, int, int, int]
"""Part of some groups: the numbers, where in them the first group's part begins, how far apart
those of two groups are, and how many groups there are."""
_Places: TypeAlias = tuple[int, int, int, int, int]
"""Where four basis vectors begin, where four others do, where a group of the block does, how far on
its next one lies, and how far ahead basis vectors are asked for."""
_Eight: TypeAlias = tuple[Lanes, Lanes, Lanes, Lanes, Lanes, Lanes, Lanes, Lanes]
_STRIP, _AHEAD = 2048, 1024
"""Numbers of a group that are worked on at a time and stay in the cache, and how far ahead they are
asked for."""


def aligned_groups(count: int, n: int, lanes: int) -> Groups:
    """Room for so many groups of vectors of length n, each register within a line of the cache."""
    return aligned(count * n * lanes).reshape(count, n, lanes)


@compiled
def project(basis: Groups, block: Groups, coefficients: Floats, zero: Lanes) -> None:
    """Add every basis vector's products with those of the block to `coefficients`.

    Shape (m, b), contiguous, for m and b vectors. A strip of the basis is read once for all of the
    block, which stays in the cache. Here and below `zero` has as many lanes as the groups.
    """
    length, target = _STRIP // width(zero), (coefficients.reshape(-1), np.empty(PAIR))
    for begin in range(0, basis.shape[1], length):
        count = min(length, basis.shape[1] - begin)
        _project_strip(_strip(basis, begin), _strip(block, begin), count, target, zero)


@compiled
def _strip(groups: Groups, begin: int) -> _Strip:
    """The part of groups from a vertex on."""
    n, lanes = groups.shape[1], groups.shape[2]
    return groups.reshape(-1), begin * lanes, n * lanes, len(groups)


@compiled_in_place
def _project_strip(
    basis: _Strip, block: _Strip, count: int, products: tuple[Floats, Floats], zero: Lanes
) -> None:
    sums, room = products
    numbers, first, apart, n_groups = basis
    others, begin, aside, n_block = block
    lanes, done = width(zero), 0
    if lanes == 4 and n_block == 1:
        done = n_groups - n_groups % SIXTEEN
        for g in range(0, done, SIXTEEN):
            part = (numbers, first + g * apart, apart)
            project_sixteen(part, (others, begin), count, (sums, g * lanes * lanes, room))
    for g in range(done, n_groups, 8 // lanes):
        second, n_rows = _second_four(g, basis, lanes)
        p, ahead = first + g * apart, _AHEAD
        for q in range(0, n_block, 2):
            places = (p, p + second, begin + q * aside, aside, ahead)
            target = (sums, (g * lanes * n_block + q) * lanes, n_block * lanes, n_rows)
            if q + 1 < n_block:
                _project_on_two(numbers, others, places, count, target, zero)
            else:
                _project_on_one(numbers, others, places, count, target, zero)
            ahead = 0


@compiled_in_place
def _second_four(g: int, basis: _Strip, lanes: int) -> tuple[int, int]:
    """Where the second four of eight vectors begin, from the first on; and how many there are.

    Where there are but four left, these are gone through twice, the second time for nothing.
    """
    _, _, apart, n_groups = basis
    if lanes == 8:
        return 4, 8
    return (apart, 8) if g + 1 < n_groups else (0, 4)


@compiled_in_place
def _project_on_two(
    numbers: Floats,
    others: Floats,
    places: _Places,
    count: int,
    target: tuple[Floats, int, int, int],
    zero: Lanes,
) -> None:
    """Add eight vectors' products with two groups to sixteen registers' worth of sums."""
    p, r, q, aside, ahead = places
    a0, a1, a2, a3 = zero, zero, zero, zero
    a4, a5, a6, a7 = zero, zero, zero, zero
    b0, b1, b2, b3 = zero, zero, zero, zero
    b4, b5, b6, b7 = zero, zero, zero, zero
    for _ in range(count):
        prefetch(numbers, p + ahead)
        prefetch(numbers, r + ahead)
        x, y = load(zero, others, q), load(zero, others, q + aside)
        a0, b0 = added_multiple(a0, numbers, p, x), added_multiple(b0, numbers, p, y)
        a1, b1 = added_multiple(a1, numbers, p + 1, x), added_multiple(b1, numbers, p + 1, y)
        a2, b2 = added_multiple(a2, numbers, p + 2, x), added_multiple(b2, numbers, p + 2, y)
        a3, b3 = added_multiple(a3, numbers, p + 3, x), added_multiple(b3, numbers, p + 3, y)
        a4, b4 = added_multiple(a4, numbers, r, x), added_multiple(b4, numbers, r, y)
        a5, b5 = added_multiple(a5, numbers, r + 1, x), added_multiple(b5, numbers, r + 1, y)
        a6, b6 = added_multiple(a6, numbers, r + 2, x), added_multiple(b6, numbers, r + 2, y)
        a7, b7 = added_multiple(a7, numbers, r + 3, x), added_multiple(b7, numbers, r + 3, y)
        p, r, q = p + width(zero), r + width(zero), q + width(zero)
    sums, place, apart, n_rows = target
    _add_rows((a0, a1, a2, a3, a4, a5, a6, a7), sums, place, apart, n_rows)
    _add_rows((b0, b1, b2, b3, b4, b5, b6, b7), sums, place + width(zero), apart, n_rows)


@compiled_in_place
def _project_on_one(
    numbers: Floats,
    others: Floats,
    places: _Places,
    count: int,
    target: tuple[Floats, int, int, int],
    zero: Lanes,
) -> None:
    """The same with one group."""
    p, r, q, _, ahead = places
    a0, a1, a2, a3 = zero, zero, zero, zero
    a4, a5, a6, a7 = zero, zero, zero, zero
    for _ in range(count):
        prefetch(numbers, p + ahead)
        prefetch(numbers, r + ahead)
        x = load(zero, others, q)
        a0, a1 = added_multiple(a0, numbers, p, x), added_multiple(a1, numbers, p + 1, x)
        a2, a3 = added_multiple(a2, numbers, p + 2, x), added_multiple(a3, numbers, p + 3, x)
        a4, a5 = added_multiple(a4, numbers, r, x), added_multiple(a5, numbers, r + 1, x)
        a6, a7 = added_multiple(a6, numbers, r + 2, x), added_multiple(a7, numbers, r + 3, x)
        p, r, q = p + width(zero), r + width(zero), q + width(zero)
    sums, place, apart, n_rows = target
    _add_rows((a0, a1, a2, a3, a4, a5, a6, a7), sums, place, apart, n_rows)


@compiled_in_place
def _add_rows(rows: _Eight, sums: Floats, place: int, apart: int, n_rows: int) -> None:
    """Add the first of eight registers to as many rows of a matrix, a column's worth."""
    left = n_rows
    for row in rows:
        if left > 0:
            store(added(load(row, sums, place), row), sums, place)
        place, left = place + apart, left - 1


@compiled
def subtract(basis: Groups, coefficients: Floats, block: Groups, zero: Lanes) -> None:
    """Take coefficientsᵀ·basis out of `block`, a strip at a time that stays in the cache."""
    length, source = _STRIP // width(zero), (coefficients.reshape(-1), np.empty(PAIR))
    for begin in range(0, basis.shape[1], length):
        count = min(length, basis.shape[1] - begin)
        _subtract_strip(_strip(basis, begin), _strip(block, begin), count, source, zero)


@compiled
def subtract_and_measure(
    basis: Groups, coefficients: Floats, block: Groups, products: Floats, zero: Lanes
) -> None:
    """As `subtract`, and add the inner products of what is left to `products`.

    These are symmetric, shape (b, b).
    What is left of a strip is still near by when it is measured.
    """
    length, room = _STRIP // width(zero), np.empty(PAIR)
    source, target = (coefficients.reshape(-1), room), (products.reshape(-1), room)
    for begin in range(0, block.shape[1], length):
        count = min(length, block.shape[1] - begin)
        own = _strip(block, begin)
        _subtract_strip(_strip(basis, begin), own, count, source, zero)
        if width(zero) == 4 and len(block) == 1:
            project_itself((own[0], own[1]), count, (target[0], 0, room))
        else:
            _project_strip(own, own, count, target, zero)


@compiled
def combine(factors: Floats, block: Groups, zero: Lanes) -> None:
    """Turn the vectors of a block into factors·vectors, in place; `factors` has shape (b, b)."""
    coefficients = np.ascontiguousarray(-factors.T)
    if len(block) == 1:
        second, n_rows = _second_four(0, _strip(block, 0), width(zero))
        rows = _eight_rows(coefficients.reshape(-1), 0, width(zero), n_rows, zero)
        _combine_one(block.reshape(-1), block.shape[1], second, rows)
    else:
        old = block.copy()
        block[:] = 0.0
        subtract(old, coefficients, block, zero)


@compiled_in_place
def _combine_one(numbers: Floats, n: int, second: int, c: _Eight) -> None:
    """Turn a group into multiples of itself, n entries that each depend on no other."""
    c0, c1, c2, c3, c4, c5, c6, c7 = c
    zero, p = subtracted(c0, c0), 0
    for _ in range(n):
        r = p + second
        x, y = added_multiple(zero, numbers, p, c0), added_multiple(zero, numbers, p + 1, c1)
        x, y = added_multiple(x, numbers, p + 2, c2), added_multiple(y, numbers, p + 3, c3)
        x, y = added_multiple(x, numbers, r, c4), added_multiple(y, numbers, r + 1, c5)
        x, y = added_multiple(x, numbers, r + 2, c6), added_multiple(y, numbers, r + 3, c7)
        store(added(x, y), numbers, p)
        p += width(c0)


@compiled_in_place
def _subtract_strip(
    basis: _Strip, block: _Strip, count: int, multiples: tuple[Floats, Floats], zero: Lanes
) -> None:
    factors, room = multiples
    numbers, first, apart, n_groups = basis
    others, begin, aside, n_block = block
    lanes, done = width(zero), 0
    if lanes == 4 and n_block == 1:
        done = n_groups - n_groups % SIXTEEN
        for g in range(0, done, SIXTEEN):
            part = (numbers, first + g * apart, apart)
            subtract_sixteen(part, (factors, g * lanes * lanes, room), (others, begin), count)
    for g in range(done, n_groups, 8 // lanes):
        second, n_rows = _second_four(g, basis, lanes)
        p, ahead = first + g * apart, _AHEAD
        for q in range(0, n_block, 2):
            places = (p, p + second, begin + q * aside, aside, ahead)
            place, stride = (g * lanes * n_block + q) * lanes, n_block * lanes
            c = _eight_rows(factors, place, stride, n_rows, zero)
            if q + 1 < n_block:
                d = _eight_rows(factors, place + lanes, stride, n_rows, zero)
                _subtract_from_two(numbers, others, places, count, c, d)
            else:
                _subtract_from_one(numbers, others, places, count, c)
            ahead = 0


@compiled_in_place
def _eight_rows(factors: Floats, place: int, stride: int, n_rows: int, zero: Lanes) -> _Eight:
    """Of a matrix a column's worth of eight rows with their sign changed; 0 beyond the first."""
    a, b = _minus(factors, place, zero), _minus(factors, place + stride, zero)
    c, d = _minus(factors, place + 2 * stride, zero), _minus(factors, place + 3 * stride, zero)
    if n_rows == 4:
        return a, b, c, d, zero, zero, zero, zero
    place += 4 * stride
    e, f = _minus(factors, place, zero), _minus(factors, place + stride, zero)
    g, h = _minus(factors, place + 2 * stride, zero), _minus(factors, place + 3 * stride, zero)
    return a, b, c, d, e, f, g, h


@compiled_in_place
def _minus(factors: Floats, place: int, zero: Lanes) -> Lanes:
    return subtracted(zero, load(zero, factors, place))


@compiled_in_place
def _subtract_from_two(
    numbers: Floats,
    others: Floats,
    places: _Places,
    count: int,
    c: _Eight,
    d: _Eight,
) -> None:
    """Add multiples of eight vectors to two groups."""
    p, r, q, aside, ahead = places
    c0, c1, c2, c3, c4, c5, c6, c7 = c
    d0, d1, d2, d3, d4, d5, d6, d7 = d
    for _ in range(count):
        prefetch(numbers, p + ahead)
        prefetch(numbers, r + ahead)
        x, y = load(c0, others, q), load(c0, others, q + aside)
        x, y = added_multiple(x, numbers, p, c0), added_multiple(y, numbers, p, d0)
        x, y = added_multiple(x, numbers, p + 1, c1), added_multiple(y, numbers, p + 1, d1)
        x, y = added_multiple(x, numbers, p + 2, c2), added_multiple(y, numbers, p + 2, d2)
        x, y = added_multiple(x, numbers, p + 3, c3), added_multiple(y, numbers, p + 3, d3)
        x, y = added_multiple(x, numbers, r, c4), added_multiple(y, numbers, r, d4)
        x, y = added_multiple(x, numbers, r + 1, c5), added_multiple(y, numbers, r + 1, d5)
        x, y = added_multiple(x, numbers, r + 2, c6), added_multiple(y, numbers, r + 2, d6)
        x, y = added_multiple(x, numbers, r + 3, c7), added_multiple(y, numbers, r + 3, d7)
        store(x, others, q)
        store(y, others, q + aside)
        p, r, q = p + width(c0), r + width(c0), q + width(c0)


@compiled_in_place
def _subtract_from_one(
    numbers: Floats, others: Floats, places: _Places, count: int, c: _Eight
) -> None:
    """The same with one group."""
    p, r, q, _, ahead = places
    c0, c1, c2, c3, c4, c5, c6, c7 = c
    for _ in range(count):
        prefetch(numbers, p + ahead)
        prefetch(numbers, r + ahead)
        x, y = load(c0, others, q), subtracted(c0, c0)
        x, y = added_multiple(x, numbers, p, c0), added_multiple(y, numbers, p + 1, c1)
        x, y = added_multiple(x, numbers, p + 2, c2), added_multiple(y, numbers, p + 3, c3)
        x, y = added_multiple(x, numbers, r, c4), added_multiple(y, numbers, r + 1, c5)
        x, y = added_multiple(x, numbers, r + 2, c6), added_multiple(y, numbers, r + 3, c7)
        store(added(x, y), others, q)
        p, r, q = p + width(c0), r + width(c0), q + width(c0)


@compiled
def copy_entries(groups: Groups, begin: int, entries: Floats, zero: Lanes) -> None:
    """Fill `entries`, shape (c, m), with those of all m vectors from `begin` on."""
    n, lanes = groups.shape[1], groups.shape[2]
    numbers, some = groups.reshape(-1), entries.reshape(-1)
    for g in range(len(groups)):
        p, q = (g * n + begin) * lanes, g * lanes
        for _ in range(len(entries)):
            prefetch(numbers, p + _AHEAD)
            store(load(zero, numbers, p), some, q)
            p, q = p + lanes, q + entries.shape[1]
