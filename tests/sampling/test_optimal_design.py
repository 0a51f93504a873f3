import numpy as np
import pytest

from auricle.errors import InputError
from auricle.sampling.optimal_design import Prior, a_optimal_sampling, d_optimal_sampling
from auricle.sampling.sites import Sites


def prior_of(chamber, n_modes=60, noise=0.05):
    variances = (1 + 15.0**2 * chamber.basis.eigenvalues[:n_modes]) ** -2.5
    return Prior(variances * chamber.basis.area / variances.sum(), noise)


def posterior(chamber, prior, points):
    rows = chamber.basis.modes[points, : len(prior.variances)]
    precision = np.diag(1 / prior.variances) + rows.T @ rows / prior.noise**2
    return np.linalg.inv(precision)


def integrated_variance(chamber, prior, points):
    modes = chamber.basis.modes[:, : len(prior.variances)]
    covariance = posterior(chamber, prior, points)
    return chamber.accessible_areas @ np.einsum("nk,nk->n", modes @ covariance, modes)


@pytest.mark.parametrize("fixture", ["open_chamber", "atrium_chamber"])
def test_each_a_optimal_point_lowers_the_integrated_variance_most(request, fixture):
    chamber = request.getfixturevalue(fixture)
    prior = prior_of(chamber)
    points = a_optimal_sampling(chamber, 25, prior=prior)
    others = np.setdiff1d(np.flatnonzero(chamber.accessible)[::23], points)
    for i in (0, 7, 24):
        chosen = integrated_variance(chamber, prior, points[: i + 1])
        beaten = [integrated_variance(chamber, prior, [*points[:i], other]) for other in others]
        assert chosen <= min(beaten) * (1 + 1e-10)


def test_each_d_optimal_point_lowers_the_determinant_most(atrium_chamber):
    prior = prior_of(atrium_chamber)
    points = d_optimal_sampling(atrium_chamber, 25, prior=prior)
    others = np.setdiff1d(np.arange(0, atrium_chamber.mesh.n_vertices, 53), points)
    for i in (3, 24):

        def log_determinant(point, before=points[:i]):
            return np.linalg.slogdet(posterior(atrium_chamber, prior, [*before, point]))[1]

        beaten = [log_determinant(other) for other in others]
        assert log_determinant(points[i]) <= min(beaten) + 1e-9


@pytest.mark.parametrize("rule", [a_optimal_sampling, d_optimal_sampling])
def test_designs_are_nested_continue_what_exists_and_keep_to_their_region(open_chamber, rule):
    prior = prior_of(open_chamber)
    allowed = open_chamber.mesh.vertices[:, 0] > -10
    points = rule(open_chamber, 30, prior=prior, allowed=allowed)
    np.testing.assert_array_equal(rule(open_chamber, 12, prior=prior, allowed=allowed), points[:12])
    existing = Sites.at_vertices(points[:12])
    rest = rule(open_chamber, 18, prior=prior, allowed=allowed, existing=existing)
    np.testing.assert_array_equal(rest, points[12:])
    assert (allowed & open_chamber.accessible)[points].all()
    assert len(np.unique(points)) == 30


def test_many_rank_one_updates_drift_no_farther_than_rounding(sphere_chamber):
    prior = prior_of(sphere_chamber, 100, noise=0.01)
    points = a_optimal_sampling(sphere_chamber, 300, prior=prior)
    existing = Sites.at_vertices(points[:299])
    (last,) = a_optimal_sampling(sphere_chamber, 1, prior=prior, existing=existing)
    found = integrated_variance(sphere_chamber, prior, points)
    fresh = integrated_variance(sphere_chamber, prior, [*points[:299], last])
    assert found == pytest.approx(fresh, rel=1e-10)


def test_variances_of_zero_are_allowed_and_none_at_all_are_not(sphere_chamber):
    variances = np.ones(36)
    variances[10:] = 0.0
    some = a_optimal_sampling(sphere_chamber, 8, prior=Prior(variances, 0.1))
    few = a_optimal_sampling(sphere_chamber, 8, prior=Prior(variances[:10], 0.1))
    np.testing.assert_array_equal(some, few)
    rest = a_optimal_sampling(
        sphere_chamber, 4, prior=Prior(variances, 0.1), existing=Sites.at_vertices(some[:4])
    )
    np.testing.assert_array_equal(rest, some[4:])
    for wrong, noise in ((np.zeros(4), 1.0), (-np.ones(4), 1.0), (np.ones(4), 0.0)):
        with pytest.raises(InputError, match=r"prior|noise"):
            Prior(wrong, noise)
    with pytest.raises(InputError, match="harmonics"):
        a_optimal_sampling(sphere_chamber, 4, prior=Prior(np.ones(999), 1.0))
