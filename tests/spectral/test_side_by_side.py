"""Vectors turned, and turned back."""

import numpy as np
import pytest

from auricle.spectral.side_by_side import set_apart, set_side_by_side


@pytest.mark.parametrize(
    ("count", "lanes"), [(0, 4), (1, 4), (3, 4), (4, 4), (5, 8), (8, 8), (13, 16)]
)
def test_entries_lie_side_by_side_in_the_order_asked_for(rng, count, lanes) -> None:
    rows, order = rng.standard_normal((count, 37)), rng.permutation(37)
    columns = np.zeros(37 * lanes)
    set_side_by_side(rows, order, columns, lanes)
    filled = np.zeros((37, lanes))
    filled[:, :count] = rows[:, order].T
    np.testing.assert_array_equal(columns.reshape(37, lanes), filled)
    back = np.empty_like(rows)
    set_apart(columns, lanes, order, back)
    np.testing.assert_array_equal(back, rows)
