"""Spectra: shares, counts and what they refuse."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from auricle.errors import BandError, InputError
from auricle.spectral.power import Spectrum


def flat(n_modes: int, *, unsolved: float = 0.0) -> Spectrum:
    """A constant of power 100 and equal power in all other modes."""
    power = np.r_[100.0, np.ones(n_modes - 1)]
    return Spectrum(np.arange(n_modes), power, n_modes - 1 + unsolved)


def test_equal_power_in_nine_modes_needs_all_nine_and_the_constant() -> None:
    assert flat(10).modes_for_power(1.0) == 10


def test_the_constant_mode_changes_the_answer_only_where_it_is_counted() -> None:
    assert flat(11).modes_for_power(0.90) == 10
    assert flat(11).modes_for_power(0.90, with_constant=True) == 1


def test_the_total_counts_modes_never_solved_for() -> None:
    with pytest.raises(BandError, match="solve for more"):
        flat(10, unsolved=91.0).modes_for_power(0.90)


def test_a_constant_map_is_refused() -> None:
    with pytest.raises(InputError, match="constant"):
        Spectrum([0.0, 1.0], [4.0, 0.0], varying_total=0.0)


@pytest.mark.parametrize("share", [0.0, -0.1, 1.1, float("nan")])
def test_a_share_outside_its_range_is_refused(share) -> None:
    with pytest.raises(InputError, match="share"):
        flat(10).modes_for_power(share)


@given(st.lists(st.floats(0.0, 1e6), min_size=2, max_size=40), st.floats(0.01, 1.0))
def test_shares_rise_to_at_most_one_and_the_count_is_the_least(powers, share) -> None:
    power = np.array([1.0, *powers, 1.0])
    spectrum = Spectrum(np.arange(len(power)), power, power[1:].sum())
    cumulative = spectrum.cumulative()
    assert (np.diff(cumulative) >= 0).all()
    assert cumulative[-1] == pytest.approx(1.0)
    count = spectrum.modes_for_power(share)
    assert cumulative[count - 1] >= share - 1e-11
    assert count == 1 or cumulative[count - 2] < share
