"""A sparse matrix times many rows."""

import numpy as np
import pytest
from scipy import sparse

from auricle.spectral.row_products import row_products


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
