import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from auricle.errors import ImageError
from auricle.imaging.diffusion import perona_malik


@pytest.fixture
def noise(rng):
    return rng.normal(100.0, 20.0, size=(14, 15, 16)).astype(np.float32)


def test_the_sum_stays_and_no_value_leaves_the_range(noise):
    smooth = perona_malik(noise, iterations=20)
    assert smooth.mean() == pytest.approx(noise.mean(), rel=1e-5)
    assert noise.min() < smooth.min() < smooth.max() < noise.max()


def test_noise_is_halved_and_a_step_ten_times_the_contrast_is_left_alone(noise):
    step = np.zeros_like(noise)
    step[7:] = 400.0
    smooth = perona_malik(noise + step)
    assert (smooth - step).std() < 0.6 * noise.std()
    rise = smooth[7].mean() - smooth[6].mean()
    assert rise == pytest.approx(400.0, abs=10.0)


def test_a_step_below_the_contrast_is_blurred():
    step = np.zeros((12, 3, 3))
    step[6:] = 20.0
    assert np.diff(perona_malik(step)[:, 1, 1]).max() < 8.0


@given(axes=st.permutations([0, 1, 2]), flip=st.integers(0, 2))
@settings(max_examples=8, deadline=None)
def test_no_axis_and_no_direction_is_preferred(axes, flip):
    values = np.random.default_rng(3).normal(0.0, 30.0, (5, 6, 7))
    turned = np.flip(values.transpose(axes), flip)
    expected = np.flip(perona_malik(values).transpose(axes), flip)
    np.testing.assert_allclose(perona_malik(turned), expected, atol=1e-3)


def test_no_iteration_returns_the_values_and_the_input_is_never_changed(noise):
    before = noise.copy()
    np.testing.assert_array_equal(perona_malik(noise, iterations=0), noise)
    perona_malik(noise)
    np.testing.assert_array_equal(noise, before)


@pytest.mark.parametrize(
    "options", [{"contrast": 0.0}, {"iterations": -1}, {"time_step": 0.2}, {"time_step": 0.0}]
)
def test_options_that_would_not_converge_are_refused(options, noise):
    with pytest.raises(ImageError, match="positive contrast"):
        perona_malik(noise, **options)


def test_a_slice_is_no_volume():
    with pytest.raises(ImageError, match="2-dimensional"):
        perona_malik(np.zeros((4, 4)))
