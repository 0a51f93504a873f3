"""Activation times: distances over a velocity, the earliest wave first."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from auricle.errors import InputError, SurfaceError
from auricle.simulation.activation import activation_map
from auricle.surface.geodesics import exact_geodesic_distances
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere, joined, rectangle

SPHERE = icosphere(radius=30.0, subdivisions=4)


def test_on_a_sphere_a_wave_arrives_after_the_angle_times_the_radius_over_the_velocity():
    pole = SPHERE.vertices[17] / 30.0
    angle = np.arccos(np.clip(SPHERE.vertices @ pole / 30.0, -1, 1))
    times = activation_map(SPHERE, foci=[17], velocity=0.5).values
    assert np.abs(times - 30.0 * angle / 0.5).max() < 0.015 * 30.0 * np.pi / 0.5


def test_times_are_those_of_exact_distances_within_a_hundredth_on_a_bumpy_surface():
    x, y, z = SPHERE.vertices.T / 30
    bumpy = Mesh(SPHERE.vertices * (1 + 0.2 * x * y + 0.2 * z**3)[:, None], SPHERE.faces)
    exact = exact_geodesic_distances(bumpy, 5)
    times = activation_map(bumpy, foci=[5], velocity=1.0).values
    assert np.quantile(np.abs(times - exact)[exact > 0] / exact[exact > 0], 0.95) < 0.01


def test_the_earliest_of_several_waves_counts():
    first, second, both = (
        activation_map(SPHERE, foci=foci, velocity=0.8).values for foci in ([0], [900], [0, 900])
    )
    assert np.array_equal(both, np.minimum(first, second))


def test_a_late_focus_is_activated_by_an_early_one():
    late = activation_map(SPHERE, foci=[0, 900], velocity=1.0, onsets=[0.0, 1000.0]).values
    assert np.array_equal(late, activation_map(SPHERE, foci=[0], velocity=1.0).values)


def test_a_focus_fires_at_its_onset():
    times = activation_map(SPHERE, foci=[0, 900], velocity=1.0, onsets=[3.0, 7.0]).values
    assert times[0] == 3.0
    assert times[900] == 7.0
    assert times.min() == 3.0


@given(velocity=st.floats(0.1, 3.0))
def test_times_are_inverse_to_the_velocity(velocity):
    sheet = rectangle(width=20.0, height=10.0, n_x=9, n_y=5)
    at_one, at_velocity = (
        activation_map(sheet, foci=[3], velocity=each).values for each in (1.0, velocity)
    )
    assert np.allclose(at_velocity * velocity, at_one)


def test_what_cannot_be_activated_is_refused():
    two = joined([SPHERE, Mesh(SPHERE.vertices + 100.0, SPHERE.faces)])
    with pytest.raises(SurfaceError, match="no wave reaches"):
        activation_map(two, foci=[0], velocity=1.0)
    with pytest.raises(InputError, match="no foci"):
        activation_map(SPHERE, foci=[], velocity=1.0)
    with pytest.raises(InputError, match="velocity"):
        activation_map(SPHERE, foci=[0], velocity=0.0)
    with pytest.raises(InputError, match="2 onsets for 1 foci"):
        activation_map(SPHERE, foci=[0], velocity=1.0, onsets=[0.0, 1.0])
    with pytest.raises(InputError, match="source vertices"):
        activation_map(SPHERE, foci=[99_999], velocity=1.0)
