"""Eigenvectors of one symmetric matrix: by how much they may overlap."""

from fractions import Fraction

import numpy as np
import pytest
from scipy import sparse

from auricle.spectral.refinement import free_of_rounding
from auricle.spectral.separation import Measure, Separation
from auricle.spectral.workers import Workers

WORKERS = Workers(1)


def symmetric(rng, diagonal) -> sparse.csc_array:
    """A positive definite sparse matrix whose entries grow with the diagonal's."""
    n = len(diagonal)
    half = sparse.random_array((n, n), density=0.1, rng=rng).toarray()
    roots = np.sqrt(diagonal)
    return sparse.csc_array(np.diag(diagonal) + 0.02 * roots * (half + half.T) * roots[:, None])


def disturbed(rng, matrix, count: int, size: float):
    """Lowest eigenvectors with errors, of length one, one a row, and their eigenvalues."""
    values, vectors = np.linalg.eigh(matrix.toarray())
    rows = vectors[:, :count].T + size * rng.standard_normal((count, len(values)))
    return rows / np.linalg.norm(rows, axis=1)[:, None], values[:count]


@pytest.mark.parametrize("loud", [1.0, 1e7])
@pytest.mark.parametrize("size", [1e-13, 1e-10, 1e-6])
def test_no_inner_product_exceeds_what_is_told(rng, size, loud) -> None:
    matrix = symmetric(rng, np.where(np.arange(90) % 30, rng.uniform(1.0, 2.0, 90), loud))
    rows, values = disturbed(rng, matrix, 60, size)
    bounds = Measure.of(matrix, values.max(), WORKERS)(rows, values).bounds(np.arange(60)[:, None])
    assert (np.abs(np.tril(rows @ rows.T, -1)) <= bounds).all()
    if loud == 1.0:
        # And it is of use: not many times what was put in.
        assert np.median(bounds[np.isfinite(bounds)]) < 1e3 * size + 1e-10


@pytest.mark.parametrize("wrong", [0, 1])
def test_either_of_two_may_be_the_one_that_is_wrong(wrong) -> None:
    matrix = sparse.csc_array(sparse.diags_array([1.0, 3.0, 7.0, 9.0]))
    rows = np.eye(4)[:2]
    rows[wrong] += 1e-6 * rows[1 - wrong]
    bound = Measure.of(matrix, 3.0, WORKERS)(rows, np.array([1.0, 3.0])).bounds(
        np.array([[0], [1]])
    )
    assert 1e-6 * (1 - 1e-9) < bound[1, 0] < 2e-6


def test_what_rounding_makes_loud_where_the_matrix_is_large_keeps_no_vectors_apart(rng) -> None:
    diagonal = np.where(np.arange(200) % 50, rng.uniform(1.0, 2.0, 200), 1e10)
    matrix = symmetric(rng, diagonal)
    roots = np.sqrt(diagonal)
    inverse = np.linalg.inv(matrix.toarray() / np.outer(roots, roots)) / np.outer(roots, roots)
    inverses, vectors = np.linalg.eigh(inverse)
    values, rows = 1 / inverses[:-41:-1], vectors[:, :-41:-1].T.copy()
    free_of_rounding(matrix, rows, values, least=values[0])
    measure = Measure.of(matrix, values[39], WORKERS)
    told = measure(rows, values).bounds(np.array([[0], [39]]))[1, 0]
    # What rounding may hide of a plain product would allow a million times as much.
    assert told < 1e-6 * np.finfo(float).eps * 1e10 / (values[39] - values[0])


def test_rounding_hides_no_more_than_is_told(rng) -> None:
    """By exact arithmetic, at the vertices' own sizes; and it is told without exaggeration."""
    matrix = symmetric(rng, np.where(np.arange(40) % 10, 1.0, 1e6))
    measure = Measure.of(matrix, 1.0, WORKERS)
    row = measure.scaling * rng.standard_normal(40)
    wrong = matrix @ row - 0.7 * row
    dense = matrix.toarray()
    for i in range(40):
        exact = sum(Fraction(a) * Fraction(x) for a, x in zip(dense[i], row, strict=True))
        wrong[i] = float(Fraction(wrong[i]) - exact + Fraction(0.7) * Fraction(row[i]))
    hidden = np.linalg.norm(measure.scaling * wrong)
    told = measure.hidden * np.linalg.norm(row / measure.scaling)
    assert 0 < hidden <= told < 1e3 * hidden


def test_some_are_replaced_by_what_was_found_anew() -> None:
    def all_of(number: float, count: int) -> Separation:
        a, b, c, d = (np.full(count, number + i / 10) for i in range(4))
        return Separation(a, b, c, d, 0.5)

    found = all_of(1.0, 3).replaced(np.array([0, 2]), all_of(7.0, 2))
    np.testing.assert_allclose(found.values, [7.0, 1.0, 7.0])
    np.testing.assert_allclose(found.residuals, [7.1, 1.1, 7.1])
    np.testing.assert_allclose(found.scaled, [7.2, 1.2, 7.2])
    np.testing.assert_allclose(found.stretched, [7.3, 1.3, 7.3])
