"""Outliers lose their weight; true edges, and all but a few samples, keep it."""

import numpy as np
import pytest

from auricle.arrays import Floats
from auricle.sampling.chamber import Chamber
from auricle.sampling.gaussian_process import GaussianProcess, NoisePrior
from auricle.sampling.robust import LARGEST_SHARE, fit_robustly
from auricle.sampling.sites import Sites


@pytest.fixture(scope="module")
def process(sphere_chamber: Chamber) -> GaussianProcess:
    chosen = np.random.default_rng(14).choice(642, 200, replace=False)
    return GaussianProcess(sphere_chamber, Sites.at_vertices(chosen))


def smooth(chamber: Chamber) -> Floats:
    return np.asarray(np.linalg.norm(chamber.mesh.vertices - [30.0, 0, 0], axis=1))


def measured(process: GaussianProcess, truth: Floats) -> Floats:
    noise = 1.0 * np.random.default_rng(15).standard_normal(200)
    return np.asarray(process.sites.of(truth) + noise)


def test_isolated_outliers_are_found_and_cost_little(process: GaussianProcess) -> None:
    truth = smooth(process.chamber)
    values = measured(process, truth)
    wrong = np.array([3, 50, 77, 120, 160, 199])
    values[wrong] += 40.0 * np.array([1, -1, 1, 1, -1, 1])
    robust = fit_robustly(process, values)
    assert set(wrong.tolist()) <= set(robust.doubted.tolist())
    assert len(robust.doubted) <= len(wrong) + 2
    plain = process.chamber.nrmse(process.fit(values).mean, truth)
    clean = process.chamber.nrmse(process.fit(measured(process, truth)).mean, truth)
    found = process.chamber.nrmse(robust.reconstruction.mean, truth)
    assert found < 0.5 * plain
    assert found < 1.4 * clean


def test_without_outliers_next_to_nothing_changes(process: GaussianProcess) -> None:
    truth = smooth(process.chamber)
    robust = fit_robustly(process, measured(process, truth))
    assert len(robust.doubted) <= 1


def test_the_edge_of_a_scar_is_no_outlier(process: GaussianProcess) -> None:
    vertices = process.chamber.mesh.vertices
    truth = np.where(np.linalg.norm(vertices - [0, 0, 30.0], axis=1) < 17.0, 0.1, 2.0)
    values = process.sites.of(truth)
    plain = process.chamber.nrmse(process.fit(values).mean, truth)
    robust = fit_robustly(process, values)
    assert process.chamber.nrmse(robust.reconstruction.mean, truth) < 1.05 * plain


def test_no_more_than_a_twentieth_is_doubted(process: GaussianProcess) -> None:
    values = measured(process, smooth(process.chamber))
    values[::8] += 60.0
    robust = fit_robustly(process, values)
    assert len(robust.doubted) <= LARGEST_SHARE * 200


def test_few_samples_are_all_believed(sphere_chamber: Chamber) -> None:
    process = GaussianProcess(sphere_chamber, Sites.at_vertices(np.arange(19) * 30))
    values = np.zeros(19)
    values[4] = 100.0
    assert not len(fit_robustly(process, values).doubted)


def test_noise_stated_is_that_of_the_samples_believed(process: GaussianProcess) -> None:
    values = measured(process, smooth(process.chamber))
    values[50] += 60.0
    for options in ({"noise": 1.0}, {"noise_prior": NoisePrior(1.0, 0.01)}):
        robust = fit_robustly(process, values, **options)
        assert robust.doubted.tolist() == [50]
        spread = np.sqrt(robust.reconstruction.posterior.noise_variances)
        assert np.delete(spread, 50) == pytest.approx(1.0, rel=0.05)
        assert spread[50] > 30
