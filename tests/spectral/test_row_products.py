"""A sparse matrix times many rows."""

import numpy as np
import pytest
from scipy import sparse

from auricle.spectral.row_products import row_products, row_quotients


@pytest.mark.parametrize("count", [0, 1, 3, 4, 5, 8, 21])
def test_rows_are_multiplied_as_a_matrix_library_does(rng, count) -> None:
    half = sparse.random_array((57, 57), density=0.1, rng=rng)
    matrix = sparse.csc_array(half + half.T)
    rows = rng.standard_normal((count, 57))
    np.testing.assert_allclose(row_products(matrix, rows), (matrix @ rows.T).T, atol=1e-14)


def test_rows_that_lie_apart_in_memory_are_multiplied_too(rng) -> None:
    matrix = sparse.csc_array(np.diag([1.0, 2.0, 3.0]))
    columns = rng.standard_normal((3, 2))
    np.testing.assert_array_equal(row_products(matrix, columns.T), (matrix @ columns).T)


@pytest.mark.parametrize("count", [0, 1, 3, 4, 5, 8, 21])
@pytest.mark.parametrize("off", [0.0, 1e-3, 100.0])
def test_quotients_and_what_is_beyond_are_those_of_the_definition(rng, count, off) -> None:
    half = sparse.random_array((57, 57), density=0.1, rng=rng)
    matrix = sparse.csc_array(half + half.T)
    rows = rng.standard_normal((count, 57))
    images, sizes = (matrix @ rows.T).T, (rows**2).sum(axis=1)
    values = (images * rows).sum(axis=1) / sizes
    beyond = np.linalg.norm(images - values[:, None] * rows, axis=1)
    scaling = rng.uniform(0.1, 1.0, 57)
    scaled = np.linalg.norm(scaling * (images - values[:, None] * rows), axis=1)
    found = row_quotients(matrix, rows, values + off, scaling)
    np.testing.assert_allclose(found.values, values, atol=1e-12)
    np.testing.assert_allclose(found.norms, beyond, rtol=1e-10)
    np.testing.assert_allclose(found.scaled_norms, scaled, rtol=1e-10)
    np.testing.assert_allclose(found.stretched, np.linalg.norm(rows / scaling, axis=1), rtol=1e-13)


def test_quotients_of_a_part_of_columns_side_by_side_are_the_same(rng) -> None:
    matrix = sparse.csc_array(sparse.diags_array(np.arange(1.0, 91.0)))
    room, scaling = rng.standard_normal((90, 31)), np.ones(90)
    apart = row_quotients(matrix, np.ascontiguousarray(room[:, 2:29].T), np.zeros(27), scaling)
    beside = row_quotients(matrix, room[:, 2:29].T, np.zeros(27), scaling)
    np.testing.assert_array_equal(apart.values, beside.values)
    np.testing.assert_array_equal(apart.norms, beside.norms)


def test_what_an_eigenvector_leaves_is_seen_however_little_it_is() -> None:
    matrix = sparse.csc_array(sparse.diags_array(np.arange(1.0, 9.0)))
    row = np.eye(8)[2:3] + 1e-11 * np.eye(8)[6:7]
    found = row_quotients(matrix, row, np.array([3.0]), np.full(8, 0.5))
    np.testing.assert_allclose(found.norms, 4e-11, rtol=1e-6)
    np.testing.assert_allclose(found.scaled_norms, 2e-11, rtol=1e-6)
