"""Steps of block Lanczos: a recurrence, however many are taken at once."""

import numpy as np
import pytest
from scipy import sparse

from auricle.spectral import lanczos_steps
from auricle.spectral.factorization import factorize
from auricle.spectral.gram_schmidt import orthonormalize
from auricle.spectral.lanczos_steps import LEAST_LOST, Lost, Recurrence, take_steps

N, STEPS = 400, 12
FRESH = Lost(0.0, LEAST_LOST, 2e-11, LEAST_LOST, LEAST_LOST, 0)


def begun(rng, block: int, n_known: int = 0, end: int = N) -> Recurrence:
    """A first block, beside groups of known vectors, which are unit vectors.

    Its entries from `end` on are 1e-8 of what they would be.
    """
    lanes = min(block, 8)
    basis = np.zeros((n_known + (STEPS + 1) * block // lanes, N, lanes))
    for i in range(n_known * lanes):
        basis[i // lanes, i, i % lanes] = 1.0
    start = basis[n_known : n_known + block // lanes]
    start[:, n_known * lanes :] = rng.standard_normal((len(start), N - n_known * lanes, lanes))
    start[:, end:] *= 1e-8
    rows = rows_of(start)
    coupling = orthonormalize(start, rows @ rows.T)
    return Recurrence(basis, np.zeros((STEPS * block, STEPS * block)), coupling)


def rows_of(groups):
    return groups.swapaxes(1, 2).reshape(-1, groups.shape[1])


def factors_at(shift: float):
    """Of a matrix with the eigenvalues 0, 1, 2, ..."""
    return factorize(sparse.csc_array(sparse.diags_array(np.arange(float(N)))), shift)


@pytest.mark.parametrize(("block", "n_known"), [(4, 0), (8, 0), (16, 0), (4, 3), (8, 1)])
def test_the_basis_is_orthonormal_and_turns_the_inverse_into_a_band(rng, block, n_known) -> None:
    run, shift = begun(rng, block, n_known), 150.3
    take_steps(factors_at(shift).solver(), run, FRESH, n_known, (0, STEPS))
    rows = rows_of(run.basis)
    np.testing.assert_allclose(rows @ rows.T, np.eye(len(rows)), atol=1e-10)
    own = rows[n_known * run.basis.shape[2] :][: STEPS * block]
    inverse = own / (np.arange(N) - shift) @ own.T
    np.testing.assert_allclose(run.projected, inverse, atol=1e-9)


@pytest.mark.parametrize("n_first", [1, 5])
def test_steps_taken_apart_are_those_taken_at_once(rng, n_first) -> None:
    solver = factors_at(150.3).solver()
    once = begun(rng, 4)
    apart = Recurrence(*(part.copy() for part in once))
    lost = take_steps(solver, once, FRESH, 0, (0, STEPS))
    first = take_steps(solver, apart, FRESH, 0, (0, n_first))
    assert take_steps(solver, apart, first, 0, (n_first, STEPS)) == lost
    for one, other in zip(once, apart, strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("block", [4, 8])
def test_vectors_that_come_out_parallel_are_made_orthonormal(rng, monkeypatch, block) -> None:
    """A block nearly in a space with one dimension more: what is left of its image lies in that."""
    by_householder, n_times = lanczos_steps.by_householder, []

    def counted(*arguments):
        n_times.append(1)
        return by_householder(*arguments)

    monkeypatch.setattr(lanczos_steps, "by_householder", counted)
    run, shift = begun(rng, block, end=block + 1), 2.3
    take_steps(factors_at(shift).solver(), run, FRESH, 0, (0, STEPS))
    assert n_times
    rows = rows_of(run.basis)
    np.testing.assert_allclose(rows @ rows.T, np.eye(len(rows)), atol=1e-6)
    own = rows[: STEPS * block]
    inverse = own / (np.arange(N) - shift) @ own.T
    np.testing.assert_allclose(run.projected, inverse, atol=1e-6)
