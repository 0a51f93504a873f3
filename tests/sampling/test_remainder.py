"""What a prior holds beyond the harmonics: no variance lost, and conditioned on as it should be."""

from dataclasses import replace

import numpy as np
import pytest

from auricle.arrays import Floats
from auricle.errors import InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.gaussian_process import GaussianProcess
from auricle.sampling.matern import matern_correlation, matern_variances, split_prior
from auricle.sampling.reconstruction import Hyperparameters, Reconstruction
from auricle.sampling.remainder import Remainder, Term
from auricle.sampling.sites import Sites

TERMS = (Term(12.0, 0.5, 0.6), Term(20.0, 1.5, 0.4))
KNOWN = Hyperparameters(12.0, 5.0, 0.5, 0.5, TERMS)


def scattered(chamber: Chamber, count: int) -> Sites:
    rng = np.random.default_rng(3)
    faces = chamber.mesh.faces[rng.choice(chamber.mesh.n_faces, count, replace=False)]
    return Sites(faces, rng.dirichlet([1, 1, 1], count))


def activation(chamber: Chamber) -> Floats:
    return np.linalg.norm(chamber.mesh.vertices - chamber.mesh.vertices[5], axis=1)


def rebuilt(chamber: Chamber, sites: Sites, n_modes: int = 100) -> Reconstruction:
    process = GaussianProcess(chamber, sites, n_modes=n_modes)
    return process.given(sites.of(activation(chamber)), KNOWN)


@pytest.mark.parametrize("smoothness", [0.5, 1.0, 1.5, 2.5])
def test_fewer_harmonics_leave_the_share_that_the_others_held(
    atrium_chamber: Chamber, smoothness: float
) -> None:
    """Prior variance beyond 50 harmonics, by Weyl's law, against the sum over those up to 150."""
    basis = atrium_chamber.basis
    few = split_prior(basis, 50, length=15.0, smoothness=smoothness)
    more = split_prior(basis, 150, length=15.0, smoothness=smoothness)
    expected = more.variances[50:].sum() / basis.area + more.remainder
    assert few.remainder == pytest.approx(expected, rel=0.08)
    assert few.variances.sum() / basis.area + few.remainder == pytest.approx(1.0, rel=1e-12)


def test_within_the_harmonics_the_prior_has_the_shape_of_the_whole(fine_chamber: Chamber) -> None:
    """Where the mesh resolves them: beyond, its eigenvalues are too small and Weyl's are taken."""
    basis = fine_chamber.basis
    split = split_prior(basis, 256, length=15.0, smoothness=1.0)
    whole = matern_variances(basis, length=15.0, smoothness=1.0)
    ratios = split.variances[1:] / whole[1:]
    assert ratios[:80] == pytest.approx(ratios[0], rel=1e-12)
    degrees = np.arange(10, 15)
    exact = (degrees * (degrees + 1) / 30.0**2 + 2 / 15.0**2) ** -2.0
    assert split.variances[degrees**2 + degrees] / split.variances[1] == pytest.approx(
        exact / (2 / 30.0**2 + 2 / 15.0**2) ** -2.0, rel=0.03
    )


def test_harmonics_of_one_frequency_are_as_likely_as_one_another(sphere_chamber: Chamber) -> None:
    split = split_prior(sphere_chamber.basis, 144, length=15.0, smoothness=0.5)
    frequencies = sphere_chamber.basis.eigenvalues.round(7)
    for frequency in np.unique(frequencies):
        alike = split.variances[frequencies == frequency]
        assert alike == pytest.approx(alike[0], rel=1e-4)


def test_correlations_fall_from_one_and_smoother_ones_later() -> None:
    distances = np.linspace(0, 8, 81)
    curves = [matern_correlation(distances, nu) for nu in (0.5, 1.0, 1.5, 2.5)]
    for curve in curves:
        assert curve[0] == pytest.approx(1.0, abs=1e-6)
        assert (np.diff(curve) < 0).all()
    assert (np.diff([curve[1:] for curve in curves], axis=0) > 0).all()
    with pytest.raises(InputError, match="smoothness 0"):
        matern_correlation(distances, 0.7)


