"""Modes made in place are the eigenvectors, scaled, turned and put at their vertices."""

import numpy as np
import pytest

from auricle.arrays import read_only
from auricle.spectral.mode_arrays import modes_in_place
from auricle.spectral.workers import Workers


@pytest.mark.parametrize("count", [1, 9, 20])
@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("wider", [0, 3, 50])
def test_modes_are_the_eigenvectors_in_the_order_of_vertices(rng, count, threads, wider) -> None:
    n = 101
    room = rng.standard_normal((n, count + wider))
    order, areas = rng.permutation(n), rng.uniform(1.0, 9.0, n)
    expected = np.empty((n, count))
    expected[order] = room[:, :count] / np.sqrt(areas[order])[:, None]
    largest = np.abs(expected).argmax(axis=0)
    expected *= np.sign(expected[largest, np.arange(count)])
    with Workers(threads) as workers:
        modes = modes_in_place(room, count, order, areas, workers)
    np.testing.assert_allclose(modes, expected, rtol=1e-14)
    assert not modes.flags.writeable
    assert read_only(modes, np.float64) is modes


def test_memory_is_used_again_unless_most_of_it_would_be_kept_for_nothing(rng) -> None:
    for wider, shared in ((2, True), (30, False)):
        room = rng.standard_normal((50, 10 + wider))
        with Workers(1) as workers:
            modes = modes_in_place(room, 10, np.arange(50), np.ones(50), workers)
        assert np.shares_memory(modes, room) == shared
        if shared:
            assert not room.flags.writeable
