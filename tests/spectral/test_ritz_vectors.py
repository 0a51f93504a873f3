"""Ritz vectors are what their weights make of a basis."""

import numpy as np
import pytest

from auricle.spectral import ritz_vectors
from auricle.spectral.narrow_products import aligned_groups
from auricle.spectral.ritz_vectors import Combinations, fill_combinations


def orthonormal_groups(rng, count: int, n: int, lanes: int):
    groups = aligned_groups(count, n, lanes)
    columns = np.linalg.qr(rng.standard_normal((n, count * lanes)))[0]
    groups[:] = columns.reshape(n, count, lanes).swapaxes(0, 1)
    return groups, columns


def falling_weights(rng, n_combinations: int, n_vectors: int, fall: float):
    """Rows of length one that fall off, each at its own pace."""
    paces = fall * rng.uniform(0.5, 2.0, n_combinations)
    weights = rng.standard_normal((n_combinations, n_vectors))
    weights *= np.exp(-paces[:, None] * np.arange(n_vectors))
    return weights / np.linalg.norm(weights, axis=1)[:, None]


@pytest.mark.parametrize("lanes", [4, 8])
@pytest.mark.parametrize("n_combinations", [1, 8, 13])
@pytest.mark.parametrize("fall", [0.0, 1.0])
def test_combinations_are_those_of_a_full_product(rng, lanes, n_combinations, fall) -> None:
    """Also over several strips, of a number that registers do not divide, and into a wider room."""
    groups, columns = orthonormal_groups(rng, 6, 301, lanes)
    weights = falling_weights(rng, n_combinations, 6 * lanes, fall)
    room = np.full((301, n_combinations + 3), 7.0)
    for half in (slice(0, 150), slice(150, 301)):
        fill_combinations(groups, Combinations.of(weights), room[:, 2:-1], half)
    np.testing.assert_allclose(room[:, 2:-1], columns @ weights.T, atol=1e-15)
    assert (room[:, [0, 1, -1]] == 7.0).all()


def test_what_is_left_out_is_negligible_and_saves_work(rng, monkeypatch) -> None:
    """With a looser rule the same test would see the difference."""
    groups, columns = orthonormal_groups(rng, 12, 200, 8)
    weights = falling_weights(rng, 16, 96, 1.0)
    combinations = Combinations.of(weights)
    np.testing.assert_array_equal(
        combinations.side_by_side, weights.reshape(2, 8, 96).swapaxes(1, 2)
    )
    assert (combinations.needed < 90).all()
    found = np.empty((200, 16))
    fill_combinations(groups, combinations, found, slice(0, 200))
    assert np.abs(found - columns @ weights.T).max() < 1e-15
    monkeypatch.setattr(ritz_vectors, "_NOTHING", 1e-10)
    fill_combinations(groups, Combinations.of(weights), found, slice(0, 200))
    assert np.abs(found - columns @ weights.T).max() > 1e-13
