"""Shifts climb: each holds more eigenvalues under it than the last."""

import numpy as np
import pytest
from scipy import sparse

from auricle.spectral import shifts
from auricle.spectral.factorization import analyze
from auricle.spectral.ladder import Ladder
from auricle.spectral.shifts import Factorable, next_shifts
from auricle.spectral.workers import Workers

WORKERS = Workers(2)


def one_to(n: int) -> Factorable:
    matrix = sparse.csc_array(sparse.diags_array(np.arange(1.0, n + 1)))
    return Factorable(matrix, analyze(matrix))


def fresh() -> Ladder:
    return Ladder(np.empty(0), np.empty((1, 0)), certified=0.0, scale=1.0)


@pytest.mark.parametrize("count", [30, 60, 100])
def test_shifts_climb_in_equal_shares_and_the_last_is_told_what_to_complete(count) -> None:
    found = next_shifts(one_to(1000), fresh(), count=count, density=1.0, workers=WORKERS)
    assert found.ceiling is None
    assert found.wanted == count
    heights = [factors.n_below for factors in found.searched]
    share = (count + shifts.BEYOND) / (2 * len(heights))
    expected = share * (1 + 2 * np.arange(len(heights)))
    np.testing.assert_allclose(heights, expected, atol=1.5)


def test_a_spectrum_of_many_slices_is_begun_at_its_foot() -> None:
    found = next_shifts(one_to(1000), fresh(), count=500, density=1.0, workers=WORKERS)
    assert found.wanted is None
    assert len(found.searched) == shifts.AT_ONCE
    assert 30 < found.searched[0].n_below < 50


def test_what_was_found_above_the_certified_is_not_searched_again() -> None:
    """So much is known that only a count is left to be made."""
    ladder = Ladder(
        np.arange(1.0, 60.0), np.empty((1, 59)), certified=20.5, n_certified=20, scale=1.0
    )
    found = next_shifts(one_to(1000), ladder, count=50, density=1.0, workers=WORKERS)
    assert not found.searched
    assert found.ceiling is not None
    assert found.ceiling.n_below == 50


def test_the_last_count_does_not_cut_through_equal_eigenvalues() -> None:
    """As far as is known; where they reach as high as what is known, more is searched."""
    values = np.concatenate([np.arange(1.0, 50.0), np.full(5, 50.0)])
    known = Ladder(values, np.empty((1, 54)), certified=20.5, n_certified=20, scale=1.0)
    found = next_shifts(one_to(1000), known, count=51, density=1.0, workers=WORKERS)
    assert found.ceiling is None
    assert found.searched[0].shift > 50
    known.add(np.array([60.0]), np.empty((1, 1)))
    found = next_shifts(one_to(1000), known, count=51, density=1.0, workers=WORKERS)
    assert found.ceiling is not None
    assert found.ceiling.shift == pytest.approx(55.0, rel=1e-3)


def test_a_slice_denser_than_expected_is_cut_down() -> None:
    found = next_shifts(one_to(1000), fresh(), count=500, density=0.1, workers=WORKERS)
    (nearer,) = found.searched
    assert 0 < nearer.n_below <= 80
    assert found.wanted is None


def test_a_shift_that_had_to_move_past_the_next_leaves_that_out(monkeypatch) -> None:
    """The lower of two moves up by more than what lies between them."""
    factorize = shifts.factorize

    def moved(matrix, shift, *, symbolic, rooms):
        return factorize(matrix, shift + 54 * (shift < 30), symbolic=symbolic, rooms=rooms)

    monkeypatch.setattr(shifts, "factorize", moved)
    found = next_shifts(one_to(1000), fresh(), count=100, density=1.0, workers=WORKERS)
    (only,) = found.searched
    assert only.shift > 77
    assert found.wanted is None
