"""Block Gram-Schmidt: orthogonal to rounding, whatever it is given."""

import numpy as np
import pytest

from auricle.spectral.gram_schmidt import orthogonalize, orthonormalize


def orthonormal_rows(rng, count: int, n: int):
    return np.linalg.qr(rng.standard_normal((n, count)))[0].T


def grouped(rows, lanes: int):
    """In groups, the last filled up with zeros."""
    count, n = rows.shape
    full = np.zeros((count + -count % lanes, n))
    full[:count] = rows
    return np.ascontiguousarray(full.reshape(-1, lanes, n).swapaxes(1, 2))


def rows_of(groups):
    return groups.swapaxes(1, 2).reshape(-1, groups.shape[1])


@pytest.mark.parametrize("n_basis", [0, 1, 3, 4, 37])
@pytest.mark.parametrize("n_block", [1, 2])
@pytest.mark.parametrize("lanes", [4, 8])
def test_what_is_left_is_perpendicular_and_what_was_taken_adds_up(
    rng, n_basis, n_block, lanes
) -> None:
    basis = grouped(orthonormal_rows(rng, n_basis, 1300), lanes)
    block = rng.standard_normal((n_block, 1300, lanes))
    before = rows_of(block).copy()
    taken, products = orthogonalize(basis, block)
    np.testing.assert_allclose(rows_of(basis) @ rows_of(block).T, 0.0, atol=1e-13)
    np.testing.assert_allclose(taken.T @ rows_of(basis) + rows_of(block), before, atol=1e-12)
    left = rows_of(block)
    np.testing.assert_allclose(products, left @ left.T, rtol=1e-12, atol=1e-9)


def test_a_block_almost_inside_the_basis_is_still_made_perpendicular(rng) -> None:
    rows = orthonormal_rows(rng, 24, 1000)
    inside = rng.standard_normal((8, 24)) @ rows + 1e-9 * rng.standard_normal((8, 1000))
    basis, block = grouped(rows, 8), grouped(inside, 8)
    products = orthogonalize(basis, block).products
    left = rows_of(block)
    np.testing.assert_allclose(products, left @ left.T, rtol=1e-10, atol=1e-16 * 1e-12)
    cosines = rows @ left.T / np.linalg.norm(left, axis=1)
    assert np.abs(cosines).max() < 1e-13


@pytest.mark.parametrize("spread", [0.0, 3.0, 9.0, 14.0])
@pytest.mark.parametrize("lanes", [4, 8])
def test_vectors_become_orthonormal_and_the_triangle_gives_them_back(rng, spread, lanes) -> None:
    rotation = orthonormal_rows(rng, 8, 8)
    rows = rotation * np.logspace(0, -spread, 8) @ orthonormal_rows(rng, 8, 2000)
    block = grouped(rows, lanes)
    triangle = orthonormalize(block, rows @ rows.T)
    made = rows_of(block)
    np.testing.assert_allclose(made @ made.T, np.eye(8), atol=1e-13)
    np.testing.assert_allclose(triangle @ made, rows, atol=1e-13)
    np.testing.assert_array_equal(triangle, np.tril(triangle))


def test_vectors_of_very_unequal_size_are_no_trouble(rng) -> None:
    block = rng.standard_normal((1, 500, 4)) * np.array([1e12, 1.0, 1e-9, 1e-200])
    orthonormalize(block, rows_of(block) @ rows_of(block).T)
    np.testing.assert_allclose(rows_of(block) @ rows_of(block).T, np.eye(4), atol=1e-13)
