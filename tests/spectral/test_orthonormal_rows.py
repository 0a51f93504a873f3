"""Rows nearly orthonormal become orthonormal, and are told how nearly."""

from dataclasses import replace

import numpy as np
import pytest

from auricle.spectral.orthonormal_rows import orthonormalized, overlap
from auricle.spectral.separation import Separation
from auricle.spectral.workers import Workers

WORKERS = Workers(2)


def nothing_known(rows, _values=None) -> Separation:
    """All eigenvalues might be the same: every product has to be measured."""
    nothing = np.zeros(len(rows))
    return Separation(nothing, nothing, nothing, np.ones(len(rows)), 0.0)


def made_orthonormal(rows):
    return orthonormalized(rows, nothing_known(rows), nothing_known, WORKERS)


def measured(rows, separation):
    """The overlap, and the largest magnitude it tells of."""
    lower, unmeasured = overlap(rows, WORKERS, separation)
    return lower, max(np.abs(lower).max(), unmeasured)


def orthonormal_rows(rng, count: int, n: int) -> np.ndarray:
    return np.ascontiguousarray(np.linalg.qr(rng.standard_normal((n, count)))[0].T)


@pytest.mark.parametrize("departure", [1e-8, 1e-6, 1e-3])
def test_rows_become_orthonormal_and_the_lowest_stay_where_they_were(rng, departure) -> None:
    """Each is changed by those before it only: Gram and Schmidt's rows."""
    exact = orthonormal_rows(rng, 130, 700)
    mixing = np.tril(rng.standard_normal((130, 130)) / 130)
    rows = exact + departure * mixing @ exact
    found = made_orthonormal(rows)
    assert measured(found.rows, nothing_known(rows))[1] < 1e-13
    assert found.departure < 1e-13
    np.testing.assert_allclose(found.rows, exact, atol=1e-13)


def test_residuals_of_the_lowest_do_not_grow_by_what_others_hold_of_them(rng) -> None:
    """Of the highest row a billionth is the lowest, whose eigenvalue is a millionth of its own."""
    exact = orthonormal_rows(rng, 20, 300)
    values = np.geomspace(1e-6, 1.0, 20)
    rows = exact.copy()
    rows[-1] += 1e-9 * exact[0]
    found = made_orthonormal(rows)
    coefficients = found.rows @ exact.T
    residuals = np.linalg.norm((coefficients * values) - values[:, None] * coefficients, axis=1)
    assert found.departure < 1e-13
    assert (residuals / values).max() < 1e-9


def test_the_overlap_is_the_lower_triangle_of_the_gram_matrix_less_one(rng) -> None:
    rows = rng.standard_normal((70, 200))
    expected = np.tril(rows @ rows.T - np.eye(70))
    lower, largest = measured(rows, nothing_known(rows))
    np.testing.assert_allclose(lower, expected, atol=1e-12)
    assert largest == np.abs(lower).max()


def test_rows_far_apart_that_overlap_are_noticed_and_made_orthonormal(rng) -> None:
    """Neighbours are looked at first, but all are measured."""
    exact = orthonormal_rows(rng, 500, 700)
    rows = exact.copy()
    rows[0] += 1e-6 * exact[450]
    found = made_orthonormal(rows)
    assert np.abs(found.rows @ found.rows.T - np.eye(500)).max() < 1e-11


def test_the_departure_told_is_that_of_the_rows_told(rng) -> None:
    """One is left as it is: among distant rows a departure too small to be worth a step."""
    exact = orthonormal_rows(rng, 400, 600)
    rows = exact.copy()
    rows[0] += 5e-12 * exact[350]
    found = made_orthonormal(rows)
    there = np.abs(found.rows @ found.rows.T - np.eye(400)).max()
    assert found.departure == pytest.approx(there, rel=1e-3)
    assert there == pytest.approx(5e-12, rel=1e-2)


def eigenvectors_with_errors(rng, count: int, n: int, size: float):
    """Of a symmetric matrix, disturbed: rows, and what is known of them."""
    matrix = rng.standard_normal((n, n))
    vectors = np.linalg.eigh(matrix + matrix.T)[1]
    rows = vectors[:, :count].T + size * rng.standard_normal((count, n))
    rows /= np.linalg.norm(rows, axis=1)[:, None]
    images = rows @ (matrix + matrix.T)
    quotients = np.einsum("kn,kn->k", rows, images)
    residuals = np.linalg.norm(images - quotients[:, None] * rows, axis=1)
    return rows, Separation(quotients, residuals, residuals, np.ones(count), 1e-12)


def test_products_known_to_be_negligible_are_not_measured_but_told(rng) -> None:
    """The departure told is never less than what is there."""
    rows, separation = eigenvectors_with_errors(rng, 200, 300, 1e-14)
    products = np.tril(rows @ rows.T - np.eye(200))
    lower, largest = measured(rows, separation)
    skipped = (lower == 0) & (products != 0)
    assert 0.3 < skipped.sum() / (200 * 199 / 2) < 0.95
    np.testing.assert_allclose(lower[~skipped], products[~skipped], atol=1e-14)
    assert np.abs(products).max() <= largest <= 5e-11


def test_large_residuals_hide_nothing(rng) -> None:
    """Sabotage: vectors far apart by their eigenvalues that are not orthogonal at all."""
    rows, separation = eigenvectors_with_errors(rng, 200, 300, 1e-14)
    rows[0] += 1e-6 * rows[150]
    scaled = separation.scaled.copy()
    scaled[0] += 1e-6 * (separation.values[150] - separation.values[0])
    _, largest = measured(rows, replace(separation, scaled=scaled))
    assert largest == pytest.approx(1e-6, rel=1e-3)
