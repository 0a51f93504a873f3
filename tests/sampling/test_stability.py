import numpy as np
import pytest

from auricle.errors import BandError, InputError
from auricle.sampling.farthest_point import farthest_point_sampling
from auricle.sampling.random_design import random_sampling
from auricle.sampling.sites import Sites
from auricle.sampling.slepian import slepian_functions
from auricle.sampling.stability import judged, stability


def uniform_sites(chamber, count, rng) -> Sites:
    """Vertices drawn with replacement by their accessible area."""
    chances = chamber.accessible_areas / chamber.accessible_area
    return Sites.at_vertices(rng.choice(chamber.mesh.n_vertices, count, p=chances))


@pytest.fixture(params=["sphere_chamber", "open_chamber", "atrium_chamber"])
def any_chamber(request):
    return request.getfixturevalue(request.param)


def test_dense_uniform_sites_are_ideal_with_caps_and_without(any_chamber, rng):
    found = stability(any_chamber, uniform_sites(any_chamber, 8_000, rng), 36)
    assert 0.8 < found.constant < 1.0
    assert found.noise_gain == pytest.approx(1.0, abs=0.06)
    assert found.condition < 1.2
    assert 0.9 < found.weighted < 1.02
    assert found.verdict == "stable"


def test_every_accessible_vertex_with_its_area_makes_the_weighted_stability_one(any_chamber):
    sites = Sites.at_vertices(np.flatnonzero(any_chamber.accessible))
    assert stability(any_chamber, sites, 100).weighted == pytest.approx(1.0, abs=1e-6)


def test_caps_do_not_spoil_what_is_stable_without_them(sphere_chamber, open_chamber):
    """A sixth of the area is out of reach; without Slepian functions 0 would come out."""
    closed = stability(
        sphere_chamber, Sites.at_vertices(farthest_point_sampling(sphere_chamber, 162)), 81
    )
    sites = Sites.at_vertices(farthest_point_sampling(open_chamber, 162))
    opened = stability(open_chamber, sites, 81)
    assert opened.verdict == closed.verdict == "stable"
    raw = sites.of(open_chamber.basis.modes[:, :81]) * np.sqrt(open_chamber.accessible_area / 162)
    assert np.linalg.svd(raw, compute_uv=False)[-1] ** 2 < 0.05


def test_farthest_points_as_many_as_harmonics_on_an_icosphere_are_told_to_be_singular(
    sphere_chamber,
):
    sites = Sites.at_vertices(farthest_point_sampling(sphere_chamber, 100))
    found = stability(sphere_chamber, sites, 100)
    assert found.condition > 1e12
    assert found.verdict == "unstable"
    assert found.noise_gain > 1e12
    assert found.constant < 1e-24


def test_half_as_many_again_are_good_and_twice_as_many_stable(atrium_chamber):
    for n_modes in (50, 100):
        points = farthest_point_sampling(atrium_chamber, 2 * n_modes)
        more = stability(atrium_chamber, Sites.at_vertices(points[: 3 * n_modes // 2]), n_modes)
        twice = stability(atrium_chamber, Sites.at_vertices(points), n_modes)
        assert more.verdict != "unstable"
        assert twice.verdict == "stable"
        assert twice.noise_gain < 1.1


def test_random_sites_need_more_than_twice_the_harmonics(atrium_chamber, rng):
    sites = Sites.at_vertices(random_sampling(atrium_chamber, 200, rng=rng))
    assert stability(atrium_chamber, sites, 100).verdict != "stable"


def test_fewer_sites_than_harmonics_leave_the_map_undetermined(sphere_chamber):
    found = stability(sphere_chamber, Sites.at_vertices(np.arange(20)), 36)
    assert (found.constant, found.weighted, found.verdict) == (0.0, 0.0, "unstable")
    assert found.condition == found.noise_gain == np.inf


def test_the_noise_gain_is_that_of_the_least_squares_map(open_chamber, rng):
    n_modes, sites = 36, Sites.at_vertices(farthest_point_sampling(open_chamber, 80))
    found = stability(open_chamber, sites, n_modes)
    functions = slepian_functions(open_chamber, n_modes)
    modes = open_chamber.basis.modes[:, :n_modes] @ functions.transform
    rebuilt = modes @ np.linalg.lstsq(sites.of(modes), rng.normal(size=(80, 4000)), rcond=None)[0]
    mean_variance = open_chamber.mean((rebuilt**2).mean(axis=1))
    assert mean_variance * 80 / found.n_free == pytest.approx(found.noise_gain, rel=0.02)


def test_the_order_of_sites_and_the_unit_of_length_do_not_matter(atrium_chamber, rng):
    points = farthest_point_sampling(atrium_chamber, 80)
    one = stability(atrium_chamber, Sites.at_vertices(points), 50)
    other = stability(atrium_chamber, Sites.at_vertices(rng.permutation(points)), 50)
    assert other.constant == pytest.approx(one.constant, rel=1e-9)
    assert other.noise_gain == pytest.approx(one.noise_gain, rel=1e-9)
    assert other.weighted == pytest.approx(one.weighted, rel=1e-9)


def test_shares_that_are_not_one_a_site_and_too_many_harmonics_are_refused(sphere_chamber):
    sites = Sites.at_vertices([0, 1])
    with pytest.raises(InputError, match="shares"):
        judged(sphere_chamber, sites, 1, np.ones(3))
    with pytest.raises(BandError, match="harmonics"):
        stability(sphere_chamber, sites, 1000)
    with pytest.raises(InputError, match="no site"):
        stability(sphere_chamber, Sites.at_vertices([]), 1)
