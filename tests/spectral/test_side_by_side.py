"""Vectors turned."""

import numpy as np
import pytest

from auricle.spectral.side_by_side import set_side_by_side


@pytest.mark.parametrize(
    ("count", "lanes"), [(0, 4), (1, 4), (3, 4), (4, 4), (5, 8), (8, 8), (13, 16)]
)
def test_entries_lie_side_by_side(rng, count, lanes) -> None:
    rows, columns = rng.standard_normal((count, 37)), np.zeros(37 * lanes)
    set_side_by_side(rows, columns, lanes)
    filled = np.zeros((37, lanes))
    filled[:, :count] = rows.T
    np.testing.assert_array_equal(columns.reshape(37, lanes), filled)
