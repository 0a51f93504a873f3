"""Splines over place and wall: the kriging they are, smoothed as is probable, and no leak."""

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from auricle.arrays import Floats
from auricle.sampling.baselines import BASELINES
from auricle.sampling.chamber import Chamber, chamber
from auricle.sampling.gaussian_process import GaussianProcess
from auricle.sampling.noise_shape import relative_noise
from auricle.sampling.sites import Sites
from auricle.sampling.splines import WALL_SHARE, Spline, wall_places
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere

POWERS = (1.0, 1.8)


def scattered(chamber: Chamber, count: int, seed: int = 3) -> Sites:
    rng = np.random.default_rng(seed)
    faces = chamber.mesh.faces[rng.choice(chamber.mesh.n_faces, count, replace=False)]
    return Sites(faces, rng.dirichlet([1, 1, 1], count))


def smooth(chamber: Chamber) -> Floats:
    x, y, z = chamber.mesh.vertices.T / 30
    return np.column_stack([np.sin(3 * x) + y * z, np.cos(2 * y)])


@pytest.mark.parametrize("power", POWERS)
def test_the_map_is_that_of_the_kriging_equations(sphere_chamber: Chamber, power: float) -> None:
    sites, values = scattered(sphere_chamber, 40), smooth(sphere_chamber)[:40]
    shape = relative_noise(np.linspace(1.0, 3.0, 40), 40)
    places = wall_places(sphere_chamber)
    here = sites.of(places)
    free = np.ones((40, 1))
    smoothing = 0.02
    covariance = -(cdist(here, here) ** power) + smoothing * np.diag(shape**2)
    system = np.block([[covariance, free], [free.T, np.zeros((1, 1))]])
    right = np.vstack([values, np.zeros((1, 2))])
    across = np.hstack([-(cdist(places, here) ** power), np.ones((len(places), 1))])
    expected = across @ np.linalg.solve(system, right)
    found = Spline(sphere_chamber, sites, power, shape).mean(values, smoothing)
    np.testing.assert_allclose(found, expected, atol=1e-9)


@pytest.mark.parametrize("power", POWERS)
def test_left_out_is_what_a_refit_without_the_sample_misses(
    sphere_chamber: Chamber, power: float
) -> None:
    sites, shape = Sites.at_vertices(np.arange(0, 630, 21)), np.ones(30)
    values = sites.of(smooth(sphere_chamber))
    found = Spline(sphere_chamber, sites, power, shape).left_out(values, 0.01)
    for out in (0, 7, 29):
        kept = np.delete(np.arange(30), out)
        refit = Spline(sphere_chamber, sites[kept], power, np.ones(29)).mean(values[kept], 0.01)
        missed = values[out] - sites[[out]].of(refit)[0]
        assert found[out] == pytest.approx(missed, abs=1e-8)


def test_without_noise_samples_are_met_and_the_smoother_spline_keeps_a_slope(
    fine_chamber: Chamber,
) -> None:
    chosen = np.arange(0, 2_562, 60)
    slope = fine_chamber.mesh.vertices @ [[0.3], [-0.1], [0.2]]
    sites, alike = Sites.at_vertices(chosen), np.ones(len(chosen))
    errors = []
    for power in POWERS:
        found = Spline(fine_chamber, sites, power, alike).mean(slope[chosen], 1e-9)
        np.testing.assert_allclose(found[chosen], slope[chosen], atol=1e-6)
        errors.append(fine_chamber.nrmse(found[:, 0], slope[:, 0]))
    assert errors[1] < 0.3 * errors[0] < 0.05


@pytest.mark.parametrize("power", POWERS)
def test_the_smoothing_is_the_most_probable_one(sphere_chamber: Chamber, power: float) -> None:
    """Against the restricted likelihood of contrasts, by plain determinants."""
    sites, noise = scattered(sphere_chamber, 60), 0.2
    rng = np.random.default_rng(2)
    values = sites.of(smooth(sphere_chamber))[:, :1] + noise * rng.standard_normal((60, 1))
    spline = Spline(sphere_chamber, sites, power, np.ones(60))
    here = sites.of(wall_places(sphere_chamber))
    beside = np.linalg.svd(np.ones((1, 60)))[2][1:]
    covariance, seen = beside @ -(cdist(here, here) ** power) @ beside.T, beside @ values[:, 0]
    guess = values.var(ddof=1) / np.trace(covariance) * len(covariance)

    def misfit(smoothing: float) -> float:
        among = noise**2 * (covariance / smoothing + np.eye(len(covariance)))
        scale = noise**2 / smoothing
        likelihood = np.linalg.slogdet(among)[1] + seen @ np.linalg.solve(among, seen)
        return float(likelihood + guess / scale + np.log(scale))

    best = spline.smoothing(values, noise)
    assert misfit(best) < min(misfit(1.01 * best), misfit(best / 1.01))


