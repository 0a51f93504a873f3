"""Rows nearly orthonormal become orthonormal, and are told how nearly."""

import numpy as np
import pytest

from auricle.spectral.orthonormal_rows import orthonormalized, overlap
from auricle.spectral.workers import Workers

WORKERS = Workers(2)


def orthonormal_rows(rng, count: int, n: int) -> np.ndarray:
    return np.ascontiguousarray(np.linalg.qr(rng.standard_normal((n, count)))[0].T)


@pytest.mark.parametrize("departure", [1e-8, 1e-6, 1e-3])
def test_rows_become_orthonormal_and_stay_where_they_were(rng, departure) -> None:
    exact = orthonormal_rows(rng, 130, 700)
    mixing = rng.standard_normal((130, 130)) / 130
    rows = exact + departure * (mixing + mixing.T) @ exact
    found = orthonormalized(rows, WORKERS)
    assert np.abs(overlap(found.rows, WORKERS)).max() < 1e-13
    assert found.departure < 1e-13
    np.testing.assert_allclose(
        found.rows, exact, atol=1e-13
    )  # the polar factor, not a rotation of it


def test_the_overlap_is_the_lower_triangle_of_the_gram_matrix_less_one(rng) -> None:
    rows = rng.standard_normal((70, 200))
    expected = np.tril(rows @ rows.T - np.eye(70))
    np.testing.assert_allclose(overlap(rows, WORKERS), expected, atol=1e-12)


def test_rows_far_apart_that_overlap_are_noticed_and_made_orthonormal(rng) -> None:
    """Neighbours are looked at first, but all are measured."""
    exact = orthonormal_rows(rng, 500, 700)
    rows = exact.copy()
    rows[0] += 1e-6 * exact[450]
    found = orthonormalized(rows, WORKERS)
    assert np.abs(found.rows @ found.rows.T - np.eye(500)).max() < 1e-11


def test_the_departure_told_is_that_of_the_rows_told(rng) -> None:
    """One is left as it is: among distant rows a departure too small to be worth a step."""
    exact = orthonormal_rows(rng, 400, 600)
    rows = exact.copy()
    rows[0] += 5e-12 * exact[350]
    found = orthonormalized(rows, WORKERS)
    measured = np.abs(found.rows @ found.rows.T - np.eye(400)).max()
    assert found.departure == pytest.approx(measured, rel=1e-3)
    assert measured == pytest.approx(5e-12, rel=1e-2)
