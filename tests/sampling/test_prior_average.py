"""Priors averaged by their probability; edges told from noise."""

import numpy as np
import pytest
from scipy.stats import chi2

from auricle.arrays import Floats
from auricle.sampling.chamber import Chamber
from auricle.sampling.gaussian_process import SMOOTHNESSES, GaussianProcess, NoisePrior
from auricle.sampling.marginal_likelihood import Belief, Fit, SampleSpectrum
from auricle.sampling.matern import matern_variances
from auricle.sampling.prior_average import averaged
from auricle.sampling.reconstruction import Hyperparameters
from auricle.sampling.sites import Sites

CANDIDATES = ((0.5, 10.0), (1.5, 10.0), (1.5, 30.0))


def fits(*objectives: float) -> list[Fit]:
    return [
        Fit(amplitude, noise, objective, -objective)
        for amplitude, noise, objective in zip(
            (2.0, 1.0, 3.0), (0.1, 0.2, 0.3), objectives, strict=True
        )
    ]


def test_one_prior_far_more_probable_is_the_average() -> None:
    found, best = averaged(CANDIDATES, fits(90.0, 5.0, 90.0))
    assert best == 1
    assert (found.length, found.smoothness, found.amplitude, found.noise) == (10.0, 1.5, 1.0, 0.2)
    assert [term.share for term in found.terms] == [1.0]


def test_covariances_are_averaged_by_probability() -> None:
    """Two alike in likelihood: beforehand ν = ½ is to ν = 3/2 as 7 to 4."""
    found, best = averaged(CANDIDATES, fits(5.0, 90.0, 5.0))
    assert best == 0
    assert found.amplitude**2 == pytest.approx(7 / 11 * 4 + 4 / 11 * 9)
    assert found.noise**2 == pytest.approx(7 / 11 * 0.01 + 4 / 11 * 0.09)
    assert [term.share for term in found.terms] == pytest.approx([28 / 64, 36 / 64])


def test_less_weight_on_the_likelihood_brings_the_others_in() -> None:
    sure, _ = averaged(CANDIDATES, fits(12.0, 5.0, 12.0))
    unsure, _ = averaged(CANDIDATES, fits(12.0, 5.0, 12.0), weight=0.1)
    assert len(sure.terms) == 1
    assert len(unsure.terms) == 3


def drawn(chamber: Chamber, smoothness: float) -> Floats:
    rng = np.random.default_rng(1)
    variances = matern_variances(chamber.basis, length=20.0, smoothness=smoothness)
    return chamber.basis.inverse(np.sqrt(variances) * rng.standard_normal(len(variances)))


def test_a_smoother_map_gets_a_smoother_prior(fine_chamber: Chamber) -> None:
    sites = Sites.at_vertices(np.random.default_rng(4).choice(2_562, 250, replace=False))
    process = GaussianProcess(fine_chamber, sites)
    rough, smooth = (
        process.fit(sites.of(drawn(fine_chamber, smoothness))).hyperparameters
        for smoothness in (0.5, 2.5)
    )
    assert smooth.smoothness == SMOOTHNESSES[-1]
    assert 1.5 * rough.length < smooth.length
    assert sum(term.share for term in rough.terms) == pytest.approx(1.0, rel=1e-12)


def halves(chamber: Chamber) -> Floats:
    return np.where(chamber.mesh.vertices[:, 0] > 0, 1.0, 0.0)


def test_an_edge_is_not_taken_for_noise(fine_chamber: Chamber) -> None:
    rng = np.random.default_rng(6)
    sites = Sites.at_vertices(rng.choice(2_562, 300, replace=False))
    process = GaussianProcess(fine_chamber, sites)
    clean = process.fit(sites.of(halves(fine_chamber)))
    assert clean.hyperparameters.noise < 0.02
    noisy = sites.of(halves(fine_chamber)) + 0.05 * rng.standard_normal(300)
    assert 0.02 < process.fit(noisy).hyperparameters.noise < 0.08


def test_a_stated_noise_is_left_alone(fine_chamber: Chamber) -> None:
    sites = Sites.at_vertices(np.random.default_rng(6).choice(2_562, 300, replace=False))
    process = GaussianProcess(fine_chamber, sites)
    values = sites.of(halves(fine_chamber))
    assert process.fit(values, noise=0.1).hyperparameters.noise == pytest.approx(0.1, rel=1e-6)
    stated = process.fit(values, noise_prior=NoisePrior(0.1, 0.05)).hyperparameters.noise
    assert stated == pytest.approx(0.1, rel=0.15)


def share(chamber: Chamber, sites: Sites, values: Floats) -> float:
    """Typical share of the residuals under a prior of ν = 3/2 whose amplitude and noise are fit."""
    variances = matern_variances(chamber.basis, length=20.0)
    at_samples, alike = sites.of(chamber.basis.modes), np.ones(len(sites))
    spectrum = SampleSpectrum.of(at_samples, variances, alike, length=20.0)
    spread = float(np.sqrt(values.var(axis=0).mean()))  # the same however values are turned
    fit = spectrum.fit(values, Belief(spread, 0.1, 1.0))
    found = GaussianProcess(chamber, sites, n_modes=chamber.basis.n_modes).given(
        values, Hyperparameters(20.0, fit.amplitude, fit.noise)
    )
    residuals, deviations = found.leave_one_out
    squares = np.square(residuals / deviations[:, None]).sum(axis=1)
    expected = np.sqrt(
        np.median(squares) / squares.mean() * values.shape[1] / chi2.median(values.shape[1])
    )
    assert spectrum.typical_share(values, fit) == pytest.approx(expected, rel=1e-6)
    return spectrum.typical_share(values, fit)


def test_normal_residuals_are_typical_and_an_edge_is_not(fine_chamber: Chamber) -> None:
    rng = np.random.default_rng(8)
    sites = Sites.at_vertices(rng.choice(2_562, 250, replace=False))
    smooth = sites.of(drawn(fine_chamber, 1.5))[:, None] + 0.3 * rng.standard_normal((250, 2))
    assert share(fine_chamber, sites, smooth) == pytest.approx(1.0, abs=0.15)
    turned = smooth @ np.array([[0.6, -0.8], [0.8, 0.6]])
    same = share(fine_chamber, sites, smooth)
    assert share(fine_chamber, sites, turned) == pytest.approx(same, rel=1e-6)
    assert share(fine_chamber, sites, sites.of(halves(fine_chamber))[:, None]) < 0.5
