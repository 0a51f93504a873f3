"""Decay: what was put in comes out, and the interval holds it as often as it says."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from auricle.errors import InputError
from auricle.sampling.decay import fit_decay

COUNTS = np.array([10, 25, 50, 75, 100, 150, 200, 250, 300, 400, 500, 700, 1000], dtype=float)


@settings(max_examples=40, deadline=None)
@given(st.floats(15, 1500), st.floats(1e-3, 1e3), st.floats(0, 2), st.booleans())
def test_an_exponential_gives_its_constants_back(tau, initial, share, floor):
    level = initial * share if floor else 0.0
    found = fit_decay(COUNTS, initial * np.exp(-COUNTS / tau) + level, floor=floor)
    assert found.tau == pytest.approx(tau, rel=0.01)
    assert found.initial == pytest.approx(initial, rel=0.01)
    assert found.floor == pytest.approx(level, rel=0.01, abs=0.01 * initial)
    assert found.residual < 1e-5 * initial
    assert found.tau_low <= found.tau <= found.tau_high


def test_the_order_of_counts_does_not_matter(rng):
    errors = 2 * np.exp(-COUNTS / 200) + 0.1 + 0.01 * rng.random(len(COUNTS))
    order = rng.permutation(len(COUNTS))
    one, other = (
        fit_decay(COUNTS, errors, floor=True),
        fit_decay(COUNTS[order], errors[order], floor=True),
    )
    assert one.tau == pytest.approx(other.tau, rel=1e-7)


@pytest.mark.parametrize("floor", [False, True])
def test_the_interval_holds_the_truth_about_as_often_as_it_says(floor, rng):
    held = 0
    for _ in range(80):
        noise = 0.03 * rng.standard_normal(len(COUNTS))
        errors = np.abs(2 * np.exp(-COUNTS / 170) + (0.5 if floor else 0.0) + noise)
        found = fit_decay(COUNTS, errors, floor=floor)
        held += found.tau_low <= 170 <= found.tau_high
    assert 0.88 < held / 80 < 1.0


def test_noise_shows_in_the_residual_and_the_width(rng):
    noise = rng.standard_normal(len(COUNTS))
    quiet, loud = (
        fit_decay(COUNTS, 2 * np.exp(-COUNTS / 170) + 0.5 + size * noise, floor=True)
        for size in (0.002, 0.02)
    )
    assert loud.residual == pytest.approx(10 * quiet.residual, rel=0.2)
    assert loud.tau_high - loud.tau_low > 5 * (quiet.tau_high - quiet.tau_low)


def test_without_a_floor_a_floor_lengthens_the_decay():
    errors = 2 * np.exp(-COUNTS / 170) + 0.5
    assert fit_decay(COUNTS, errors, floor=False).tau > 1.8 * 170


@pytest.mark.parametrize(
    ("counts", "errors", "fault"),
    [
        (COUNTS, np.ones(3), "do not belong together"),
        (np.array([1.0, 2, 3]), np.array([3.0, 2, 1]), "fewer than four"),
        (COUNTS, np.full(len(COUNTS), np.nan), "not finite"),
        (COUNTS, -np.exp(-COUNTS), "negative"),
        (COUNTS, COUNTS, "do not fall"),
        (COUNTS, np.ones(len(COUNTS)), "do not fall"),
    ],
)
def test_what_is_no_decay_is_refused(counts, errors, fault):
    with pytest.raises(InputError, match=fault):
        fit_decay(counts, errors, floor=True)