def test_the_smoothing_follows_noise_over_the_map_and_not_the_unit(
    sphere_chamber: Chamber,
) -> None:
    sites = scattered(sphere_chamber, 80)
    spline = Spline(sphere_chamber, sites, 1.0, np.ones(80))
    values = sites.of(smooth(sphere_chamber))
    assert spline.smoothing(7 * values, 0.7) == pytest.approx(spline.smoothing(values, 0.1))
    assert spline.smoothing(values, 0.3) > 4 * spline.smoothing(values, 0.1)


def test_walls_back_to_back_are_apart_and_a_peak_does_not_leak_through() -> None:
    ball = icosphere(radius=30.0, subdivisions=4)
    flat = chamber(Mesh(ball.vertices * [1.0, 1.0, 0.1], ball.faces), 100)
    vertices = flat.mesh.vertices
    upper, middle = vertices[:, 2] > 0, np.hypot(vertices[:, 0], vertices[:, 1]) < 8
    places = wall_places(flat)
    top, bottom = vertices[:, 2].argmax(), vertices[:, 2].argmin()
    apart = np.linalg.norm(places[top, 3:] - places[bottom, 3:])
    assert apart == pytest.approx(2 * WALL_SHARE, rel=0.02)
    peak = np.where(upper, np.exp(-(vertices[:, 0] ** 2 + vertices[:, 1] ** 2) / 128), 0)
    chosen = np.random.default_rng(1).choice(flat.mesh.n_vertices, 250, replace=False)
    sites = Sites.at_vertices(chosen)
    alone = [
        Spline(flat, sites, power, np.ones(250)).mean(peak[chosen, None], 1e-6)[:, 0]
        for power in POWERS
    ]
    mixed = GaussianProcess(flat, sites).fit(peak[chosen]).mean
    leaked = [
        np.abs(rebuilt[middle & ~upper]).max()
        for rebuilt in (BASELINES["linear_radial"](flat, sites, peak[chosen]), *alone, mixed)
    ]
    assert leaked[0] > 0.15
    assert leaked[1] < 0.75 * leaked[0]
    assert leaked[2] < 0.45 * leaked[0]
    assert leaked[3] < 0.22 * leaked[0]


@pytest.mark.parametrize("power", POWERS)
def test_the_precision_is_that_of_the_values_beside_their_mean(
    sphere_chamber: Chamber, power: float
) -> None:
    """By the inverse of the whole system of kriging, whose upper left block it is."""
    sites, shape = scattered(sphere_chamber, 30), relative_noise(np.linspace(1.0, 2.0, 30), 30)
    here = sites.of(wall_places(sphere_chamber))
    covariance = -(cdist(here, here) ** power) + 0.05 * np.diag(shape**2)
    free = np.ones((30, 1))
    system = np.block([[covariance, free], [free.T, np.zeros((1, 1))]])
    found = Spline(sphere_chamber, sites, power, shape).precision(0.05)
    np.testing.assert_allclose(found, np.linalg.inv(system)[:30, :30], rtol=1e-7, atol=1e-8)


@pytest.mark.parametrize("power", POWERS)
def test_samples_in_a_plane_or_in_one_place_give_a_finite_map(
    sphere_chamber: Chamber, power: float
) -> None:
    level = np.flatnonzero(np.abs(sphere_chamber.mesh.vertices[:, 2]) < 1e-6)[:12]
    for chosen in (level, np.full(12, 5), np.array([1, 9])):
        values = np.linspace(0.0, 1.0, len(chosen))[:, None]
        spline = Spline(sphere_chamber, Sites.at_vertices(chosen), power, np.ones(len(chosen)))
        smoothing = spline.smoothing(values, 0.1)
        assert np.abs(spline.mean(values, smoothing)).max() < 3
        assert np.isfinite(spline.left_out(values, smoothing)).all()
