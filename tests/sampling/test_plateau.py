"""Bounds of a map: told by plateaus, not by tips, and not by noise."""

import numpy as np
import pytest

from auricle.sampling.plateau import (
    STEEPNESS,
    plateau_bounds,
    steepened,
    two_levels,
    within_plateaus,
)


def test_a_focus_on_a_floor_has_a_floor_and_no_ceiling() -> None:
    """Distances drawn evenly by area: few samples come near the peak."""
    radii = 60 * np.sqrt(np.linspace(0.01, 1.0, 150))
    lower, upper = plateau_bounds(np.exp(-(radii**2) / (2 * 8**2)), 0.0)
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


@pytest.mark.parametrize("noise", [0.03, 0.06])
def test_plateaus_are_seen_under_noise_that_was_not_found(noise: float) -> None:
    """The bound is the plateau itself, not the lowest of its noisy samples."""
    step = np.repeat([0.0, 1.0], [160, 40])
    for seed in range(20):
        values = step + noise * np.random.default_rng(seed).standard_normal(200)
        assert values.min() < -1.5 * noise
        assert plateau_bounds(values, 0.1 * noise) == pytest.approx((0.0, 1.0), abs=noise / 2)


def test_few_samples_of_a_step_under_noise_have_their_ceiling_too() -> None:
    found = 0
    for seed in range(40):
        noise = 0.06 * np.random.default_rng(seed).standard_normal(50)
        bounds = plateau_bounds(np.repeat([0.0, 1.0], [46, 4]) + noise, 0.005)
        found += bounds == pytest.approx((0.0, 1.0), abs=0.1)
    assert found >= 36


def test_of_values_without_a_plateau_hardly_any_are_cut_off() -> None:
    """Measured voltages and intensities: a body and a tail, no level that many share."""
    cut = []
    for seed in range(100):
        rng = np.random.default_rng(seed)
        for values in (
            rng.normal(size=100),
            rng.uniform(size=100),
            rng.exponential(size=100),
            rng.lognormal(sigma=0.5, size=100),
        ):
            lower, upper = plateau_bounds(values, 0.0)
            cut.append(((values < lower) | (values > upper)).mean() > 0.05)
    assert np.mean(cut) < 0.02


def test_between_two_plateaus_a_map_is_steeper_half_way_and_keeps_its_order() -> None:
    ramp = np.linspace(0.0, 1.0, 1001)
    steep = steepened(ramp, 0.0, 1.0)
    assert (np.diff(steep) >= 0).all()
    slope = (steep[501] - steep[499]) / (ramp[501] - ramp[499])
    assert slope == pytest.approx(STEEPNESS, rel=1e-4)
    np.testing.assert_allclose(steep + steep[::-1], 1.0, atol=1e-12)
    np.testing.assert_allclose(steepened(5 - 2 * ramp, 3.0, 5.0), 5 - 2 * steep, atol=1e-12)


def test_a_map_is_cut_at_its_plateaus_and_steeper_only_between_two() -> None:
    ramp = np.linspace(-0.2, 1.2, 15)
    step, lone = np.repeat([0.0, 1.0], 20), np.append(np.zeros(30), np.linspace(0.3, 1.0, 8))
    within = np.clip(ramp, 0.0, 1.0)
    np.testing.assert_allclose(within_plateaus(ramp, step, 0.0), steepened(within, 0.0, 1.0))
    np.testing.assert_array_equal(within_plateaus(ramp, lone, 0.0), np.maximum(ramp, 0.0))
    np.testing.assert_array_equal(within_plateaus(ramp, np.linspace(0, 1, 40), 0.0), ramp)
    sloped = np.concatenate([np.zeros(30), np.linspace(0.1, 0.85, 20), np.ones(5)])
    assert plateau_bounds(sloped, 0.0) == (0.0, 1.0)
    np.testing.assert_array_equal(within_plateaus(ramp, sloped, 0.0), within)


def test_a_focus_with_a_smooth_top_has_not_two_levels_however_many_samples_tell() -> None:
    ceilings = 0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        radii = 60 * np.sqrt(rng.uniform(size=1000))
        focus = np.exp(-(radii**2) / (2 * 10**2))
        ceilings += plateau_bounds(focus, 0.0)[1] < np.inf
        assert not two_levels(focus, 0.0, float(focus.max()))
    assert ceilings <= 4


def test_a_step_with_a_few_samples_on_its_edge_has_two_levels() -> None:
    assert two_levels(np.repeat([0.0, 0.4, 1.0], [60, 6, 20]), 0.0, 1.0)
    assert not two_levels(np.repeat([0.0, 0.4, 1.0], [60, 21, 20]), 0.0, 1.0)
    assert not two_levels(np.zeros(9), -np.inf, np.inf)


@pytest.mark.parametrize("noise", [0.2, 1.0])
def test_under_noise_as_wide_as_the_samples_there_is_no_plateau(noise: float) -> None:
    assert plateau_bounds(np.array([0.0, 0.1, 0.2, 1.0, 1.1, 1.2]), noise) == (-np.inf, np.inf)
