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
    return Ladder(np.empty(0), [], certified=0.0)


@pytest.mark.parametrize("count", [1, 30, 60, 500])
def test_neighbouring_shifts_climb_and_the_last_of_all_lies_just_beyond(count) -> None:
    found = next_shifts(one_to(1000), fresh(), count=count, density=1.0, workers=WORKERS)
    heights = [factors.n_below for factors in found]
    assert np.all(np.diff([0, *heights]) > 0)
    assert heights[-1] <= count + 4
    assert heights[0] >= min(count, 40)


def test_a_slice_denser_than_expected_is_cut_down() -> None:
    (nearer,) = next_shifts(one_to(1000), fresh(), count=500, density=0.1, workers=WORKERS)
    assert 0 < nearer.n_below <= 80


def test_a_shift_that_had_to_move_past_the_next_leaves_that_out(monkeypatch) -> None:
    """Two lie a shift's breadth apart where the last one wanted is near."""
    factorize = shifts.factorize

    def moved(matrix, shift, *, symbolic):
        return factorize(matrix, shift + 2 * (shift < 21.7), symbolic=symbolic)

    monkeypatch.setattr(shifts, "factorize", moved)
    (only,) = next_shifts(one_to(1000), fresh(), count=39, density=1.9, workers=WORKERS)
    assert only.n_below == 23
