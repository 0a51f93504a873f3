"""Spectrum slicing misses nothing: against dense LAPACK, on meshes full of equal eigenvalues."""

import numpy as np
import pytest
from scipy import sparse

from auricle.errors import SolverError
from auricle.spectral import share_runs, slicing
from auricle.spectral.factorization import factorize
from auricle.spectral.ladder import Ladder, junction
from auricle.spectral.lanczos import Effort, LanczosRun
from auricle.spectral.laplacian import laplacian
from auricle.spectral.slicing import lowest_eigenpairs
from auricle.spectral.workers import Workers
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import cube, icosphere, joined

COUNTS = (1, 2, 10, 50, 99, 200)
WORKERS = Workers(2)


def two_spheres() -> Mesh:
    sphere = icosphere(radius=30.0, subdivisions=3)
    return joined([sphere, Mesh(sphere.vertices + 100.0, sphere.faces)])


SHAPES = {
    "sphere": lambda: icosphere(radius=30.0, subdivisions=3),
    "two equal spheres": two_spheres,
    "cube": lambda: cube(side=40.0, n=11),
}


def symmetrized(mesh: Mesh) -> sparse.csc_array:
    operator = laplacian(mesh)
    roots = sparse.diags_array(1 / np.sqrt(operator.areas))
    return sparse.csc_array(roots @ operator.stiffness @ roots)


@pytest.mark.parametrize("name", SHAPES)
def test_no_eigenvalue_is_missing_over_ten_seeds_and_six_counts(name) -> None:
    mesh = SHAPES[name]()
    matrix = symmetrized(mesh)
    truth = np.linalg.eigvalsh(matrix.toarray())
    for seed in range(10):
        for count in COUNTS:
            found = lowest_eigenpairs(
                matrix,
                count,
                density=mesh.area / (4 * np.pi),
                rng=np.random.default_rng(seed),
                workers=WORKERS,
            )
            assert len(found.values) == found.n_counted >= count
            assert (truth < found.complete_below).sum() == found.n_counted
            np.testing.assert_allclose(
                found.values, truth[: len(found.values)], atol=1e-9 * truth[max(count, 10)]
            )


def test_inertia_counts_the_eigenvalues_below_a_shift() -> None:
    matrix = symmetrized(SHAPES["cube"]())
    truth = np.linalg.eigvalsh(matrix.toarray())
    shifts = 0.5 * (truth[1:] + truth[:-1])[np.diff(truth) > 1e-6 * truth[1:]][:60]
    assert len(shifts) > 20
    for shift in shifts:
        assert factorize(matrix, float(shift)).n_below == (truth < shift).sum()


def test_a_shift_that_hits_an_eigenvalue_is_moved() -> None:
    diagonal = sparse.csc_array(sparse.diags_array(np.arange(10.0)))
    moved = factorize(diagonal, 4.0)
    assert moved.shift != 4.0
    assert moved.n_below == 5


@pytest.mark.parametrize("threads", [1, 2])
def test_copies_beyond_a_runs_width_are_searched_for(threads) -> None:
    """A block of four shows four copies of an eigenvalue, and what rounding adds, in a run."""
    values = np.concatenate([np.arange(30.0), np.full(300, 30.0), np.arange(31.0, 1701.0)])
    found = lowest_eigenpairs(
        sparse.csc_array(sparse.diags_array(values)),
        350,
        density=1.0,
        rng=np.random.default_rng(0),
        workers=Workers(threads),
    )
    assert found.retries
    assert len(found.values) == found.n_counted
    np.testing.assert_allclose(found.values, values[: len(found.values)], atol=1e-9)


def test_what_is_counted_but_not_found_is_an_error_not_a_gap(monkeypatch) -> None:
    """An iteration that loses copies (as ARPACK does) is noticed by the count."""

    class Forgetful(LanczosRun):
        def _converge(self) -> None:
            super()._converge()
            self.values, self._weights = self.values[1:], self._weights[:, 1:]

    for module in (share_runs, slicing):
        monkeypatch.setattr(module, "LanczosRun", Forgetful)
    monkeypatch.setattr(slicing, "_RETRIES", 1)
    mesh = SHAPES["sphere"]()
    with pytest.raises(SolverError, match="counted below"):
        lowest_eigenpairs(
            symmetrized(mesh),
            20,
            density=mesh.area / (4 * np.pi),
            rng=np.random.default_rng(0),
            workers=WORKERS,
        )


def test_progress_counts_up_to_what_was_asked() -> None:
    mesh = SHAPES["sphere"]()
    seen = []
    lowest_eigenpairs(
        symmetrized(mesh),
        150,
        density=mesh.area / (4 * np.pi),
        rng=np.random.default_rng(0),
        workers=Workers(2, lambda stage, done, total: seen.append((stage, done, total))),
    )
    assert seen[-1] == ("harmonics", 150, 150)
    assert [done for _, done, _ in seen] == sorted(done for _, done, _ in seen)


@pytest.mark.parametrize("higher", [0.0, 0.2, 40.0])
def test_the_last_run_goes_on_where_the_last_count_is_made_beyond_its_reach(rng, higher) -> None:
    matrix = sparse.csc_array(sparse.diags_array(np.arange(2000.0)))
    factors = factorize(matrix, 30.4)
    effort = Effort(4, 24, 60, 1e-11)
    run = LanczosRun(factors, np.empty((2000, 0)), effort=effort, rng=rng, pause=WORKERS.pause)
    run.until(lambda values: max(33 - len(values), 0))
    ladder = Ladder(np.empty(0), np.empty((2000, 32)), certified=-1.0, scale=1.0)
    joint = junction(ladder, run.values, factors)
    assert joint is not None
    reached = run.values[-1]

    def at(gap):
        assert gap == pytest.approx(31.5, abs=1e-6)
        return factorize(matrix, gap + higher)

    ceiling = slicing._completed(run, ladder, joint, (32, at), WORKERS)
    assert ceiling is not None
    assert (reached < ceiling.shift - 1) == (higher > 1)
    np.testing.assert_allclose(ladder.values, np.arange(float(ceiling.n_below)), atol=1e-8)
    beyond = matrix @ ladder.vectors - ladder.vectors * ladder.values
    assert np.linalg.norm(beyond, axis=0).max() < 1e-7
