"""Products of vectors in groups are those of the vectors."""

import numpy as np
import pytest
from numba import njit

from auricle.spectral.lanes import eight, four
from auricle.spectral.narrow_products import (
    aligned_groups,
    combine,
    copy_entries,
    project,
    subtract,
    subtract_and_measure,
)

ZEROS = {4: four, 8: eight}


def with_lanes(work, lanes: int):
    """A function of compiled code, whose last argument that gives it."""
    zero = ZEROS[lanes]
    return njit(lambda *arguments: work(*arguments, zero(0.0)))


LENGTHS = [1, 7, 511, 1300]
"""Less than a strip, not a multiple of a register, and more than one strip."""


def grouped(rng, count: int, n: int, lanes: int):
    groups = aligned_groups(count, n, lanes)
    groups[:] = rng.standard_normal(groups.shape)
    return groups


def rows_of(groups):
    return groups.swapaxes(1, 2).reshape(-1, groups.shape[1])


@pytest.mark.parametrize("n", LENGTHS)
@pytest.mark.parametrize("lanes", [4, 8])
@pytest.mark.parametrize(
    ("n_basis", "n_block"), [(0, 1), (1, 1), (2, 3), (3, 2), (5, 1), (11, 1), (9, 2)]
)
def test_products_are_those_of_the_vectors(rng, n, lanes, n_basis, n_block) -> None:
    basis, block = grouped(rng, n_basis, n, lanes), grouped(rng, n_block, n, lanes)
    before = rng.standard_normal((n_basis * lanes, n_block * lanes))
    coefficients = before.copy()
    with_lanes(project, lanes)(basis, block, coefficients)
    np.testing.assert_allclose(coefficients, before + rows_of(basis) @ rows_of(block).T, atol=1e-11)
    expected = rows_of(block) - coefficients.T @ rows_of(basis)
    again, products = block.copy(), rng.standard_normal((n_block * lanes, n_block * lanes))
    products += products.T
    left = products + expected @ expected.T
    with_lanes(subtract, lanes)(basis, coefficients, block)
    np.testing.assert_allclose(rows_of(block), expected, atol=1e-10)
    with_lanes(subtract_and_measure, lanes)(basis, coefficients, again, products)
    np.testing.assert_array_equal(again, block)
    np.testing.assert_allclose(products, left, rtol=1e-12, atol=1e-10 * np.abs(left).max())


@pytest.mark.parametrize("n", LENGTHS)
@pytest.mark.parametrize("lanes", [4, 8])
@pytest.mark.parametrize("n_block", [1, 2, 3])
def test_vectors_are_combined(rng, n, lanes, n_block) -> None:
    block = grouped(rng, n_block, n, lanes)
    factors = rng.standard_normal((n_block * lanes, n_block * lanes))
    expected = factors @ rows_of(block)
    with_lanes(combine, lanes)(factors, block)
    np.testing.assert_allclose(rows_of(block), expected, atol=1e-12)


@pytest.mark.parametrize("lanes", [4, 8])
def test_entries_are_copied_from_a_place_on(rng, lanes) -> None:
    groups, entries = grouped(rng, 3, 50, lanes), np.empty((20, 3 * lanes))
    with_lanes(copy_entries, lanes)(groups, 25, entries)
    np.testing.assert_array_equal(entries, rows_of(groups)[:, 25:45].T)


@pytest.mark.parametrize(("n", "lanes"), [(8, 8), (13, 4), (1001, 8)])
def test_no_register_straddles_two_lines_of_the_cache(n, lanes) -> None:
    groups = aligned_groups(3, n, lanes)
    assert groups.shape == (3, n, lanes)
    assert groups.flags.c_contiguous
    assert groups.ctypes.data % 64 == 0
