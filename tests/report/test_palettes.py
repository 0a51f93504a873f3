"""Colours of maps: banded, limited by round numbers, grey where nothing is known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.colors import rgb_to_hsv

from auricle.errors import InputError
from auricle.report.palettes import (
    STYLES,
    UNKNOWN,
    ColourScale,
    round_boundaries,
    scale_for_field,
)
from auricle.surface.field import FieldMap
from auricle.surface.shapes import icosphere

SPHERE = icosphere(radius=10.0, subdivisions=2)
BOUNDARIES = (0.0, 1.0, 2.0, 3.0, 4.0)


def height(name="local_activation_time", unit="ms"):
    return FieldMap(SPHERE, SPHERE.vertices[:, 2], name, unit)


def test_a_value_takes_the_colour_of_its_band_and_beyond_that_of_the_nearest():
    scale = ColourScale("perceptual", BOUNDARIES, "x (mm)")
    values = np.array([-7.0, 0.0, 0.99, 1.0, 3.5, 4.0, 99.0])
    colours = scale.colours_of(values)
    assert np.array_equal(colours, scale.bands[[0, 0, 0, 1, 3, 3, 3]])


def test_nan_is_grey_and_no_band_is():
    for palette in (*STYLES, "distance"):
        scale = ColourScale(palette, BOUNDARIES, "x (mm)")
        assert (scale.colours_of(np.array([np.nan])) == UNKNOWN).all()
        assert np.abs(scale.bands - UNKNOWN).max(axis=1).min() > 25


def test_the_colour_bar_has_the_colours_of_the_picture():
    scale = ColourScale("EP classic", BOUNDARIES, "x (mV)")
    middles = np.array([0.5, 1.5, 2.5, 3.5])
    shown = 255 * scale.colormap(scale.norm(middles))[:, :3]
    np.testing.assert_allclose(shown, scale.colours_of(middles), atol=0.5)


def test_equal_steps_grow_lighter_in_the_perceptual_palette():
    bands = ColourScale("perceptual", tuple(np.arange(11.0)), "x (mm)").bands
    assert (np.diff(bands @ [0.2126, 0.7152, 0.0722]) > 0).all()


def test_the_mapping_systems_colours_run_from_red_to_purple():
    hues = rgb_to_hsv(ColourScale("EP classic", tuple(np.arange(11.0)), "x (mV)").bands / 255)[:, 0]
    assert hues[0] < 0.08
    assert 0.7 < hues[-1] < 0.8
    assert (np.diff(hues) > 0).all()


def test_the_cyclic_palette_ends_where_it_starts():
    bands = ColourScale("cyclic", tuple(np.arange(41.0)), "x (ms)").bands
    assert np.abs(bands[0] - bands[-1]).max() < 25
    assert np.abs(bands[0] - bands[20]).max() > 100


@given(
    low=st.floats(-1e6, 1e6),
    spread=st.floats(1e-3, 1e6),
    n_bands=st.integers(3, 12),
)
def test_boundaries_are_few_even_and_hold_the_values(low, spread, n_bands):
    values = np.linspace(low, low + spread, 101)
    boundaries = round_boundaries(values, n_bands=n_bands, share=1.0)
    steps = np.diff(boundaries)
    assert 1 <= len(steps) <= n_bands + 1
    np.testing.assert_allclose(steps, steps[0], rtol=1e-4)
    tolerance = 1e-6 * steps[0] + 1e-9 * abs(low)
    assert boundaries[0] <= values[0] + tolerance
    assert boundaries[-1] >= values[-1] - tolerance


def test_outliers_do_not_stretch_the_scale():
    values = np.append(np.linspace(0, 2, 1000), 1e6)
    assert round_boundaries(values)[-1] <= 2.5


def test_a_map_that_is_nearly_constant_still_has_a_scale():
    mask = np.zeros(1000)
    mask[:3] = 1.0
    boundaries = round_boundaries(mask)
    assert (boundaries[0], boundaries[-1]) == (0.0, 1.0)


def test_nothing_known_has_no_scale():
    with pytest.raises(InputError, match="leave it out"):
        round_boundaries(np.array([np.nan, np.nan]))


@pytest.mark.parametrize("boundaries", [(1.0,), (1.0, 1.0), (2.0, 1.0)])
def test_boundaries_that_do_not_ascend_are_refused(boundaries):
    with pytest.raises(InputError, match="ascending"):
        ColourScale("perceptual", boundaries, "x (mm)")


def test_unknown_palettes_and_styles_are_refused():
    with pytest.raises(InputError, match="choose from"):
        ColourScale("jet", BOUNDARIES, "x (mm)")
    with pytest.raises(InputError, match="choose from"):
        scale_for_field(height(), "x", style="jet")


def test_only_times_are_cyclic():
    assert scale_for_field(height(), "x", style="cyclic").palette == "cyclic"
    voltage = height("bipolar_voltage", "mV")
    assert scale_for_field(voltage, "x", style="cyclic").palette == "perceptual"


def test_the_scale_of_a_field_names_its_unit():
    assert scale_for_field(height(), "time").label == "time (ms)"
    assert scale_for_field(height("tawss", ""), "stress").label == "stress (no unit stated)"
