"""Sums along a stream are the products of its matrix."""

import numpy as np
import pytest
from numba import njit

from auricle.spectral.lanes import eight, four
from auricle.spectral.tile_sums import lines_at_once, sum_lines, tile_width

COUNT = 13


@njit
def of_four(stream, place, n_lines, vectors, sums, first, step):
    sum_lines(stream, (place, n_lines, COUNT), (vectors, 3, 5), (sums, first, step), four(0.0))


@njit
def of_eight(stream, place, n_lines, vectors, sums, first, step):
    sum_lines(stream, (place, n_lines, COUNT), (vectors, 3, 9), (sums, first, step), eight(0.0))


def in_tiles(lines):
    """Eight lines a tile, or four in the last; of each tile one column after another."""
    tiles, left = [], lines
    while len(left):
        n_lines = min(tile_width(len(left)), len(left))
        tiles.append(left[:n_lines].T.ravel())
        left = left[n_lines:]
    return np.concatenate(tiles)


@pytest.mark.parametrize(
    ("lanes", "apart", "n_lines"), [(4, 5, 4), (4, 5, 8), (4, 5, 16), (8, 9, 4), (8, 9, 8)]
)
def test_sums_are_those_of_a_matrix_product(rng, lanes, apart, n_lines) -> None:
    lines, vectors = rng.standard_normal((n_lines, COUNT)), rng.standard_normal(3 + COUNT * apart)
    before = rng.standard_normal(7)
    step = lanes if lanes == 4 else 11
    sums = np.zeros(2 + n_lines * step)
    stream = np.concatenate([before, in_tiles(lines)])
    {4: of_four, 8: of_eight}[lanes](stream, 7, n_lines, vectors, sums, 2, step)
    rows = np.stack([vectors[3 + k * apart : 3 + k * apart + lanes] for k in range(COUNT)])
    found = sums[2:].reshape(n_lines, step)
    np.testing.assert_allclose(found[:, :lanes], lines @ rows, atol=1e-13)
    assert (found[:, lanes:] == 0).all()
    assert (sums[:2] == 0).all()


def test_lines_are_taken_by_sixteen_where_registers_are_of_four() -> None:
    at_once = njit(
        lambda n_left: (lines_at_once(n_left, four(0.0)), lines_at_once(n_left, eight(0.0)))
    )
    taken = [at_once(n_left) for n_left in (1, 4, 5, 8, 12, 13, 16, 40)]
    assert taken == [(4, 4), (4, 4), (8, 8), (8, 8), (8, 8), (16, 8), (16, 8), (16, 8)]
