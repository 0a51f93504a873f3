from dataclasses import replace

import numpy as np
import pytest

from auricle.errors import InputError
from auricle.sampling.error_bound import certified_error_bound, planned_error_bound
from auricle.sampling.farthest_point import farthest_point_sampling
from auricle.sampling.least_squares import fitted, least_squares
from auricle.sampling.random_design import random_sampling
from auricle.sampling.sites import Sites
from auricle.sampling.slepian import slepian_functions, tail
from auricle.sampling.stability import stability
from auricle.sampling.voronoi import voronoi


def random_sites(chamber, rng, count):
    """Places of every kind, and what they say of some bandwidth."""
    for i in range(count):
        n_modes = int(rng.integers(2, 50))
        n_sites = int(rng.integers(n_modes + 3, 4 * n_modes + 20))
        start = int(rng.choice(np.flatnonzero(chamber.accessible)))
        points = (
            random_sampling(chamber, n_sites, rng=rng)
            if i % 2
            else farthest_point_sampling(chamber, n_sites, start=start)
        )
        sites = Sites.at_vertices(points)
        yield sites, stability(chamber, sites, n_modes)


def random_samples(chamber, sites, rng, count):
    """Maps with a tail of every size, and the errors of their samples."""
    for _ in range(count):
        decay = np.arange(1, chamber.basis.n_modes + 1) ** -rng.uniform(0.0, 2.0)
        truth = chamber.basis.inverse(decay * rng.normal(size=len(decay)))
        errors = rng.choice([0.0, 0.05, 0.5]) * truth.std() * rng.normal(size=len(sites))
        yield truth, errors


@pytest.mark.parametrize("fixture", ["sphere_chamber", "open_chamber"])
def test_no_error_exceeds_its_bound_in_five_hundred_trials(request, fixture, rng):
    chamber = request.getfixturevalue(fixture)
    tightness, without_tail = [], []
    for sites, judged in random_sites(chamber, rng, 25):
        for truth, errors in random_samples(chamber, sites, rng, 20):
            rebuilt = fitted(chamber, sites, sites.of(truth) + errors, judged)
            bound = certified_error_bound(chamber, sites, judged, truth=truth, errors=errors)
            error = chamber.nrmse(rebuilt.values, truth)
            tightness.append(bound.nrmse / error)
            forgetful = np.hypot(bound.tail, bound.noise_at_sites / bound.weighted_stability)
            without_tail.append(error > forgetful)
    assert len(tightness) == 500
    assert min(tightness) >= 1 - 1e-9
    assert min(tightness) < 1.2  # close somewhere, so that a smaller bound would be exceeded
    assert np.mean(without_tail) > 0.2  # as one is that forgets the tail at the samples


def test_the_worst_errors_of_the_samples_reach_the_bound(atrium_chamber):
    """Errors along the least singular vector come back as large as the bound allows."""
    sites, n_modes = Sites.at_vertices(farthest_point_sampling(atrium_chamber, 60)), 36
    truth = atrium_chamber.basis.inverse(np.arange(1.0, 37.0))
    roots = np.sqrt(voronoi(atrium_chamber, sites).shares)
    design = sites.of(atrium_chamber.basis.modes[:, :n_modes]) * roots[:, None]
    worst = np.linalg.svd(design)[0][:, n_modes - 1] / roots
    rebuilt = least_squares(atrium_chamber, sites, sites.of(truth) + worst, n_modes=n_modes)
    bound = certified_error_bound(
        atrium_chamber, sites, rebuilt.certificate, truth=truth, errors=worst
    )
    assert atrium_chamber.nrmse(rebuilt.values, truth) == pytest.approx(bound.nrmse, rel=1e-9)
    assert bound.certified


def test_the_planned_bound_is_the_certified_one_with_its_assumptions_met(atrium_chamber, rng):
    sites = Sites.at_vertices(farthest_point_sampling(atrium_chamber, 100))
    judged = stability(atrium_chamber, sites, 49)
    truth = atrium_chamber.basis.inverse(rng.normal(size=150))
    errors = 0.1 * truth.std() * rng.normal(size=100)
    certified = certified_error_bound(atrium_chamber, sites, judged, truth=truth, errors=errors)
    planned = planned_error_bound(
        judged,
        tail=max(certified.tail, certified.tail_at_sites),
        noise=certified.noise_at_sites,
    )
    assert planned.nrmse >= certified.nrmse
    assert planned.nrmse == pytest.approx(certified.nrmse, rel=0.2)
    assert not planned.certified
    assert "if what lies beyond the band" in planned.statement
    assert certified.statement.endswith("certified")


def test_the_tail_is_what_the_band_does_not_hold(sphere_chamber, rng):
    truth = sphere_chamber.basis.inverse(rng.normal(size=144))
    power = sphere_chamber.basis.power_spectrum(truth)
    beyond = tail(sphere_chamber, slepian_functions(sphere_chamber, 49), truth)
    share = 1 - power.cumulative()[48]
    assert sphere_chamber.nrmse(truth - beyond, truth) == pytest.approx(np.sqrt(share), rel=1e-9)


def test_without_tail_and_noise_nothing_is_lost_and_undetermined_maps_have_no_bound(
    sphere_chamber,
):
    sites = Sites.at_vertices(farthest_point_sampling(sphere_chamber, 60))
    judged = stability(sphere_chamber, sites, 25)
    assert planned_error_bound(judged, tail=0.0, noise=0.0).nrmse == 0.0
    undetermined = replace(judged, weighted=0.0)
    assert planned_error_bound(undetermined, tail=0.0, noise=0.0).nrmse == np.inf


def test_what_has_no_bound_is_refused(open_chamber):
    sites = Sites.at_vertices(farthest_point_sampling(open_chamber, 30))
    judged = stability(open_chamber, sites, 9)
    truth, errors = open_chamber.mesh.vertices[:, 0], np.zeros(30)
    with pytest.raises(InputError, match="negative"):
        planned_error_bound(judged, tail=-0.1, noise=0.0)
    with pytest.raises(InputError, match="constant"):
        certified_error_bound(open_chamber, sites, judged, truth=np.zeros(642), errors=errors)
    with pytest.raises(InputError, match="one a site"):
        certified_error_bound(open_chamber, sites, judged, truth=truth, errors=errors[1:])
    hidden = np.flatnonzero(~open_chamber.accessible)[:30]
    with pytest.raises(InputError, match="cap"):
        certified_error_bound(
            open_chamber,
            Sites.at_vertices(hidden),
            judged,
            truth=truth,
            errors=errors[: len(hidden)],
        )
