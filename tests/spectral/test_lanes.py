"""Arithmetic in registers is arithmetic, number by number."""

import numpy as np
import pytest

from auricle.arrays import Floats
from auricle.compiled import compiled
from auricle.spectral.lanes import (
    Lanes,
    added,
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
    store,
    subtracted,
    total,
    turned_once,
    turned_thrice,
    turned_twice,
    width,
)


@compiled
def in_four(numbers: Floats, others: Floats, results: Floats) -> int:
    return every_operation(four(0.5), numbers, others, results)


@compiled
def in_eight(numbers: Floats, others: Floats, results: Floats) -> int:
    return every_operation(eight(0.5), numbers, others, results)


@compiled
def every_operation(half: Lanes, numbers: Floats, others: Floats, results: Floats) -> int:
    x, y, n = load(half, numbers, 1), load(half, others, 2), width(half)
    store(added(x, y), results, 0)
    store(subtracted(x, y), results, n)
    store(added_product(half, x, y), results, 2 * n)
    store(added_multiple(half, numbers, 3, y), results, 3 * n)
    results[4 * n] = total(x)
    return n


@pytest.mark.parametrize("operations", [in_four, in_eight])
def test_each_operation_is_numpys_number_by_number(rng, operations) -> None:
    numbers, others = rng.standard_normal((2, 20))
    results = np.zeros(40)
    n = operations(numbers, others, results)
    x, y = numbers[1 : 1 + n], others[2 : 2 + n]
    expected = [*(x + y), *(x - y), *(0.5 + x * y), *(0.5 + numbers[3] * y), x.sum()]
    np.testing.assert_allclose(results[: 4 * n + 1], expected, rtol=1e-14, atol=1e-15)
    assert n == {in_four: 4, in_eight: 8}[operations]


@compiled
def past_four(lines: Floats, vectors: Floats, results: Floats) -> int:
    return every_turn(four(0.0), lines, vectors, results)


@compiled
def past_eight(lines: Floats, vectors: Floats, results: Floats) -> int:
    return every_turn(eight(0.0), lines, vectors, results)


@compiled
def every_turn(zero: Lanes, lines: Floats, vectors: Floats, results: Floats) -> int:
    x, line, n = load_fours(zero, vectors, 0), load(zero, lines, 0), width(zero)
    a, b = added_product(zero, line, x), added_product(zero, line, turned_once(x))
    c, d = (
        added_product(zero, line, turned_twice(x)),
        added_product(zero, line, turned_thrice(x)),
    )
    store(dealt_first(a, b, c, d), results, 0)
    store(dealt_second(a, b, c, d), results, n)
    store(dealt_third(a, b, c, d), results, 2 * n)
    store(dealt_fourth(a, b, c, d), results, 3 * n)
    return n


@pytest.mark.parametrize("operations", [past_four, past_eight])
def test_what_is_turned_past_a_register_meets_all_of_it_and_is_dealt_out_by_line(
    rng, operations
) -> None:
    lines, vectors, results = rng.standard_normal(8), rng.standard_normal(4), np.zeros(32)
    n = operations(lines, vectors, results)
    np.testing.assert_array_equal(results[: 4 * n].reshape(n, 4), np.outer(lines[:n], vectors))
