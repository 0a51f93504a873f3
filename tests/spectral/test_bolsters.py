"""Factors of a matrix with a few diagonal entries enlarged solve and count for the matrix."""

import numpy as np
import pytest
from numba import njit
from scipy import sparse

from auricle.spectral import factorization
from auricle.spectral.bolsters import Bolstered, take_out_bolsters
from auricle.spectral.factorization import analyze, factorize
from auricle.spectral.lanes import eight, four
from auricle.spectral.laplacian import laplacian
from auricle.surface.shapes import cube, icosphere


def symmetric(rng, n: int = 30):
    half = rng.standard_normal((n, n))
    return half + half.T


def with_bolsters(rng, matrix, count: int):
    bolsters = np.zeros(len(matrix))
    bolsters[rng.permutation(len(matrix))[:count]] = rng.uniform(1, 50, count) * rng.choice(
        [-1, 1], count
    )
    factored = matrix + np.diag(bolsters)

    def solve(columns) -> None:
        columns[:] = np.linalg.solve(factored, columns)

    return factored, Bolstered.of(bolsters, solve)


@njit
def taken_out(bolstered, solutions) -> None:
    if solutions.shape[1] == 4:
        take_out_bolsters(bolstered, solutions, four(0.0))
    else:
        take_out_bolsters(bolstered, solutions, eight(0.0))


@pytest.mark.parametrize("count", [0, 1, 2, 7, 30])
@pytest.mark.parametrize("n_right", [4, 8, 16])
def test_solutions_are_turned_into_those_of_the_matrix(rng, count, n_right) -> None:
    matrix = symmetric(rng)
    factored, bolstered = with_bolsters(rng, matrix, count)
    right = rng.standard_normal((len(matrix), n_right))
    solutions = np.linalg.solve(factored, right)
    taken_out(bolstered, solutions)
    np.testing.assert_allclose(matrix @ solutions, right, atol=1e-9)


@pytest.mark.parametrize("count", [0, 1, 2, 7, 30])
def test_negative_eigenvalues_are_counted_as_the_matrix_has_them(rng, count) -> None:
    for _ in range(20):
        matrix = symmetric(rng)
        factored, bolstered = with_bolsters(rng, matrix, count)
        below = int((np.linalg.eigvalsh(factored) < 0).sum())
        assert below + bolstered.n_negative == (np.linalg.eigvalsh(matrix) < 0).sum()


def test_a_singular_matrix_is_told(rng) -> None:
    vectors = np.linalg.qr(rng.standard_normal((20, 20)))[0]
    values = np.arange(20.0) - 7
    _, bolstered = with_bolsters(rng, vectors * values @ vectors.T, 3)
    assert bolstered is None


def atrium_like() -> sparse.csc_array:
    operator = laplacian(icosphere(radius=30.0, subdivisions=4))
    roots = sparse.diags_array(1 / np.sqrt(operator.areas))
    return sparse.csc_array(roots @ operator.stiffness @ roots)


def test_solves_are_right_without_refinement_at_nearly_every_shift(rng, monkeypatch) -> None:
    matrix = atrium_like()
    symbolic = analyze(matrix)
    shifts = rng.uniform(0.02, 0.6, 60)

    def errors():
        found = [factorize(matrix, shift, symbolic=symbolic) for shift in shifts]
        return np.array([factors.backward_error for factors in found])

    assert np.median(errors()) < 1e-12
    assert errors().max() < 1e-10
    monkeypatch.setattr(factorization, "_GROWTHS", (np.inf,))
    assert errors().max() > 1e-10


@pytest.mark.parametrize("growth", [1e-3, 1.0, 3.0])
def test_counts_and_solves_are_right_however_many_are_bolstered(rng, growth, monkeypatch) -> None:
    monkeypatch.setattr(factorization, "_GROWTHS", (growth,))
    operator = laplacian(cube(side=40.0, n=8))
    roots = sparse.diags_array(1 / np.sqrt(operator.areas))
    matrix = sparse.csc_array(roots @ operator.stiffness @ roots)
    truth = np.linalg.eigvalsh(matrix.toarray())
    symbolic = analyze(matrix)
    right = rng.standard_normal((matrix.shape[0], 3))
    bolstered = 0
    for shift in rng.uniform(truth[1], truth[-1], 20):
        factors = factorize(matrix, float(shift), symbolic=symbolic)
        bolstered += len(factors._bolstered.places)
        assert factors.n_below == (truth < factors.shift).sum()
        residual = matrix @ factors.solve(right, refine=True) - right
        residual -= factors.shift * factors.solve(right, refine=True)
        assert np.abs(residual).max() < 1e-7
    assert bolstered > 20
