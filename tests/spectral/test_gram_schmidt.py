"""Block Gram-Schmidt: orthogonal to rounding, whatever it is given."""

import numpy as np
import pytest

from auricle.spectral.gram_schmidt import aligned_rows, lengths, orthogonalize, orthonormalize


def orthonormal_rows(rng, count: int, n: int):
    return np.ascontiguousarray(np.linalg.qr(rng.standard_normal((n, count)))[0].T)


@pytest.mark.parametrize("n_basis", [0, 1, 3, 4, 37])
@pytest.mark.parametrize("n_block", [1, 3, 4, 8])
def test_what_is_left_is_perpendicular_and_what_was_taken_adds_up(rng, n_basis, n_block) -> None:
    basis, block = orthonormal_rows(rng, n_basis, 1300), rng.standard_normal((n_block, 1300))
    before = block.copy()
    taken = orthogonalize(basis, block)
    np.testing.assert_allclose(basis @ block.T, 0.0, atol=1e-13)
    np.testing.assert_allclose(taken.T @ basis + block, before, atol=1e-12)


def test_a_block_almost_inside_the_basis_is_still_made_perpendicular(rng) -> None:
    basis = orthonormal_rows(rng, 20, 1000)
    block = rng.standard_normal((8, 20)) @ basis + 1e-9 * rng.standard_normal((8, 1000))
    orthogonalize(basis, block)
    cosines = basis @ block.T / np.linalg.norm(block, axis=1)
    assert np.abs(cosines).max() < 1e-13


@pytest.mark.parametrize("spread", [0.0, 3.0, 9.0, 14.0])
def test_rows_become_orthonormal_and_the_triangle_gives_them_back(rng, spread) -> None:
    rotation = orthonormal_rows(rng, 8, 8)
    block = rotation * np.logspace(0, -spread, 8) @ orthonormal_rows(rng, 8, 2000)
    rows = block.copy()
    triangle = orthonormalize(rows)
    np.testing.assert_allclose(rows @ rows.T, np.eye(8), atol=1e-13)
    np.testing.assert_allclose(triangle @ rows, block, atol=1e-13)
    np.testing.assert_array_equal(triangle, np.tril(triangle))


def test_rows_of_very_unequal_size_are_no_trouble(rng) -> None:
    rows = rng.standard_normal((4, 500)) * np.array([[1e12], [1.0], [1e-9], [1e-200]])
    orthonormalize(rows)
    np.testing.assert_allclose(rows @ rows.T, np.eye(4), atol=1e-13)


@pytest.mark.parametrize("length", [8, 13, 1000])
def test_every_aligned_row_begins_with_a_line_of_the_cache(length) -> None:
    rows = aligned_rows(5, length)
    assert rows.shape == (5, length + -length % 8)
    assert rows.flags.c_contiguous
    assert all(row.ctypes.data % 64 == 0 for row in rows)


@pytest.mark.parametrize("n", [1, 7, 8, 1003])
def test_lengths_are_those_of_the_rows(rng, n) -> None:
    rows = rng.standard_normal((5, n))
    np.testing.assert_allclose(lengths(rows), np.linalg.norm(rows, axis=1), rtol=1e-14)
