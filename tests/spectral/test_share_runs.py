"""Runs through shares: what each finds is complete, and the same whoever is done first."""

from itertools import pairwise

import numpy as np
import pytest
from scipy import sparse

from auricle.errors import SolverError
from auricle.spectral import share_runs
from auricle.spectral.factorization import analyze, factorize
from auricle.spectral.lanczos import LanczosRun
from auricle.spectral.narrow_products import aligned_groups
from auricle.spectral.share_runs import MOST_VECTORS, ShareRuns
from auricle.spectral.shifts import Factorable, Outlook, Share
from auricle.spectral.workers import Workers

SIZE = 2000
FOOT = Outlook(end=0, height=0.0, n_below=0, density=1.0)


def runs_of(values, threads: int) -> ShareRuns:
    matrix = sparse.csc_array(sparse.diags_array(np.asarray(values, float)))
    bases = [aligned_groups(MOST_VECTORS // 8 + 1, len(values), 8) for _ in range(threads)]
    factorable = Factorable(matrix, analyze(matrix))
    return ShareRuns(factorable, bases, np.random.default_rng(0), Workers(threads))


def found(values, threads: int, goal: int) -> list:
    return [
        (run.factors.shift, run.factors.n_below, run.values, is_last)
        for run, is_last in runs_of(values, threads).upwards(FOOT, goal)
    ]


@pytest.mark.parametrize("goal", [30, 90, 333])
def test_neighbours_find_together_all_that_lies_between_their_shifts(goal) -> None:
    runs = found(np.arange(1.0, SIZE + 1), 2, goal)
    assert [is_last for *_, is_last in runs] == [False] * (len(runs) - 1) + [True]
    assert runs[0][2][0] == pytest.approx(1.0)
    assert runs[-1][2][-1] >= goal - 1e-9
    for (_, n_low, low, _), (_, n_high, high, _) in pairwise(runs):
        assert 0 < n_high - n_low < 120
        between = np.union1d(low.round(6), high.round(6))
        assert set(range(n_low + 1, n_high + 1)) <= set(between)


def test_one_thread_finds_the_same_digits_as_two(rng) -> None:
    values = np.cumsum(rng.exponential(size=SIZE))
    for one, two in zip(found(values, 1, 400), found(values, 2, 400), strict=True):
        assert (one[0], one[1], one[3]) == (two[0], two[1], two[3])
        np.testing.assert_array_equal(one[2], two[2])


def test_each_share_is_laid_on_what_was_counted_in_the_one_below(rng, monkeypatch) -> None:
    laid = []
    factors_amid = share_runs.factors_amid

    def noted(factorable, share, outlook):
        factors = factors_amid(factorable, share, outlook)
        laid.append((share, outlook, factors.shift, factors.n_below))
        return factors

    monkeypatch.setattr(share_runs, "factors_amid", noted)
    found(np.cumsum(rng.exponential(size=SIZE)), 1, 400)
    for (below, _, shift, n_below), (share, outlook, *_) in pairwise(laid[1:]):
        assert outlook[1:3] == (shift, n_below)
        assert share.first == 2 * n_below - below.first


def test_a_basis_is_not_used_before_its_vectors_are_taken() -> None:
    runs = runs_of(np.arange(1.0, SIZE + 1), 2)
    for run, _ in runs.upwards(FOOT, 400):
        vectors = run.vectors(0, runs.workers)
        beyond = runs.factorable.matrix @ vectors - vectors * run.values
        assert np.linalg.norm(beyond, axis=0).max() < 1e-8


def test_what_goes_wrong_in_a_run_is_heard_of(monkeypatch) -> None:
    """And not waited for: the next share is laid on what is counted there."""

    def fail(*_given):
        raise SolverError("no shift can be factored")

    monkeypatch.setattr(share_runs, "factors_amid", fail)
    with pytest.raises(SolverError, match="no shift"):
        found(np.arange(1.0, SIZE + 1), 2, 400)


def test_a_shift_next_to_an_eigenvalue_is_moved_after_a_few_steps(rng, monkeypatch) -> None:
    """A whole run there would be wasted: what it finds far from the shift is not right."""
    runs = runs_of(np.arange(1.0, SIZE + 1), 1)
    extended = []
    extend = LanczosRun._extend

    def noted(self, n_steps):
        extended.append((self.factors.shift, n_steps))
        extend(self, n_steps)

    monkeypatch.setattr(LanczosRun, "_extend", noted)
    near = factorize(runs.factorable.matrix, 30.001)
    run = runs._found(Share(20, 40), near, rng, runs.bases[0])
    assert abs(run.factors.shift - round(run.factors.shift)) == pytest.approx(0.5, abs=0.05)
    assert [steps for shift, steps in extended if shift == near.shift] == [share_runs._GLANCE]
    np.testing.assert_allclose(run.values, np.round(run.values), atol=1e-9)
    with pytest.raises(SolverError, match="let go"):
        near.solver()
