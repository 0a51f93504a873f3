"""Focal maps: their energy, their shape, their places."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.spatial.transform import Rotation

from auricle.errors import InputError
from auricle.simulation.foci import (
    focal_map,
    gaussian_modes_for_power,
    gaussian_width_for_modes,
    random_foci,
)
from auricle.surface.geodesics import exact_geodesic_distances
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere, joined, rectangle
from auricle.surface.soundness import vertex_areas

RADIUS = 30.0
SPHERE = icosphere(radius=RADIUS, subdivisions=4)
AREAS = vertex_areas(SPHERE)


@pytest.mark.parametrize("width", [3.0, 5.0, 10.0])
def test_the_energy_of_a_focus_on_a_sphere_is_its_integral(width):
    values = focal_map(SPHERE, centres=[17], width=width).values

    def ring(angle: float) -> float:
        distance = RADIUS * angle
        return 2 * np.pi * RADIUS**2 * np.sin(angle) * np.exp(-((distance / width) ** 2))

    energy = quad(ring, 0.0, np.pi)[0]
    assert (AREAS * values**2).sum() == pytest.approx(energy, rel=0.004)
    assert energy == pytest.approx(np.pi * width**2, rel=0.04)


def test_the_value_is_the_gaussian_of_the_straight_distance_on_a_flat_sheet():
    sheet = rectangle(width=40.0, height=30.0, n_x=21, n_y=16)
    distance = np.linalg.norm(sheet.vertices - sheet.vertices[100], axis=1)
    values = focal_map(sheet, centres=[100], width=5.0).values
    np.testing.assert_allclose(values, np.exp(-0.5 * (distance / 5.0) ** 2), atol=1.1e-9)


def test_a_disc_is_one_up_to_its_radius_and_zero_beyond():
    sheet = rectangle(width=40.0, height=30.0, n_x=21, n_y=16)
    distance = np.linalg.norm(sheet.vertices - sheet.vertices[100], axis=1)
    values = focal_map(sheet, centres=[100], width=7.0, profile="disc").values
    np.testing.assert_array_equal(values, distance <= 7.0)


def test_foci_add():
    together = focal_map(SPHERE, centres=[3, 900, 901], width=6.0)
    singly = [focal_map(SPHERE, centres=[centre], width=6.0).values for centre in (3, 900, 901)]
    np.testing.assert_allclose(together.values, np.sum(singly, axis=0), rtol=1e-14)
    assert (together.name, together.unit) == ("focal_activity", "")


@given(st.integers(0, 2**32 - 1), st.floats(-1e4, 1e4))
def test_a_focal_map_moves_with_the_surface(seed, shift):
    small = icosphere(radius=10.0, subdivisions=2)
    turn = Rotation.random(rng=np.random.default_rng(seed)).as_matrix()
    moved = Mesh(small.vertices @ turn.T + shift, small.faces)
    still = focal_map(small, centres=[5, 60], width=4.0).values
    np.testing.assert_allclose(
        focal_map(moved, centres=[5, 60], width=4.0).values, still, atol=1e-8
    )


def test_a_focus_does_not_leak_across_a_thin_wall():
    ball = icosphere(radius=10.0, subdivisions=3)
    disc = Mesh(ball.vertices * np.array([1.0, 1.0, 0.05]), ball.faces)
    top, bottom = np.argmax(disc.vertices[:, 2]), np.argmin(disc.vertices[:, 2])
    values = focal_map(disc, centres=[int(top)], width=4.0).values
    assert np.linalg.norm(disc.vertices[top] - disc.vertices[bottom]) == pytest.approx(1.0)
    assert values[bottom] < 1e-5


def test_a_focus_is_not_felt_on_another_piece():
    small = icosphere(radius=5.0, subdivisions=1)
    pair = joined([small, Mesh(small.vertices + 5.0, small.faces)])
    values = focal_map(pair, centres=[0], width=8.0).values
    assert (values[small.n_vertices :] == 0).all()
    assert values[0] == 1.0


def test_foci_keep_their_distance_and_their_place(rng):
    allowed = SPHERE.vertices[:, 2] > 0
    foci = random_foci(SPHERE, count=4, separation=20.0, rng=rng, allowed=allowed)
    assert all(allowed[focus] for focus in foci)
    for focus in foci:
        distance = exact_geodesic_distances(SPHERE, focus)
        assert sorted(distance[list(foci)])[1] >= 20.0


def test_the_first_foci_do_not_depend_on_how_many_follow():
    few, many = (
        random_foci(SPHERE, count=count, separation=20.0, rng=np.random.default_rng(5))
        for count in (2, 4)
    )
    assert many[:2] == few


def test_foci_are_drawn_evenly_over_the_area_not_over_the_vertices():
    fine = rectangle(width=10.0, height=10.0, n_x=21, n_y=21)
    coarse = rectangle(width=10.0, height=30.0, n_x=6, n_y=16)
    mesh = joined([fine, coarse])
    rng = np.random.default_rng(3)
    drawn = [random_foci(mesh, count=1, separation=0.0, rng=rng)[0] for _ in range(2000)]
    share_on_fine = np.mean(np.array(drawn) < fine.n_vertices)
    assert share_on_fine == pytest.approx(0.25, abs=4 * np.sqrt(0.25 * 0.75 / 2000))


def test_without_separation_foci_are_still_different_vertices(rng):
    small = icosphere(radius=1.0, subdivisions=0)
    assert sorted(random_foci(small, count=12, separation=0.0, rng=rng)) == list(range(12))


def test_no_foci_are_none(rng):
    assert random_foci(SPHERE, count=0, separation=10.0, rng=rng) == ()


@pytest.mark.parametrize(
    ("count", "separation", "allowed"),
    [(3, 90.0, None), (1, 0.0, np.zeros(SPHERE.n_vertices, dtype=bool)), (-1, 0.0, None)],
)
def test_foci_that_do_not_fit_are_refused(rng, count, separation, allowed):
    with pytest.raises(InputError, match="foci"):
        random_foci(SPHERE, count=count, separation=separation, rng=rng, allowed=allowed)


@pytest.mark.parametrize(
    "options",
    [
        {"centres": [], "width": 1.0},
        {"centres": [0], "width": 0.0},
        {"centres": [0], "width": np.nan},
        {"centres": [SPHERE.n_vertices], "width": 1.0},
        {"centres": [0], "width": 1.0, "profile": "square"},
    ],
)
def test_a_map_that_cannot_be_is_refused(options):
    with pytest.raises(InputError, match=": "):
        focal_map(SPHERE, **options)


@pytest.mark.parametrize("width", [2.0, 4.0])
def test_the_closed_form_is_the_power_in_legendre_polynomials_of_a_narrow_focus(width):
    """On a sphere (l + 1)² modes have degree l at most; no mesh is involved."""
    nodes, weights = np.polynomial.legendre.leggauss(1000)
    focus = np.exp(-0.5 * (RADIUS * np.arccos(nodes) / width) ** 2)
    degrees = np.arange(80)
    zonal = np.polynomial.legendre.legvander(nodes, degrees[-1])
    power = (zonal.T @ (weights * focus)) ** 2 * (2 * degrees + 1) / 2
    held = power[1:].cumsum() / power[1:].sum()
    for share in (0.5, 0.85, 0.95):
        modes = gaussian_modes_for_power(area=4 * np.pi * RADIUS**2, width=width, share=share)
        degree = np.interp(share, held, degrees[1:] + 1.0)
        assert degree**2 == pytest.approx(modes, rel=0.04)


@given(st.floats(1.0, 1e5), st.floats(0.1, 1e4), st.floats(0.01, 0.9999))
def test_width_and_number_of_modes_are_inverse(area, modes, share):
    width = gaussian_width_for_modes(area=area, modes=modes, share=share)
    again = gaussian_modes_for_power(area=area, width=width, share=share)
    assert again == pytest.approx(modes, rel=1e-12)


@pytest.mark.parametrize(
    ("area", "width", "share"), [(0, 1, 0.9), (1, 0, 0.9), (1, 1, 1), (1, 1, 0)]
)
def test_the_closed_form_refuses_what_has_no_answer(area, width, share):
    with pytest.raises(InputError, match="give"):
        gaussian_modes_for_power(area=area, width=width, share=share)
    with pytest.raises(InputError, match="give"):
        gaussian_width_for_modes(area=area, modes=width, share=share)