def test_beyond_its_reach_the_detail_is_uncorrelated(fine_chamber: Chamber) -> None:
    remainder = Remainder.of(fine_chamber.basis, 100, TERMS)
    assert remainder.correlation(np.array([0.0])) == pytest.approx(1.0)
    assert float(remainder.correlation(np.array([remainder.reach]))[0]) <= 5e-3
    assert 2 < remainder.reach < 60


def test_map_and_deviation_are_those_of_conditioning_on_the_whole_covariance(
    fine_chamber: Chamber,
) -> None:
    """Harmonics and remainder together, by plain formulae with the constant as a regressor."""
    sites = scattered(fine_chamber, 60)
    found = rebuilt(fine_chamber, sites)
    assert found.remainder is not None
    modes = fine_chamber.basis.modes[:, :100]
    prior, scale = found.posterior.prior_variances, 25 * found.remainder.variance
    positions = sites.positions(fine_chamber.mesh)
    away = np.linalg.norm(positions[:, None] - positions, axis=2)
    at = sites.of(modes)
    among = (at * prior) @ at.T + scale * found.remainder.correlation(away) + 0.25 * np.eye(60)
    across = (modes * prior) @ at.T
    across += scale * found.remainder.between(fine_chamber, sites).toarray()
    seen = np.linalg.solve(among, np.ones(60))
    mean = seen @ found.values / seen.sum()
    expected = mean + across @ np.linalg.solve(among, found.values - mean)
    told = np.einsum("vn,nv->v", across, np.linalg.solve(among, across.T))
    variance = np.square(modes) @ prior + scale - told + (1 - across @ seen) ** 2 / seen.sum()
    np.testing.assert_allclose(found.mean, expected, rtol=1e-9)
    np.testing.assert_allclose(found.variance, variance, rtol=1e-8)


def test_a_sample_without_noise_is_met_though_the_harmonics_are_few(fine_chamber: Chamber) -> None:
    chosen = np.arange(0, 2_500, 25)
    process = GaussianProcess(fine_chamber, Sites.at_vertices(chosen), n_modes=30)
    values = np.random.default_rng(5).standard_normal(len(chosen))
    found = process.given(values, replace(KNOWN, noise=1e-4))
    np.testing.assert_allclose(found.mean[chosen], values, atol=0.04)
    assert found.std[chosen].max() < 0.3 < found.std.mean()


def test_samples_in_one_place_share_their_detail(fine_chamber: Chamber) -> None:
    """However often it is measured there, detail a wall away is no better known."""
    once, often = (
        rebuilt(fine_chamber, Sites.at_vertices(np.full(count, 33))).std for count in (1, 30)
    )
    far = np.argmax(activation(fine_chamber))
    assert once[far] > 5
    assert often[far] == pytest.approx(once[far], rel=0.01)


def test_very_many_samples_are_conditioned_on_alike(
    fine_chamber: Chamber, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Detail independent from sample to sample: all but the same where they lie apart."""
    sites = Sites.at_vertices(np.arange(0, 2_500, 8))
    exact = rebuilt(fine_chamber, sites, 200)
    monkeypatch.setattr("auricle.sampling.gaussian_process.MOST_CORRELATED", 10)
    quick = rebuilt(fine_chamber, sites, 200)
    assert quick.posterior.remainder is not None
    assert quick.posterior.remainder.ndim == 1
    assert fine_chamber.rms(quick.mean - exact.mean) < 0.25 * fine_chamber.rms(exact.std)
    ratio = fine_chamber.rms(quick.std) / fine_chamber.rms(exact.std)
    assert ratio == pytest.approx(1.0, abs=0.15)


def test_draws_of_the_samples_have_the_covariance_of_noise_and_detail(
    fine_chamber: Chamber,
) -> None:
    found = rebuilt(fine_chamber, scattered(fine_chamber, 12))
    drawn = found.posterior.draw(np.random.default_rng(1), 20_000)
    assert np.var(drawn, axis=1) == pytest.approx(found.coefficient_variance, rel=0.08)
