"""Samples left out: honest errors, the same for every method."""

from dataclasses import replace

import numpy as np
import pytest

from auricle.errors import InputError
from auricle.sampling.baselines import BASELINES
from auricle.sampling.chamber import Chamber, chamber
from auricle.sampling.cross_validation import FEWEST_SAMPLES, N_FOLDS, cross_validated, from_some
from auricle.sampling.gaussian_process import GaussianProcess
from auricle.sampling.reconstruction import Hyperparameters
from auricle.sampling.sites import Sites
from auricle.surface.shapes import icosphere

GIVEN = Hyperparameters(length=20.0, amplitude=1.0, noise=0.05)


@pytest.fixture(scope="module")
def ball() -> Chamber:
    return chamber(icosphere(radius=30.0, subdivisions=3), 100)


@pytest.fixture(scope="module")
def sites(ball) -> Sites:
    return Sites.at_vertices(np.random.default_rng(3).permutation(ball.mesh.n_vertices)[:60])


@pytest.fixture(scope="module")
def values(ball, sites) -> np.ndarray:
    x, y, z = sites.positions(ball.mesh).T / 30
    return np.sin(3 * x) + y * z


def errors(process, values, seed=1):
    return cross_validated(process, values, GIVEN, rng=np.random.default_rng(seed))


def test_every_method_is_tried_and_ours_comes_first(ball, sites, values):
    found = errors(GaussianProcess(ball, sites), values)
    assert list(found) == ["gaussian_process", *BASELINES]
    for error in found.values():
        assert error.rms / error.relative == pytest.approx(values.std())


def test_a_smooth_map_is_foretold_far_better_than_by_the_nearest_sample(ball, sites, values):
    """Sabotage: to let a fold see its own samples makes the nearest sample's error 0."""
    found = errors(GaussianProcess(ball, sites), values)
    assert found["gaussian_process"].relative < 0.5 * found["nearest"].relative
    assert found["nearest"].relative > 0.1


def test_noise_alone_cannot_be_foretold(ball, sites):
    noise = np.random.default_rng(0).standard_normal(len(sites))
    for name, error in errors(GaussianProcess(ball, sites), noise).items():
        assert error.relative > 0.85, name


def test_errors_scale_with_the_values_and_ignore_an_offset(ball, sites, values):
    process = GaussianProcess(ball, sites)
    base = errors(process, values)
    moved = cross_validated(
        process,
        1000 + 7 * values,
        replace(GIVEN, amplitude=7.0, noise=0.35),
        rng=np.random.default_rng(1),
    )
    for name, error in base.items():
        assert moved[name].rms == pytest.approx(7 * error.rms, rel=1e-6), name


def test_two_columns_count_together(ball, sites, values):
    process = GaussianProcess(ball, sites)
    twice = errors(process, np.column_stack([values, values]))
    for name, error in errors(process, values).items():
        assert twice[name].rms == pytest.approx(np.sqrt(2) * error.rms)
        assert twice[name].relative == pytest.approx(error.relative)


def test_one_seed_gives_one_answer_and_another_seed_other_folds(ball, sites, values):
    process = GaussianProcess(ball, sites)
    assert errors(process, values) == errors(process, values)
    assert errors(process, values) != errors(process, values, seed=2)


def test_each_fold_is_told(ball, sites, values):
    told = []
    cross_validated(
        GaussianProcess(ball, sites),
        values,
        GIVEN,
        rng=np.random.default_rng(1),
        progress=lambda stage, done, total: told.append((stage, done, total)),
    )
    assert told == [("leave samples out", fold, N_FOLDS) for fold in range(N_FOLDS + 1)]


def test_some_samples_keep_the_noise_they_have_among_all(ball, sites, values):
    """Sabotage: without the rescaling the sure half is taken for as noisy as all."""
    shape = np.where(np.arange(len(sites)) < 30, 0.1, 3.0)
    process = GaussianProcess(ball, sites, noise_shape=shape)
    every = process.posterior(GIVEN).noise_variances
    sure = np.arange(30)
    part = from_some(process, values, GIVEN, sure)
    np.testing.assert_allclose(part.posterior.noise_variances, every[sure])


def test_all_of_the_samples_give_the_map_itself(ball, sites, values):
    process = GaussianProcess(ball, sites)
    again = from_some(process, values, GIVEN, np.arange(len(sites)))
    np.testing.assert_allclose(again.mean, process.given(values, GIVEN).mean, atol=1e-12)


def test_too_few_samples_or_all_alike_are_refused(ball, sites, values):
    few = GaussianProcess(ball, sites[np.arange(FEWEST_SAMPLES - 1)])
    with pytest.raises(InputError, match="19 samples are too few"):
        errors(few, values[: FEWEST_SAMPLES - 1])
    with pytest.raises(InputError, match="all samples are equal"):
        errors(GaussianProcess(ball, sites), np.full(len(sites), 3.0))
