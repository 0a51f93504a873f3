"""Factors solve and count: against dense LAPACK and SuperLU, on surfaces and odd matrices."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse
from scipy.sparse.linalg import splu

from auricle.errors import SolverError
from auricle.spectral import factorization, ldl, solves
from auricle.spectral.factorization import analyze, factorize, in_order
from auricle.spectral.laplacian import laplacian
from auricle.spectral.solves import solve
from auricle.surface.cleaning import clean
from auricle.surface.mesh import Mesh
from auricle.surface.reading import read_surface
from auricle.surface.shapes import cube, icosphere, joined, torus


def symmetrized(mesh: Mesh) -> sparse.csc_array:
    operator = laplacian(mesh)
    roots = sparse.diags_array(1 / np.sqrt(operator.areas))
    return sparse.csc_array(roots @ operator.stiffness @ roots)


def eight_equal_spheres() -> Mesh:
    sphere = icosphere(radius=30.0, subdivisions=2)
    return joined([Mesh(sphere.vertices + 100.0 * i, sphere.faces) for i in range(8)])


SHAPES = {
    "sphere": icosphere(radius=30.0, subdivisions=3),
    "cube": cube(side=40.0, n=10),
    "torus": torus(major=30.0, minor=10.0, n_major=40, n_minor=15),
    "eight equal spheres": eight_equal_spheres(),
}


def backward_error(matrix, factors, solution, right) -> float:
    residual = matrix @ solution - factors.shift * solution - right
    scale = np.abs(matrix.data).max() * np.linalg.norm(solution) + np.linalg.norm(right)
    return np.linalg.norm(residual) / scale


def relative_residual(matrix, factors, solution, right) -> float:
    residual = matrix @ solution - factors.shift * solution - right
    return np.linalg.norm(residual) / np.linalg.norm(right)


@pytest.mark.parametrize("name", SHAPES)
def test_counts_and_solves_agree_with_dense_lapack_at_many_shifts(name, rng) -> None:
    matrix = symmetrized(SHAPES[name])
    truth, vectors = np.linalg.eigh(matrix.toarray())
    # A shift in each of 80 gaps, from the lowest to the highest eigenvalues.
    wide = np.flatnonzero(np.diff(truth) > 1e-9 * truth[-1])
    gaps = wide[np.unique(np.linspace(0, len(wide) - 1, 80).astype(int))]
    assert len(gaps) >= 60 or (name == "eight equal spheres" and len(gaps) >= 40)
    symbolic = analyze(matrix)
    right = rng.standard_normal((matrix.shape[0], 5))
    for shift in 0.5 * (truth[gaps] + truth[gaps + 1]):
        factors = factorize(matrix, float(shift), symbolic=symbolic)
        assert factors.shift == shift
        assert factors.n_below == (truth < shift).sum()
        solution = factors.solve(right, refine=True)
        assert relative_residual(matrix, factors, solution, right) < 1e-10
        exact = vectors @ ((vectors.T @ right) / (truth - shift)[:, None])
        nearest = np.abs(truth - shift).min()
        np.testing.assert_allclose(
            solution, exact, atol=1e-12 * truth[-1] / nearest * np.abs(exact).max()
        )


def test_an_atrium_is_solved_and_counted_as_by_superlu(real_data, rng) -> None:
    matrix = symmetrized(clean(read_surface(real_data / "meshes" / "lausm" / "test.vtk")).mesh)
    symbolic = analyze(matrix)
    right = rng.standard_normal((matrix.shape[0], 8))
    identity = sparse.eye_array(matrix.shape[0])
    for shift in (1e-4, 0.01, 0.1, 0.5, 3.0):
        factors = factorize(matrix, shift, symbolic=symbolic)
        superlu = splu(
            sparse.csc_array(matrix - factors.shift * identity),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        assert np.array_equal(superlu.perm_r, superlu.perm_c)
        assert factors.n_below == (superlu.U.diagonal() < 0).sum()
        assert relative_residual(matrix, factors, factors.solve(right, refine=True), right) < 1e-10


def test_refinement_brings_the_residual_down(rng) -> None:
    """High in the spectrum, where pivots within blocks lose digits."""
    matrix = symmetrized(SHAPES["cube"])
    right = rng.standard_normal((matrix.shape[0], 4))
    for shift in rng.uniform(0.5, 3.0, 20):
        factors = factorize(matrix, float(shift))
        refined = factors.solve(right, refine=True)
        plain = factors.solve(right, refine=False)
        assert backward_error(matrix, factors, refined, right) < 1e-15
        assert backward_error(matrix, factors, plain, right) < 10 * factors.backward_error


def test_a_solve_is_refined_unasked_where_the_trial_solve_was_poor(monkeypatch, rng) -> None:
    matrix = symmetrized(SHAPES["cube"])
    factors = factorize(matrix, 0.6)
    right = rng.standard_normal(matrix.shape[0])
    plain, refined = (factors.solve(right, refine=refine) for refine in (False, True))
    assert (plain != refined).any()
    for threshold, expected in ((0.0, refined), (1.0, plain)):
        monkeypatch.setattr(factorization, "_REFINED_ABOVE", threshold)
        np.testing.assert_array_equal(factors.solve(right), expected)


@pytest.mark.parametrize("index", [0, 1, 2, 10, 100, -1])
@pytest.mark.parametrize("name", ["cube", "sphere"])
def test_a_shift_on_an_eigenvalue_is_moved_and_still_counts(name, index) -> None:
    matrix = symmetrized(SHAPES[name])
    truth = np.linalg.eigvalsh(matrix.toarray())
    factors = factorize(matrix, float(truth[index]))
    assert factors.shift > truth[index]
    below = (truth < factors.shift).sum()
    near = np.abs(truth - factors.shift) < 1e-12 * truth[-1]
    assert below - near.sum() <= factors.n_below <= below + near.sum()


def test_an_exact_hit_is_moved() -> None:
    factors = factorize(sparse.csc_array(sparse.diags_array(np.arange(10.0))), 4.0)
    assert factors.shift > 4.0
    assert factors.n_below == 5


@pytest.mark.parametrize("shift", [-1.0, 0.5, 2.0])
def test_a_matrix_of_one_entry_is_factored(shift) -> None:
    factors = factorize(sparse.csc_array([[1.0]]), shift)
    assert factors.n_below == (shift > 1)
    np.testing.assert_allclose(factors.solve(np.array([3.0])), 3.0 / (1.0 - shift))


def test_a_diagonal_matrix_with_zeros_is_factored(rng) -> None:
    diagonal = rng.integers(-3, 4, 200).astype(float)
    factors = factorize(sparse.csc_array(sparse.diags_array(diagonal)), 0.5)
    assert factors.n_below == (diagonal < 0.5).sum()
    np.testing.assert_allclose(factors.solve(np.ones(200)), 1 / (diagonal - 0.5))


def test_a_star_with_one_full_row_is_factored(rng) -> None:
    star = np.diag(rng.standard_normal(300))
    star[5] = star[:, 5] = rng.standard_normal(300)
    matrix = sparse.csc_array(star)
    truth = np.linalg.eigvalsh(star)
    for shift in 0.5 * (truth[1:] + truth[:-1])[::7]:
        factors = factorize(matrix, float(shift))
        assert factors.n_below == (truth < factors.shift).sum()


def test_a_dense_matrix_wider_than_a_chain_link_is_factored(rng) -> None:
    dense = rng.standard_normal((150, 150))
    dense += dense.T
    matrix = sparse.csc_array(dense)
    truth = np.linalg.eigvalsh(dense)
    right = rng.standard_normal((150, 3))
    for shift in np.linspace(truth[0] - 1, truth[-1] + 1, 25):
        factors = factorize(matrix, float(shift))
        assert factors.n_below == (truth < factors.shift).sum()
        solution = factors.solve(right, refine=True)
        assert backward_error(matrix, factors, solution, right) < 1e-13


def test_a_diagonal_of_almost_zeros_takes_pivots_in_pairs(rng) -> None:
    """Single pivots of 1e-9 would blow rounding up a billion times."""
    dense = rng.standard_normal((90, 90))
    dense += dense.T
    np.fill_diagonal(dense, 0.0)
    factors = factorize(sparse.csc_array(dense), 1e-9)
    assert factors.shift == 1e-9
    assert factors.n_below == (np.linalg.eigvalsh(dense) < 1e-9).sum()
    assert factors.backward_error < 1e-12


@settings(max_examples=80, deadline=None)
@given(
    n=st.integers(1, 60),
    density=st.floats(0.0, 0.6),
    shift=st.floats(0.05, 3.0),
    sign=st.sampled_from([-1.0, 1.0]),
    seed=st.integers(0, 10**6),
)
def test_random_indefinite_matrices_are_counted_and_solved(n, density, shift, sign, seed) -> None:
    rng = np.random.default_rng(seed)
    dense = rng.standard_normal((n, n)) * (rng.random((n, n)) < density)
    dense += dense.T
    matrix = sparse.csc_array(dense)
    factors = factorize(matrix, sign * shift)
    truth = np.linalg.eigvalsh(dense)
    if np.abs(truth - factors.shift).min() > 1e-9 * max(np.abs(truth).max(), 1.0):
        assert factors.n_below == (truth < factors.shift).sum()
    right = rng.standard_normal((n, 3))
    solution = factors.solve(right, refine=True)
    scale = (np.abs(dense).max() + shift) * np.linalg.norm(solution) + np.linalg.norm(right)
    residual = dense @ solution - factors.shift * solution - right
    assert np.linalg.norm(residual) < 1e-10 * scale


def test_the_same_input_gives_the_same_digits(rng) -> None:
    matrix = symmetrized(SHAPES["torus"])
    right = rng.standard_normal((matrix.shape[0], 8))
    one, other = factorize(matrix, 0.05), factorize(matrix.copy(), 0.05)
    np.testing.assert_array_equal(one.solve(right), other.solve(right.copy()))


def test_many_columns_are_solved_as_each_alone(rng) -> None:
    matrix = symmetrized(SHAPES["torus"])
    factors = factorize(matrix, 0.05)
    right = rng.standard_normal((matrix.shape[0], 150))
    together = factors.solve(right)
    alone = np.stack([factors.solve(column) for column in right.T], axis=1)
    np.testing.assert_allclose(together, alone, atol=1e-12 * np.abs(alone).max())


def test_two_threads_share_one_factorisation(rng) -> None:
    matrix = symmetrized(SHAPES["sphere"])
    factors = factorize(matrix, 0.05)
    rights = [rng.standard_normal((matrix.shape[0], 8)) for _ in range(8)]
    alone = [factors.solve(right) for right in rights]
    with ThreadPoolExecutor(2) as threads:
        together = list(threads.map(factors.solve, rights))
    np.testing.assert_array_equal(alone, together)


def test_any_layout_and_type_of_right_hand_side_is_solved_by_the_same_code(rng) -> None:
    matrix = symmetrized(SHAPES["torus"])
    factors = factorize(matrix, 0.05)
    right = rng.integers(-5, 6, (matrix.shape[0], 4))
    expected = factors.solve(right.astype(float))
    before = len(solves.solve.signatures)
    np.testing.assert_array_equal(factors.solve(right), expected)
    np.testing.assert_array_equal(factors.solve(np.asfortranarray(right)), expected)
    frozen = right.astype(float)
    frozen.flags.writeable = False
    np.testing.assert_array_equal(factors.solve(frozen), expected)
    matrix.data.flags.writeable = False
    assert factorize(matrix, 1).solve(right[:, 0]).shape == (matrix.shape[0],)
    assert len(solves.solve.signatures) == before
    assert len(ldl._eliminate.signatures) == 1


def test_one_analysis_serves_other_values_of_the_same_pattern(rng) -> None:
    matrix = symmetrized(SHAPES["cube"])
    symbolic = analyze(matrix)
    scaled = sparse.csc_array((2 * matrix.data, matrix.indices, matrix.indptr), shape=matrix.shape)
    right = rng.standard_normal(matrix.shape[0])
    np.testing.assert_allclose(
        factorize(scaled, 0.1, symbolic=symbolic).solve(right),
        factorize(matrix, 0.05).solve(right) / 2,
        rtol=1e-9,
        atol=1e-9,
    )


def test_an_analysis_of_another_pattern_is_refused() -> None:
    symbolic = analyze(symmetrized(SHAPES["cube"]))
    with pytest.raises(SolverError, match="another pattern"):
        factorize(symmetrized(SHAPES["sphere"]), 0.1, symbolic=symbolic)


@pytest.mark.parametrize("dense", [np.zeros((0, 0)), np.ones((2, 3)), np.triu(np.ones((3, 3)))])
def test_what_is_not_symmetric_is_refused(dense) -> None:
    with pytest.raises(SolverError, match="both of its triangles"):
        analyze(sparse.csc_array(dense))


def test_a_matrix_of_zeros_has_no_factors_at_zero() -> None:
    with pytest.raises(SolverError, match="no shift near 0"):
        factorize(sparse.csc_array((3, 3)), 0.0)


def test_the_memory_foretold_is_the_memory_of_the_factors() -> None:
    symbolic = analyze(symmetrized(SHAPES["sphere"]))
    factors = factorize(symmetrized(SHAPES["sphere"]), 0.1, symbolic=symbolic)
    assert factors._room.streams.n_bytes < symbolic.n_bytes < 2 * factors._room.streams.n_bytes


@pytest.mark.parametrize("refined_above", [np.inf, 0.0])
@pytest.mark.parametrize("lanes", [4, 8])
@pytest.mark.parametrize("ordered", [False, True])
def test_a_group_is_solved_for_as_columns_are(
    rng, monkeypatch, refined_above, lanes, ordered
) -> None:
    monkeypatch.setattr(factorization, "_REFINED_ABOVE", refined_above)
    matrix = sparse.csc_array(laplacian(icosphere(radius=1.0, subdivisions=2)).stiffness)
    symbolic = analyze(matrix)
    if ordered:
        matrix, symbolic = in_order(matrix, symbolic)
    factors = factorize(matrix, 0.3, symbolic=symbolic)
    right = rng.standard_normal((factors.size, lanes))
    solution = np.empty_like(right)
    solve(factors.solver(), right, solution, (0.0,) * lanes)
    np.testing.assert_array_equal(solution, factors.solve(right))
    np.testing.assert_allclose(matrix @ solution - 0.3 * solution, right, atol=1e-11)


@pytest.mark.parametrize("name", sorted(SHAPES))
def test_a_matrix_in_order_of_elimination_has_the_same_factors(name) -> None:
    matrix = symmetrized(SHAPES[name])
    symbolic = analyze(matrix)
    ordered, same = in_order(matrix, symbolic)
    order = symbolic.plan.order
    np.testing.assert_array_equal(ordered.toarray(), matrix.toarray()[np.ix_(order, order)])
    assert same.fits(ordered)
    factors, reordered = (
        factorize(matrix, 0.1, symbolic=symbolic),
        factorize(ordered, 0.1, symbolic=same),
    )
    np.testing.assert_array_equal(reordered._room.streams.down, factors._room.streams.down)
    np.testing.assert_array_equal(reordered._room.streams.up, factors._room.streams.up)
