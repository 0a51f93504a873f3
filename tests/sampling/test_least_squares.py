import numpy as np
import pytest

from auricle.errors import InputError
from auricle.sampling.farthest_point import farthest_point_sampling
from auricle.sampling.least_squares import least_squares, leave_one_out_modes
from auricle.sampling.pivoted_qr import pivoted_qr_sampling
from auricle.sampling.random_design import random_sampling
from auricle.sampling.sites import Sites
from auricle.sampling.slepian import slepian_functions
from auricle.sampling.voronoi import voronoi


def band_limited(chamber, n_modes, rng):
    return chamber.basis.inverse(rng.normal(size=n_modes))


@pytest.mark.parametrize("degree", [3, 6, 11])
def test_pivots_as_many_as_harmonics_give_a_map_on_the_sphere_back(sphere_chamber, degree, rng):
    n_modes = (degree + 1) ** 2
    truth = band_limited(sphere_chamber, n_modes, rng)
    sites = Sites.at_vertices(pivoted_qr_sampling(sphere_chamber, n_modes, n_modes=n_modes))
    rebuilt = least_squares(
        sphere_chamber, sites, sites.of(truth), n_modes=n_modes, allow_unstable=True
    )
    assert sphere_chamber.nrmse(rebuilt.values, truth) < 1e-12


def test_three_times_as_many_random_points_do_as_well(sphere_chamber, rng):
    truth = band_limited(sphere_chamber, 49, rng)
    sites = Sites.at_vertices(random_sampling(sphere_chamber, 147, rng=rng))
    rebuilt = least_squares(sphere_chamber, sites, sites.of(truth), n_modes=49)
    assert sphere_chamber.nrmse(rebuilt.values, truth) < 1e-12


@pytest.mark.parametrize("fixture", ["sphere_chamber", "open_chamber", "atrium_chamber"])
def test_half_as_many_again_farthest_points_do_as_well(request, fixture, rng):
    chamber = request.getfixturevalue(fixture)
    truth = band_limited(chamber, 25, rng)
    sites = Sites.at_vertices(farthest_point_sampling(chamber, 38))
    rebuilt = least_squares(chamber, sites, sites.of(truth), n_modes=25)
    assert chamber.nrmse(rebuilt.values, truth) < 1e-12
    assert rebuilt.certificate.n_free == 25


def test_samples_between_vertices_give_the_map_back_too(sphere_chamber, rng):
    truth = band_limited(sphere_chamber, 36, rng)
    faces = rng.choice(sphere_chamber.mesh.n_faces, 200, replace=False)
    sites = Sites(sphere_chamber.mesh.faces[faces], rng.dirichlet([1.0, 1.0, 1.0], 200))
    rebuilt = least_squares(sphere_chamber, sites, sites.of(truth), n_modes=36)
    assert sphere_chamber.nrmse(rebuilt.values, truth) < 1e-12


def test_farthest_points_as_many_as_harmonics_on_the_icosphere_are_refused(sphere_chamber):
    sites = Sites.at_vertices(farthest_point_sampling(sphere_chamber, 49))
    with pytest.raises(InputError, match="stability"):
        least_squares(sphere_chamber, sites, np.ones(49), n_modes=49)
    forced = least_squares(sphere_chamber, sites, np.ones(49), n_modes=49, allow_unstable=True)
    assert forced.certificate.verdict == "unstable"
    assert np.isfinite(forced.values).all()


def test_all_samples_in_one_place_are_refused(sphere_chamber):
    sites = Sites.at_vertices(np.full(60, 17))
    with pytest.raises(InputError, match="stability"):
        least_squares(sphere_chamber, sites, np.ones(60), n_modes=9)


@pytest.mark.parametrize("allow_unstable", [False, True])
def test_fewer_samples_than_harmonics_are_refused_whatever_is_allowed(
    sphere_chamber, allow_unstable
):
    sites = Sites.at_vertices(farthest_point_sampling(sphere_chamber, 24))
    with pytest.raises(InputError, match="24 samples for 25 degrees of freedom"):
        least_squares(sphere_chamber, sites, np.ones(24), n_modes=25, allow_unstable=allow_unstable)


def test_samples_that_are_no_numbers_or_too_few_are_refused(sphere_chamber):
    sites = Sites.at_vertices([0, 1, 2, 3])
    with pytest.raises(InputError, match="NaN"):
        least_squares(sphere_chamber, sites, np.array([1.0, np.nan, 0.0, 2.0]), n_modes=1)
    with pytest.raises(InputError, match="one a site"):
        least_squares(sphere_chamber, sites, np.ones(3), n_modes=1)


def test_a_constant_stays_one_and_a_repeated_sample_counts_as_one_place(atrium_chamber):
    points = farthest_point_sampling(atrium_chamber, 40)
    sites = Sites.at_vertices([*points, points[0]])
    rebuilt = least_squares(atrium_chamber, sites, np.full(41, 7.0), n_modes=16)
    np.testing.assert_allclose(rebuilt.values, 7.0, rtol=1e-10)
    single = np.arange(40.0)
    once = least_squares(atrium_chamber, sites[np.arange(40)], single, n_modes=16)
    twice = least_squares(atrium_chamber, sites, np.append(single, 0.0), n_modes=16)
    np.testing.assert_allclose(twice.values, once.values, atol=1e-9)


@pytest.mark.parametrize("fixture", ["open_chamber", "atrium_chamber"])
def test_what_is_left_out_is_predicted_as_by_a_weighted_refit_without_it(request, fixture, rng):
    chamber = request.getfixturevalue(fixture)
    sites = Sites.at_vertices(farthest_point_sampling(chamber, 50))
    values = rng.normal(size=50)
    fitted = least_squares(chamber, sites, values, n_modes=25)
    functions = slepian_functions(chamber, 25)
    design = sites.of(chamber.basis.modes[:, :25]) @ functions.transform
    roots = np.sqrt(voronoi(chamber, sites).shares)
    for i in (0, 13, 49):
        rest = np.arange(50) != i
        refit = np.linalg.lstsq(
            roots[rest, None] * design[rest], roots[rest] * values[rest], rcond=None
        )[0]
        assert fitted.leave_one_out[i] == pytest.approx(values[i] - design[i] @ refit, rel=1e-8)


def test_leaving_one_out_finds_the_bandwidth_among_stable_ones(atrium_chamber, rng):
    truth = band_limited(atrium_chamber, 25, rng)
    sites = Sites.at_vertices(farthest_point_sampling(atrium_chamber, 100))
    noise = 0.05 * truth.std() * rng.normal(size=100)
    chosen = leave_one_out_modes(
        atrium_chamber, sites, sites.of(truth) + noise, [4, 9, 25, 49, 64, 100, 150]
    )
    assert chosen == 25
    with pytest.raises(InputError, match="stably"):
        leave_one_out_modes(atrium_chamber, sites, sites.of(truth), [100, 150])
