"""Velocities of waves that are known."""

import numpy as np
import pytest

from auricle.study.conduction_velocity import conduction_velocity, slowness, weighted_median
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere

BALL = icosphere(radius=30.0, subdivisions=4)
POLAR = 30.0 * np.arccos(np.clip(BALL.vertices[:, 2] / 30.0, -1, 1))
EVERYWHERE = np.ones(BALL.n_vertices, dtype=bool)


def tilted_plane() -> Mesh:
    x, y = (axis.reshape(-1) for axis in np.meshgrid(np.arange(9.0), np.arange(9.0)))
    corner = np.array([row * 9 + column for row in range(8) for column in range(8)])
    faces = np.vstack(
        [
            np.column_stack([corner, corner + 1, corner + 10]),
            np.column_stack([corner, corner + 10, corner + 9]),
        ]
    )
    return Mesh(np.column_stack([x, y + 0.3 * x, 0.7 * x - 0.2 * y]), faces)


def test_a_plane_wave_has_the_same_slowness_in_every_triangle_however_they_lie() -> None:
    plane = tilted_plane()
    along = plane.vertices[1] - plane.vertices[0]
    across = plane.vertices[9] - plane.vertices[0]
    direction = along / np.linalg.norm(along) - 0.4 * across
    direction /= np.linalg.norm(direction)
    found = slowness(plane, plane.vertices @ direction / 0.7)
    np.testing.assert_allclose(found, 1 / 0.7, rtol=1e-12)


def test_a_wave_from_the_pole_of_a_sphere_runs_at_its_velocity() -> None:
    times = POLAR / 0.8
    found = conduction_velocity(BALL, times, times[None], mapped=EVERYWHERE)
    assert found.of_map == pytest.approx(0.8, rel=0.01)
    assert found.low == found.expected == found.of_map == found.high
    assert np.isnan(found.vendor)
    equator = np.abs(BALL.vertices[:, 2]) < 20
    np.testing.assert_allclose(found.local[equator], 0.8, rtol=0.03)


def test_whole_cycles_added_anywhere_change_nothing() -> None:
    times = POLAR / 0.8
    cycles = np.random.default_rng(1).integers(-2, 3, BALL.n_vertices) * 200.0
    plain = slowness(BALL, times)
    np.testing.assert_allclose(slowness(BALL, times + cycles, cycle_length=200.0), plain, rtol=1e-9)
    assert slowness(BALL, times + cycles).max() > 10 * plain.max()


def test_only_what_was_mapped_counts() -> None:
    north = BALL.vertices[:, 2] > 0
    times = np.where(north, POLAR / 0.8, POLAR / 0.2)
    mapped = BALL.vertices[:, 2] > 3
    found = conduction_velocity(BALL, times, times[None], mapped=mapped)
    assert found.of_map == pytest.approx(0.8, rel=0.01)
    assert np.isnan(found.local[BALL.vertices[:, 2] < -3]).all()
    nothing = np.zeros(BALL.n_vertices, dtype=bool)
    assert conduction_velocity(BALL, times, times[None], mapped=nothing) is None


def test_the_range_is_that_of_the_draws_and_the_vendors_is_its_own() -> None:
    times = POLAR / 0.8
    draws = np.array([POLAR / speed for speed in np.linspace(0.5, 1.5, 21)])
    vendor = np.where(BALL.vertices[:, 0] > 0, np.nan, POLAR / 0.6)
    found = conduction_velocity(BALL, times, draws, mapped=EVERYWHERE, vendor=vendor)
    assert found.low == pytest.approx(0.55, rel=0.02)
    assert found.high == pytest.approx(1.45, rel=0.02)
    assert found.vendor == pytest.approx(0.6, rel=0.01)
    assert found.expected == pytest.approx(1.0, rel=0.02)
    assert (found.local_low <= found.local_high).all()


def test_half_of_the_weight_lies_below_the_weighted_median() -> None:
    rng = np.random.default_rng(2)
    values, weights = rng.normal(size=1001), rng.random(1001)
    middle = weighted_median(values, weights)
    assert weights[values < middle].sum() <= weights.sum() / 2 <= weights[values <= middle].sum()
