"""Bounds of a map: told by plateaus, not by tips, and not by noise."""

import numpy as np
import pytest

from auricle.sampling.plateau import plateau_bounds


def test_a_focus_on_a_floor_has_a_floor_and_no_ceiling() -> None:
    """Distances drawn evenly by area: few samples come near the peak."""
    radii = 60 * np.sqrt(np.linspace(0.01, 1.0, 150))
    lower, upper = plateau_bounds(np.exp(-(radii**2) / (2 * 10**2)), 0.0)
    assert lower == pytest.approx(0.0, abs=1e-6)
    assert upper == np.inf


def test_smooth_tops_and_tips_are_no_bounds() -> None:
    """Drawn evenly by area: as many near a smooth top as anywhere, fewer near a cone's tip."""
    area = np.linspace(0.0, 1.0, 100)
    assert plateau_bounds(area, 0.0) == (-np.inf, np.inf)
    assert plateau_bounds(np.sqrt(area), 0.0) == (-np.inf, np.inf)
    assert plateau_bounds(area, 0.05) == (-np.inf, np.inf)


def test_plateaus_are_seen_under_a_little_noise() -> None:
    rng = np.random.default_rng(1)
    step = np.repeat([0.0, 1.0], 50)
    for noise in (0.0, 0.004):
        lower, upper = plateau_bounds(step + noise * rng.standard_normal(100), noise)
        assert lower == pytest.approx(0.0, abs=4 * noise)
        assert upper == pytest.approx(1.0, abs=4 * noise)


def test_one_sample_at_an_end_is_no_plateau() -> None:
    lone = np.append(np.zeros(30), 1.0)
    assert plateau_bounds(lone, 0.0) == (0.0, np.inf)


def test_bounds_move_and_turn_with_the_values() -> None:
    values = np.concatenate([np.zeros(20), np.linspace(0.1, 1.0, 15) ** 0.5])
    lower, upper = plateau_bounds(values, 0.01)
    assert plateau_bounds(3 * values + 2, 0.03) == pytest.approx((3 * lower + 2, 3 * upper + 2))
    assert plateau_bounds(-values, 0.01) == pytest.approx((-upper, -lower))
