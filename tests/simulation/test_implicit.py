"""Distances to implicit shapes and their smooth unions."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from auricle.simulation.implicit import (
    ellipsoid_distance,
    half_space_distance,
    smooth_maximum,
    smooth_minimum,
    sphere_distance,
    swept_distance,
)
from auricle.surface.shapes import ellipsoid

distances = st.floats(-50.0, 50.0)


@given(distances, distances, st.floats(0.1, 20.0))
def test_a_smooth_union_lies_at_most_a_quarter_of_the_blend_below_the_sharp_one(a, b, blend):
    first, second = np.array(a), np.array(b)
    smooth = smooth_minimum(first, second, blend=blend)
    assert min(a, b) - blend / 4 - 1e-12 <= smooth <= min(a, b)
    assert smooth == smooth_minimum(second, first, blend=blend)
    if abs(a - b) >= blend:
        assert smooth == min(a, b)
    np.testing.assert_allclose(smooth_maximum(-first, -second, blend=blend), -smooth)


def test_a_smooth_union_has_no_kink():
    first = np.linspace(-3.0, 3.0, 6001)
    slopes = np.diff(smooth_minimum(first, np.zeros_like(first), blend=2.0)) / np.diff(first)
    assert np.abs(np.diff(slopes)).max() < 0.001
    assert (slopes[0], slopes[-1]) == (pytest.approx(1.0), pytest.approx(0.0))


def test_the_ellipsoid_distance_vanishes_on_it_and_grows_by_the_step_off_it():
    semi_axes = np.array([12.0, 20.0, 30.0])
    surface = ellipsoid(semi_axes=(12.0, 20.0, 30.0), subdivisions=3).vertices
    normals = surface / semi_axes**2
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    for step in (-0.05, 0.0, 0.05):
        x, y, z = (surface + step * normals).T
        found = ellipsoid_distance((x, y, z), semi_axes)
        np.testing.assert_allclose(found, step, atol=0.0003)


def test_the_ellipsoid_distance_is_finite_and_inside_at_its_centre():
    centre = (np.zeros(1), np.zeros(1), np.zeros(1))
    assert ellipsoid_distance(centre, np.array([12.0, 20.0, 30.0])) == -12.0


def test_a_sweep_of_equal_spheres_is_a_capsule(rng):
    centres = np.column_stack([np.linspace(0, 20, 60), np.zeros(60), np.zeros(60)])
    points = rng.uniform(-10, 30, size=(500, 3))
    nearest = np.column_stack([np.clip(points[:, 0], 0, 20), np.zeros((500, 2))])
    capsule = np.linalg.norm(points - nearest, axis=1) - 5.0
    at = (points[:, 0], points[:, 1], points[:, 2])
    outside = capsule > 0
    found = swept_distance(at, centres, np.full(60, 5.0))
    assert outside.sum() > 100
    np.testing.assert_allclose(found[outside], capsule[outside], atol=0.003)
    assert (found[capsule < -0.003] < 0).all()


def test_spheres_and_half_spaces_are_measured_along_a_grid():
    x, y, z = np.arange(3.0)[:, None, None], np.arange(4.0)[None, :, None], np.arange(5.0)
    sphere = sphere_distance((x, y, z), np.array([1.0, 1.0, 1.0]), 2.0)
    assert sphere.shape == (3, 4, 5)
    assert sphere[1, 1, 4] == 1.0
    half = half_space_distance((x, y, z), np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.6, 0.8]))
    assert half[2, 3, 4] == pytest.approx(0.6 * 3 + 0.8 * 3)
