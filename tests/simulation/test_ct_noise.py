"""Noise, blur and streaks: their size and spectrum are what was asked for."""

import numpy as np
import pytest
from scipy.special import erf

from auricle.simulation.ct_noise import blurred, noise_slices, stepped, streaks


@pytest.fixture(scope="module")
def noise():
    slices = noise_slices(np.random.default_rng(5), (96, 128), (0.8, 0.7))
    return np.array([next(slices) for _ in range(40)])


def test_noise_has_unit_deviation_and_no_mean(noise):
    assert noise.dtype == np.float32
    assert noise.std() == pytest.approx(1.0, abs=0.01)
    assert abs(noise.mean()) < 1e-3


def test_neighbouring_slices_are_alike_as_their_weights_say(noise):
    def alike(lag):
        return float((noise[lag:] * noise[:-lag]).mean())

    total = 1 + 2 * 0.35**2
    assert alike(1) == pytest.approx(2 * 0.35 / total, abs=0.02)
    assert alike(2) == pytest.approx(0.35**2 / total, abs=0.02)
    assert abs(alike(3)) < 0.02


def test_the_noise_power_is_a_ramp_that_falls_off_again(noise):
    power = (np.abs(np.fft.fft2(noise)) ** 2).mean(axis=0)
    frequency = np.hypot(np.fft.fftfreq(96, 0.8)[:, None], np.fft.fftfreq(128, 0.7))
    expected = frequency * np.exp(-((frequency / 0.35) ** 2))
    expected /= expected.sum() / power.sum()
    for low, high in ((0.02, 0.1), (0.1, 0.2), (0.2, 0.35), (0.35, 0.5), (0.5, 0.7)):
        band = (frequency >= low) & (frequency < high)
        assert power[band].mean() == pytest.approx(expected[band].mean(), rel=0.06)


def test_a_blurred_edge_is_the_error_function():
    edge = np.zeros((7, 9, 80), dtype=np.float32)
    edge[:, :, 40:] = 100.0
    soft = blurred(edge, (0.0, 1.0, 3.0))
    from_edge = np.arange(80) - 39.5
    np.testing.assert_allclose(soft[3, 4], 50 * (1 + erf(from_edge / (3 * np.sqrt(2)))), atol=0.6)


def test_streaks_are_strongest_at_the_metal_and_do_not_move_the_mean():
    rays = streaks((101, 121), (1.0, 1.0), (50.0, 60.0))
    assert np.abs(rays).max() <= 1.0
    assert abs(rays.mean()) < 0.01
    assert np.abs(rays[45:56, 55:66]).mean() > 3 * np.abs(rays[:10, :10]).mean()


def test_a_step_moves_a_slice_by_pixels():
    plane = np.zeros((20, 20), dtype=np.float32)
    plane[8, 9] = 8.0
    moved = stepped(plane, (2.0, 0.5))
    assert moved[10, 9] == pytest.approx(4.0)
    assert moved[10, 10] == pytest.approx(4.0)
