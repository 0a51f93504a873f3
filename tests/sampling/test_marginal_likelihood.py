"""The best amplitude and noise are the best: against the objective written out."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from auricle.arrays import Floats
from auricle.errors import InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.marginal_likelihood import Belief, SampleSpectrum
from auricle.sampling.matern import matern_variances

N_SAMPLES, LENGTH = 24, 20.0
BELIEF = Belief(amplitude=3.0, noise=0.4, noise_spread=0.7)


@pytest.fixture(params=[12, 144], ids=["more samples than modes", "more modes than samples"])
def at_samples(request: pytest.FixtureRequest, sphere_chamber: Chamber) -> Floats:
    chosen = np.random.default_rng(1).choice(642, N_SAMPLES, replace=False)
    return np.asarray(sphere_chamber.basis.modes[chosen, : request.param])


@pytest.fixture
def prior(at_samples: Floats, sphere_chamber: Chamber) -> Floats:
    variances = matern_variances(sphere_chamber.basis, length=LENGTH)
    return np.asarray(variances[: at_samples.shape[1]])


def shape() -> Floats:
    relative = np.random.default_rng(2).uniform(0.5, 2.0, N_SAMPLES)
    return np.asarray(relative / np.sqrt(np.square(relative).mean()))


def values() -> Floats:
    return np.asarray(50 + 4 * np.random.default_rng(3).standard_normal((N_SAMPLES, 2)))


def objective(at_samples: Floats, prior: Floats, amplitude: float, noise: float) -> float:
    """Minus log posterior of amplitude and noise, by contrasts free of the constant."""
    spread = amplitude**2 * (at_samples * prior) @ at_samples.T + np.diag(noise * shape()) ** 2
    basis = np.column_stack([np.ones(N_SAMPLES), np.eye(N_SAMPLES)[:, 1:]])
    contrasts = np.linalg.qr(basis)[0][:, 1:]
    among = multivariate_normal(cov=contrasts.T @ spread @ contrasts)
    likelihood = among.logpdf((contrasts.T @ values()).T).sum()
    ratio = (BELIEF.amplitude / amplitude) ** 2
    of_amplitude = 0.5 * (2 * np.log(amplitude) + ratio)
    of_noise = 0.5 * (np.log(noise / BELIEF.noise) / BELIEF.noise_spread) ** 2
    return float(of_amplitude + of_noise - likelihood)


def test_no_other_amplitude_or_noise_is_more_probable(at_samples: Floats, prior: Floats) -> None:
    fit = SampleSpectrum.of(at_samples, prior, shape(), length=LENGTH).fit(values(), BELIEF)
    least = objective(at_samples, prior, fit.amplitude, fit.noise)
    for amplitude in (0.97, 1.0, 1.03):
        for noise in (0.97, 1.0, 1.03):
            other = objective(at_samples, prior, amplitude * fit.amplitude, noise * fit.noise)
            assert other >= least - 1e-6


def test_differences_of_objective_are_those_written_out(at_samples: Floats, prior: Floats) -> None:
    """Between the free noise and one that is fixed, the noise's own prior aside."""
    spectrum = SampleSpectrum.of(at_samples, prior, shape(), length=LENGTH)
    free = spectrum.fit(values(), BELIEF)
    fixed = spectrum.fit(values(), Belief(BELIEF.amplitude, 2.0, 0.0))
    assert fixed.noise == pytest.approx(2.0)
    written = objective(at_samples, prior, fixed.amplitude, 2.0)
    written -= objective(at_samples, prior, free.amplitude, free.noise)
    own = 0.5 * (np.log(2.0 / BELIEF.noise) / BELIEF.noise_spread) ** 2
    assert fixed.objective + own - free.objective == pytest.approx(written, abs=1e-8)


def test_samples_far_apart_see_the_whole_variance_and_samples_together_none(
    sphere_chamber: Chamber,
) -> None:
    modes, prior = sphere_chamber.basis.modes, matern_variances(sphere_chamber.basis, length=10.0)
    everywhere = SampleSpectrum.of(modes, prior, np.ones(642), length=10.0)
    together = SampleSpectrum.of(modes[[5] * 9], prior, np.ones(9), length=10.0)
    assert everywhere.visible == pytest.approx(1.0, abs=0.02)
    assert together.visible < 1e-12


@pytest.mark.parametrize("wrong", [(0.0, 1.0, 1.0), (1.0, -1.0, 1.0), (1.0, 1.0, -1.0)])
def test_beliefs_are_positive(wrong: tuple[float, float, float]) -> None:
    with pytest.raises(InputError, match="give positive numbers"):
        Belief(*wrong)
