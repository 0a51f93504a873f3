"""Schur complements are those of linear algebra."""

import numpy as np
import pytest

from auricle.spectral.factor_streams import FactorStreams, down_size, pack, up_size
from auricle.spectral.schur_complements import complement_size, multiply
from auricle.spectral.tile_sums import TILE


def rows_of(stored, n_rows: int):
    """The lower triangle, row by row as it is documented to be stored."""
    filled_up, place, rows = n_rows + -n_rows % 8, 0, []
    for row in range(n_rows):
        rows.append(stored[place : place + row + 1])
        place += min((row // 64 + 1) * 64, filled_up)
    return rows


@pytest.mark.parametrize("n_columns", [1, 5, 19])
@pytest.mark.parametrize("n_rows", [0, 1, 3, 8, 13, 64, 70, 131])
def test_the_lower_triangle_is_that_of_the_product(rng, n_rows, n_columns) -> None:
    factor = rng.standard_normal((n_columns + n_rows + TILE, n_columns))
    under = rng.standard_normal((n_rows, n_columns))
    streams = FactorStreams(
        np.zeros(down_size(n_columns, n_rows)), np.zeros(up_size(n_columns, n_rows))
    )
    pack(factor, n_columns + n_rows, streams, (0, 0))
    size = complement_size(n_rows)
    complement = np.full(size + 5, np.pi)
    multiply(streams.down, 0, under, complement, np.zeros(TILE * n_columns))
    expected = factor[n_columns : n_columns + n_rows] @ under.T
    for row, stored in enumerate(rows_of(complement, n_rows)):
        np.testing.assert_allclose(stored, expected[row, : row + 1], atol=1e-12)
    assert (complement[size:] == np.pi).all()
