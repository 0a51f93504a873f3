import numpy as np
import pytest

from auricle.errors import InputError
from auricle.sampling.farthest_point import farthest_point_sampling
from auricle.sampling.local_nyquist import (
    bands,
    leverage_nyquist,
    local_nyquist,
    modal_transfer,
)
from auricle.sampling.optimal_design import Prior
from auricle.sampling.random_design import random_sampling
from auricle.sampling.sites import Sites


def prior_of(chamber, n_modes, noise=0.05):
    variances = (1 + 15.0**2 * chamber.basis.eigenvalues[:n_modes]) ** -2.5
    return Prior(variances * chamber.basis.area / variances.sum(), noise)


def reconstructor(chamber, sites, prior, relative_noise):
    """W as it is written."""
    modes = chamber.basis.modes[:, : len(prior.variances)]
    at_sites = sites.of(modes)
    system = at_sites * prior.variances @ at_sites.T + prior.noise**2 * np.diag(relative_noise)
    return modes * prior.variances @ at_sites.T @ np.linalg.inv(system)


@pytest.mark.parametrize("n_sites", [20, 90])
def test_band_errors_are_those_of_the_reconstructor_as_it_is_written(open_chamber, rng, n_sites):
    """By the smaller of two systems: for fewer sites than harmonics, and for more."""
    prior, sites = (
        prior_of(open_chamber, 64),
        Sites.at_vertices(random_sampling(open_chamber, n_sites, rng=rng)),
    )
    relative = rng.uniform(0.5, 2.0, n_sites)
    weights = reconstructor(open_chamber, sites, prior, relative)
    modes = open_chamber.basis.modes[:, :64]
    missed = modes - weights @ sites.of(modes)
    transfer = modal_transfer(open_chamber, sites, prior, relative_noise=relative)
    found = local_nyquist(open_chamber, transfer)
    seen = open_chamber.accessible
    for i, (low, high) in enumerate(zip(found.edges[:-1], found.edges[1:], strict=True)):
        band = slice(low, high)
        expected = np.sqrt((missed[:, band] ** 2).sum(axis=1) / (modes[:, band] ** 2).sum(axis=1))
        np.testing.assert_allclose(found.band_errors[seen, i], expected[seen], rtol=1e-7)
    assert np.isnan(found.band_errors[~seen]).all()
    back = modes.T @ (open_chamber.basis.areas[:, None] * (weights @ sites.of(modes)))
    np.testing.assert_allclose(transfer.matrix, back, atol=1e-10)


def test_dense_sites_support_every_band_everywhere(atrium_chamber):
    sites = Sites.at_vertices(farthest_point_sampling(atrium_chamber, 700))
    transfer = modal_transfer(atrium_chamber, sites, prior_of(atrium_chamber, 150, noise=1e-3))
    found = local_nyquist(atrium_chamber, transfer)
    assert (found.n_supported == 150).all()
    assert not found.undersampled(150).any()
    assert transfer.gains.min() > 0.99
    assert transfer.degrees_of_freedom == pytest.approx(150, rel=0.01)
    assert transfer.aliasing(100).max() < 0.05
    area = atrium_chamber.basis.area
    np.testing.assert_allclose(found.wavelengths, np.sqrt(np.pi * area / 150))


def test_one_site_supports_nothing_fine_and_nothing_at_all_far_away(atrium_chamber):
    sites = Sites.at_vertices([77])
    prior = prior_of(atrium_chamber, 150)
    transfer = modal_transfer(atrium_chamber, sites, prior)
    found = local_nyquist(atrium_chamber, transfer)
    distances = atrium_chamber.marching.from_source([77])
    assert found.n_supported[distances > 15.0].max() <= 8
    away = distances > 60.0
    assert away.sum() > 500
    assert (found.n_supported[away] == 0).all()
    assert np.isinf(found.wavelengths[away]).all()
    assert found.undersampled(4)[away].all()
    assert transfer.degrees_of_freedom < 1.0
    assert (transfer.gains < 0.5).all()


def test_wavelengths_grow_with_the_distance_from_the_samples(atrium_chamber):
    right = atrium_chamber.mesh.vertices[:, 0] > 0
    points = farthest_point_sampling(atrium_chamber, 100, allowed=right)
    transfer = modal_transfer(
        atrium_chamber, Sites.at_vertices(points), prior_of(atrium_chamber, 150)
    )
    found = local_nyquist(atrium_chamber, transfer)
    far = atrium_chamber.mesh.vertices[:, 0] < -15
    assert np.median(found.n_supported[right]) > 4 * np.median(found.n_supported[far])
    assert found.undersampled(64)[far].all()
    assert not found.undersampled(1).any()


def test_gains_and_aliasing_are_a_projections_where_the_prior_is_flat(sphere_chamber):
    """Without noise to speak of, what is in the band comes back whole if sites determine it."""
    variances = np.full(49, 1.0)
    sites = Sites.at_vertices(farthest_point_sampling(sphere_chamber, 150))
    transfer = modal_transfer(sphere_chamber, sites, Prior(variances, 1e-6))
    np.testing.assert_allclose(transfer.matrix, np.eye(49), atol=1e-7)
    assert transfer.aliasing(25).shape == (24,)


def test_the_leverage_rule_claims_little_that_the_exact_definition_does_not(atrium_chamber, rng):
    sites = Sites.at_vertices(random_sampling(atrium_chamber, 80, rng=rng))
    transfer = modal_transfer(atrium_chamber, sites, prior_of(atrium_chamber, 150))
    exact = local_nyquist(atrium_chamber, transfer)
    rule = leverage_nyquist(atrium_chamber, sites, 150)
    np.testing.assert_array_equal(rule.edges, exact.edges)
    for edge in (16, 32, 64):
        claimed, true = rule.n_supported >= edge, exact.n_supported >= edge
        assert true[claimed].mean() > 0.85
        assert claimed[true].mean() > 0.3
    assert leverage_nyquist(atrium_chamber, Sites.at_vertices([3]), 150).n_supported[2000] == 0


@pytest.mark.parametrize("n_modes", [2, 3, 4, 5, 33, 150, 500])
def test_bands_follow_on_one_another_from_the_first_harmonic_to_the_last(n_modes):
    edges = bands(n_modes)
    assert edges[0] == 1
    assert edges[-1] == n_modes
    assert (np.diff(edges) > 0).all()


def test_what_cannot_be_judged_is_refused(sphere_chamber):
    sites, prior = Sites.at_vertices([0, 1]), prior_of(sphere_chamber, 16)
    with pytest.raises(InputError, match="at least 2"):
        bands(1)
    with pytest.raises(InputError, match="at least one site"):
        modal_transfer(sphere_chamber, Sites.at_vertices([]), prior)
    with pytest.raises(InputError, match="harmonics"):
        modal_transfer(sphere_chamber, sites, Prior(np.ones(999), 1.0))
    with pytest.raises(InputError, match="relative_noise"):
        modal_transfer(sphere_chamber, sites, prior, relative_noise=np.array([1.0, 0.0]))
    judged = local_nyquist(sphere_chamber, modal_transfer(sphere_chamber, sites, prior))
    with pytest.raises(InputError, match="judged"):
        judged.undersampled(17)
