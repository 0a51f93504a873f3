"""Bayes' rule against its textbook form, and against itself with a sample less or more."""

import numpy as np
import pytest

from auricle.arrays import Floats
from auricle.errors import InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.matern import matern_variances
from auricle.sampling.posterior import Posterior
from auricle.sampling.sites import Sites

MORE_SAMPLES_THAN_MODES = (60, 25)
MORE_MODES_THAN_SAMPLES = (30, 144)


def conditioned(chamber: Chamber, n_samples: int, n_modes: int, seed: int = 3) -> Posterior:
    rng = np.random.default_rng(seed)
    faces = chamber.mesh.faces[rng.choice(chamber.mesh.n_faces, n_samples, replace=False)]
    sites = Sites(faces, rng.dirichlet([1, 1, 1], n_samples))
    noise = rng.uniform(0.1, 0.3, n_samples) ** 2
    variances = 4.0 * matern_variances(chamber.basis, length=15.0)[:n_modes]
    return Posterior.of(sites.of(chamber.basis.modes[:, :n_modes]), variances, noise)


def values_of(posterior: Posterior, seed: int = 4) -> Floats:
    return 100 + np.random.default_rng(seed).normal(size=len(posterior.at_samples))


@pytest.mark.parametrize("sizes", [MORE_SAMPLES_THAN_MODES, MORE_MODES_THAN_SAMPLES])
def test_covariance_and_mean_are_those_of_the_normal_equations(
    sphere_chamber: Chamber, sizes: tuple[int, int]
) -> None:
    found = conditioned(sphere_chamber, *sizes)
    certainty = np.zeros(sizes[1])  # of the prior; none of the constant
    certainty[1:] = 1 / found.prior_variances[1:]
    weighted = found.at_samples / found.noise_variances[:, None]
    expected = np.linalg.inv(np.diag(certainty) + found.at_samples.T @ weighted)
    assert np.allclose(found.covariance.matrix, expected, rtol=0, atol=1e-11 * expected.max())
    assert np.allclose(found.operator, expected @ weighted.T, rtol=0, atol=1e-9)
    assert np.allclose(found.covariance.variances, np.diag(expected), rtol=1e-9)
    modes = sphere_chamber.basis.modes[:, : sizes[1]]
    on_map = np.einsum("nk,kl,nl->n", modes, expected, modes)
    assert np.allclose(found.covariance.seen_by(modes), on_map, rtol=1e-9)


@pytest.mark.parametrize("sizes", [MORE_SAMPLES_THAN_MODES, MORE_MODES_THAN_SAMPLES])
def test_a_constant_map_is_found_whatever_its_size(
    sphere_chamber: Chamber, sizes: tuple[int, int]
) -> None:
    found = conditioned(sphere_chamber, *sizes)
    modes = sphere_chamber.basis.modes[:, : sizes[1]]
    rebuilt = modes @ (found.operator @ np.full(sizes[0], 1e6))
    assert np.allclose(rebuilt, 1e6, rtol=1e-9)


@pytest.mark.parametrize("sizes", [MORE_SAMPLES_THAN_MODES, MORE_MODES_THAN_SAMPLES])
def test_closed_form_leave_one_out_is_a_refit_without_the_sample(
    sphere_chamber: Chamber, sizes: tuple[int, int]
) -> None:
    found = conditioned(sphere_chamber, *sizes)
    values = values_of(found)
    residuals, deviations = found.leave_one_out(values)
    for left_out in range(0, sizes[0], 7):
        others = np.delete(np.arange(sizes[0]), left_out)
        refit = Posterior.of(
            found.at_samples[others], found.prior_variances, found.noise_variances[others]
        )
        here = found.at_samples[left_out]
        predicted = here @ (refit.operator @ values[others])
        spread = refit.covariance.seen_by(here[None, :])[0] + found.noise_variances[left_out]
        assert residuals[left_out] == pytest.approx(values[left_out] - predicted, rel=1e-8)
        assert deviations[left_out] == pytest.approx(np.sqrt(spread), rel=1e-8)


@pytest.mark.parametrize("sizes", [(400, 25), MORE_MODES_THAN_SAMPLES])
def test_draws_scatter_as_the_covariance_says(
    sphere_chamber: Chamber, sizes: tuple[int, int]
) -> None:
    found = conditioned(sphere_chamber, *sizes)
    drawn = found.draw(np.random.default_rng(5), 20_000)
    scale = np.sqrt(found.covariance.variances)
    correlation = (drawn @ drawn.T / 20_000 - found.covariance.matrix) / np.outer(scale, scale)
    assert np.abs(correlation).max() < 5 / np.sqrt(20_000) * 1.5


def test_one_sample_leaves_the_prior_and_says_nothing_of_itself(sphere_chamber: Chamber) -> None:
    found = conditioned(sphere_chamber, 1, 144)
    modes = sphere_chamber.basis.modes
    far = modes[[np.argmin(modes @ (found.prior_variances * found.at_samples[0]))]]
    # Both the map there and the constant, known only through the map here, are unknown.
    assert found.covariance.seen_by(far)[0] > 1.8 * 4.0
    here = found.covariance.seen_by(found.at_samples)[0]
    assert here == pytest.approx(found.noise_variances[0], rel=1e-9)
    residuals, deviations = found.leave_one_out(np.array([7.0]))
    assert residuals.tolist() == [0.0]
    assert np.isinf(deviations).all()


def test_nothing_to_condition_on_is_refused(sphere_chamber: Chamber) -> None:
    with pytest.raises(InputError, match="no sample"):
        Posterior.of(np.zeros((0, 4)), np.ones(4), np.zeros(0))
    with pytest.raises(InputError, match="not positive"):
        Posterior.of(sphere_chamber.basis.modes[:2, :4], np.ones(4), np.zeros(2))
