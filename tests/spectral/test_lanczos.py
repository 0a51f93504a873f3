"""Block Lanczos runs: orthogonal where rounding would undo it, and found by number."""

import numpy as np
import pytest
from scipy import sparse

from auricle.spectral import lanczos
from auricle.spectral.factorization import factorize
from auricle.spectral.lanczos import Effort, LanczosRun
from auricle.spectral.workers import Workers


def run_near(place: float, rng: np.random.Generator) -> LanczosRun:
    """A spectrum 0, 1, …, 1999 searched around a shift."""
    matrix = sparse.csc_array(sparse.diags_array(np.arange(2000.0)))
    nothing = np.empty((2000, 0))
    effort = Effort(4, 60, 60, 1e-11)
    return LanczosRun(
        factorize(matrix, place), nothing, effort=effort, rng=rng, pause=lambda: None
    ).until()


@pytest.mark.parametrize("aside", [0.5, 0.04, 0.001])
def test_vectors_stay_orthonormal_also_where_an_eigenvalue_lies_next_to_the_shift(
    rng, aside
) -> None:
    run = run_near(700 + aside, rng)
    with Workers(2) as workers:
        vectors = run.vectors(0, workers)
    np.testing.assert_allclose(vectors.T @ vectors, np.eye(vectors.shape[1]), atol=1e-9)
    # Nothing missed near the shift and nothing found twice.
    near = run.values[np.abs(run.values - 700) < 30.5]
    np.testing.assert_allclose(near, np.arange(670.0, 731.0), atol=1e-9)


@pytest.mark.parametrize(("most_left", "kept"), [(lanczos._MOST_LEFT, True), (1e-7, False)])
def test_what_stays_in_the_basis_is_orthogonal(rng, monkeypatch, most_left, kept) -> None:
    """Blocks that nothing is taken out of any more: by the rule, and not by a looser one."""
    allowed = lanczos._MOST_LEFT
    monkeypatch.setattr(lanczos, "_MOST_LEFT", most_left)
    rows = run_near(700.5, rng)._recurrence.basis[:60].swapaxes(1, 2).reshape(240, 2000)
    departure = np.abs(rows @ rows.T - np.eye(len(rows))).max()
    assert (departure < allowed) == kept


def test_the_whole_basis_is_looked_at_only_when_rounding_asks_for_it(rng) -> None:
    # Of sixty blocks; one that looks at none finds eigenvalues twice.
    assert 15 < run_near(700.5, rng)._lost.n_looks < 50


def test_never_looking_at_the_whole_basis_finds_eigenvalues_twice(rng, monkeypatch) -> None:
    """What the rule is for: without it the truths above fail."""
    monkeypatch.setattr(lanczos, "_MOST_LEFT", np.inf)
    assert np.diff(run_near(700.04, rng).values).min() < 0.5


def test_where_lapack_gives_up_its_older_method_takes_its_place(monkeypatch) -> None:
    """It does, once in very many runs, and not for the same matrix times two."""
    eigh = np.linalg.eigh

    def give_up(matrix):
        if len(matrix) > 100:
            raise np.linalg.LinAlgError("Eigenvalues did not converge")
        return eigh(matrix)

    expected = run_near(700.5, np.random.default_rng(3)).values
    monkeypatch.setattr(np.linalg, "eigh", give_up)
    found = run_near(700.5, np.random.default_rng(3)).values
    np.testing.assert_allclose(found, expected, rtol=1e-12)
