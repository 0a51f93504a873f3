"""Inner products by tiles are inner products."""

import numpy as np
import pytest

from auricle.spectral.gram_tiles import fill_products, tiles
from auricle.spectral.workers import Workers


@pytest.mark.parametrize("count", [1, 5, 8, 9, 61])
@pytest.mark.parametrize("n", [1, 700, 5000])
@pytest.mark.parametrize("threads", [1, 2])
def test_wanted_products_are_set_and_others_left(rng, count, n, threads) -> None:
    within = rng.standard_normal((n, count + 3))
    places = tiles(count)
    wanted = np.tri(len(places), dtype=bool)
    wanted[len(places) // 2, 0] = len(places) < 3
    products = np.full((count, count), np.pi)
    with Workers(threads) as workers:
        fill_products(within[:, 1 : count + 1].T, wanted, products, workers)
        in_rows = np.full((count, count), np.pi)
        fill_products(np.ascontiguousarray(within[:, 1 : count + 1].T), wanted, in_rows, workers)
    np.testing.assert_allclose(in_rows, products, rtol=1e-12, atol=1e-11)
    set_there = np.zeros((count, count), bool)
    for i, j in np.argwhere(wanted):
        set_there[np.ix_(places[i], places[j])] = True
    expected = within[:, 1 : count + 1].T @ within[:, 1 : count + 1]
    np.testing.assert_allclose(products[set_there], expected[set_there], atol=1e-11)
    assert (products[~set_there] == np.pi).all()
    assert set_there[np.tril_indices(count)].all() or len(places) >= 3


@pytest.mark.parametrize("count", [1, 7, 8, 23, 64])
def test_tiles_take_in_every_vector_and_none_beyond(count) -> None:
    assert sorted(set(tiles(count).ravel().tolist())) == list(range(count))
