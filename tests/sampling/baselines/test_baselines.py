"""Baselines: what nearest, weighted, harmonic and radial interpolation must and must not do."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from auricle.errors import InputError, SurfaceError
from auricle.sampling.baselines import BASELINES
from auricle.sampling.baselines.interpolation import nearest_sites
from auricle.sampling.chamber import Chamber
from auricle.sampling.sites import Sites
from auricle.spectral.harmonics import Harmonics
from auricle.surface.geodesics import exact_geodesic_distances
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import ellipsoid, icosphere, joined, rectangle
from auricle.surface.soundness import vertex_areas

every_baseline = pytest.mark.parametrize("interpolate", BASELINES.values(), ids=BASELINES)


def bare(mesh: Mesh) -> Chamber:
    """A chamber without harmonics: baselines do not need any."""
    basis = Harmonics(np.zeros(1), np.ones((mesh.n_vertices, 1)), vertex_areas(mesh), "none", None)
    return Chamber(mesh, basis, np.ones(mesh.n_vertices, dtype=bool))


BALL = bare(icosphere(radius=30.0, subdivisions=3))
INDICES = np.random.default_rng(1).choice(BALL.mesh.n_vertices, 40, replace=False)
AT_VERTICES = Sites.at_vertices(INDICES)
VALUES = np.random.default_rng(2).normal(size=40)


@every_baseline
def test_samples_at_vertices_are_met(interpolate):
    found = interpolate(BALL, AT_VERTICES, VALUES)
    assert np.abs(found[INDICES] - VALUES).max() < 1e-4


@every_baseline
def test_equal_samples_give_a_constant_map(interpolate):
    found = interpolate(BALL, AT_VERTICES, np.full(40, 1e5))
    assert np.abs(found / 1e5 - 1).max() < 1e-9


@every_baseline
def test_several_maps_at_once_are_those_one_by_one(interpolate):
    both = interpolate(BALL, AT_VERTICES, np.column_stack([VALUES, VALUES**2]))
    assert both.shape == (BALL.mesh.n_vertices, 2)
    for column, values in zip(both.T, (VALUES, VALUES**2), strict=True):
        assert np.allclose(column, interpolate(BALL, AT_VERTICES, values))


@every_baseline
def test_the_order_of_the_samples_does_not_matter(interpolate):
    order = np.random.default_rng(3).permutation(40)
    one = interpolate(BALL, AT_VERTICES, VALUES)
    other = interpolate(BALL, AT_VERTICES[order], VALUES[order])
    # A vertex exactly between two samples may change hands.
    assert np.mean(np.abs(other - one) > 1e-6) < 0.03


@every_baseline
def test_denser_samples_bring_a_smooth_map_nearer(interpolate):
    truth = np.exp(BALL.mesh.vertices[:, 0] / 15)
    order = np.random.default_rng(4).permutation(BALL.mesh.n_vertices)
    few, many = (
        BALL.nrmse(interpolate(BALL, Sites.at_vertices(order[:n]), truth[order[:n]]), truth)
        for n in (30, 300)
    )
    assert many < 0.6 * few


@every_baseline
def test_beyond_the_fill_threshold_there_is_nothing_and_within_it_what_there_was(interpolate):
    everywhere = interpolate(BALL, AT_VERTICES, VALUES)
    filled = interpolate(BALL, AT_VERTICES, VALUES, fill_threshold_mm=7.0)
    distances = np.min(
        [exact_geodesic_distances(BALL.mesh, i, reach=20.0) for i in INDICES], axis=0
    )
    clear = np.abs(distances - 7.0) > 0.2
    assert np.array_equal(np.isnan(filled)[clear], (distances > 7.0)[clear])
    assert np.isnan(filled).any()
    kept = np.isfinite(filled)
    assert np.array_equal(filled[kept], everywhere[kept])


@every_baseline
def test_repeated_samples_are_no_obstacle(interpolate):
    twice = Sites.at_vertices(np.tile(INDICES, 2))
    found = interpolate(BALL, twice, np.tile(VALUES, 2))
    assert np.allclose(found, interpolate(BALL, AT_VERTICES, VALUES), atol=1e-4)


@pytest.mark.parametrize("name", ["inverse_distance", "harmonic", "linear_radial", "thin_plate"])
def test_contradicting_samples_at_one_place_are_averaged(name):
    twice = Sites.at_vertices(np.concatenate([INDICES, INDICES[:1]]))
    found = BASELINES[name](BALL, twice, np.append(VALUES, VALUES[0] + 2.0))
    assert found[INDICES[0]] == pytest.approx(VALUES[0] + 1.0, abs=1e-4)


@pytest.mark.parametrize("name", ["nearest", "inverse_distance", "harmonic"])
@given(seed=st.integers(0, 10_000), count=st.integers(1, 30))
def test_the_map_keeps_within_the_range_of_samples_at_vertices(name, seed, count):
    rng = np.random.default_rng(seed)
    sites = Sites.at_vertices(rng.choice(BALL.mesh.n_vertices, count, replace=False))
    values = rng.normal(size=count)
    found = BASELINES[name](BALL, sites, values)
    slack = 1e-5 * np.ptp(values) + 1e-12
    assert found.min() >= values.min() - slack
    assert found.max() <= values.max() + slack


def test_nearest_is_the_value_of_the_sample_nearest_along_the_surface():
    distances = np.array([exact_geodesic_distances(BALL.mesh, i) for i in INDICES])
    found = BASELINES["nearest"](BALL, AT_VERTICES, VALUES)
    first, second = np.sort(distances, axis=0)[:2]
    clear = second - first > 0.02 * second
    assert np.array_equal(found[clear], VALUES[distances.argmin(axis=0)][clear])


def test_nearest_does_not_reach_through_a_thin_wall():
    flat = bare(ellipsoid(semi_axes=(30.0, 30.0, 2.0), subdivisions=4))
    top = int(flat.mesh.vertices[:, 2].argmax())
    rim = int(flat.mesh.vertices[:, 0].argmax())
    found = BASELINES["nearest"](flat, Sites.at_vertices([top, rim]), np.array([1.0, 0.0]))
    bottom = int(flat.mesh.vertices[:, 2].argmin())
    assert (found[top], found[bottom]) == (1.0, 0.0)


def test_sites_inside_triangles_know_their_distance():
    rng = np.random.default_rng(5)
    faces = BALL.mesh.faces[rng.choice(BALL.mesh.n_faces, 1)]
    site = Sites(faces, rng.dirichlet(np.ones(3), 1))
    distances, owners = nearest_sites(BALL, site)
    straight = np.linalg.norm(BALL.mesh.vertices - site.positions(BALL.mesh), axis=1)
    arcs = 60.0 * np.arcsin(np.minimum(straight / 60.0, 1.0))
    assert np.abs(distances - arcs)[arcs > 5.0].max() < 1.0
    assert (owners == 0).all()


def test_inverse_distances_are_weighted_by_their_squares():
    sheet = bare(rectangle(width=4.0, height=1.0, n_x=5, n_y=2))
    ends = Sites.at_vertices([0, 4])
    found = BASELINES["inverse_distance"](sheet, ends, np.array([0.0, 1.0]))
    weights = np.array([1.0, 3.0]) ** -2
    assert found[1] == pytest.approx(weights[1] / weights.sum())


def test_harmonic_interpolation_is_linear_along_a_strip():
    strip = bare(rectangle(width=10.0, height=2.0, n_x=11, n_y=3))
    x = strip.mesh.vertices[:, 0]
    ends = np.flatnonzero((x == x.min()) | (x == x.max()))
    found = BASELINES["harmonic"](strip, Sites.at_vertices(ends), x[ends])
    assert np.abs(found - x).max() < 1e-4


def test_harmonic_interpolation_meets_samples_inside_triangles():
    rng = np.random.default_rng(6)
    faces = BALL.mesh.faces[rng.choice(BALL.mesh.n_faces, 30, replace=False)]
    sites = Sites(faces, rng.dirichlet(np.ones(3), 30))
    values = rng.normal(size=30)
    found = BASELINES["harmonic"](BALL, sites, values)
    assert np.abs(sites.of(found) - values).max() < 1e-4


def test_a_thin_plate_continues_a_linear_map_everywhere():
    linear = BALL.mesh.vertices @ [1.0, -2.0, 0.5] + 3.0
    found = BASELINES["thin_plate"](BALL, AT_VERTICES, linear[INDICES])
    assert np.abs(found - linear).max() < 1e-6


@pytest.mark.parametrize("name", ["nearest", "inverse_distance", "harmonic", "linear_radial"])
def test_one_sample_colours_everything(name):
    found = BASELINES[name](BALL, Sites.at_vertices([7]), np.array([2.5]))
    assert np.allclose(found, 2.5)


def test_a_thin_plate_needs_four_places_not_in_a_plane():
    equator = np.flatnonzero(np.abs(BALL.mesh.vertices[:, 2]) < 1e-9)
    for indices in (INDICES[:3], equator):
        with pytest.raises(InputError, match="needs four"):
            BASELINES["thin_plate"](BALL, Sites.at_vertices(indices), np.ones(len(indices)))


def test_nearest_refuses_what_no_path_reaches():
    two = joined([BALL.mesh, Mesh(BALL.mesh.vertices + 100.0, BALL.mesh.faces)])
    with pytest.raises(SurfaceError, match="no path"):
        BASELINES["nearest"](bare(two), Sites.at_vertices([0]), np.array([1.0]))


@every_baseline
def test_samples_without_sense_are_refused(interpolate):
    with pytest.raises(InputError, match="no samples"):
        interpolate(BALL, Sites.at_vertices([]), np.empty(0))
    with pytest.raises(InputError, match="40 sites"):
        interpolate(BALL, AT_VERTICES, VALUES[:5])
    with pytest.raises(InputError, match="NaN"):
        interpolate(BALL, AT_VERTICES, np.where(np.arange(40) == 3, np.nan, VALUES))
    with pytest.raises(InputError, match="fill threshold"):
        interpolate(BALL, AT_VERTICES, VALUES, fill_threshold_mm=0.0)
