"""The map as mean of process and splines: linear, bounded, as unsure as its members differ."""

from dataclasses import replace

import numpy as np
import pytest

from auricle.arrays import Floats
from auricle.sampling.chamber import Chamber
from auricle.sampling.cross_validation import from_some
from auricle.sampling.gaussian_process import GaussianProcess
from auricle.sampling.reconstruction import Reconstruction
from auricle.sampling.sites import Sites
from auricle.sampling.splines import shares


def scattered(chamber: Chamber, count: int, seed: int = 4) -> Sites:
    rng = np.random.default_rng(seed)
    faces = chamber.mesh.faces[rng.choice(chamber.mesh.n_faces, count, replace=False)]
    return Sites(faces, rng.dirichlet([1, 1, 1], count))


def activation(chamber: Chamber) -> Floats:
    distances: Floats = np.linalg.norm(chamber.mesh.vertices - chamber.mesh.vertices[5], axis=1)
    return distances


def fitted(chamber: Chamber, truth: Floats, count: int = 60) -> Reconstruction:
    sites = scattered(chamber, count)
    noise = 0.02 * truth.std() * np.random.default_rng(9).standard_normal((count, *truth.shape[1:]))
    return GaussianProcess(chamber, sites).fit(sites.of(truth) + noise)


def test_the_map_is_the_mean_of_its_members_by_their_shares(fine_chamber: Chamber) -> None:
    found = fitted(fine_chamber, activation(fine_chamber))
    assert [(term.power, term.share) for _, term in found.splines] == list(shares(60))
    expected = (1 - sum(share for _, share in shares(60))) * found.process_mean
    centre = found.values.mean()
    for spline, term in found.splines:
        alone = spline.mean(found.values[:, None] - centre, term.smoothing)[:, 0] + centre
        expected = expected + term.share * alone
    free = np.abs(found.mean - found.values.min()) > 1e-9
    free &= np.abs(found.mean - found.values.max()) > 1e-9
    assert free.mean() > 0.95
    np.testing.assert_allclose(found.mean[free], expected[free], atol=1e-9)


def test_members_that_differ_make_the_map_less_sure(fine_chamber: Chamber) -> None:
    found = fitted(fine_chamber, activation(fine_chamber))
    added = found.variance - found.process_variance
    assert added.min() >= 0
    centre = found.values.mean()
    apart = np.ptp(
        [
            found.process_mean,
            *(
                spline.mean(found.values[:, None] - centre, term.smoothing)[:, 0] + centre
                for spline, term in found.splines
            ),
        ],
        axis=0,
    )
    assert (added <= apart**2 / 4 + 1e-9).all()
    assert np.corrcoef(np.sqrt(added), apart)[0, 1] > 0.9


def test_left_out_residuals_are_those_of_a_refit(fine_chamber: Chamber) -> None:
    """Phases have no bounds: linear, but for correlations of detail that the map leaves out."""
    angle = activation(fine_chamber) / 10
    sites = Sites.at_vertices(np.arange(0, 2_560, 64))
    process = GaussianProcess(fine_chamber, sites)
    found = process.fit(sites.of(np.column_stack([np.cos(angle), np.sin(angle)])))
    residuals, deviations = found.leave_one_out
    for out in (0, 11, 39):
        kept = np.delete(np.arange(40), out)
        refit = from_some(process, found.values, found.hyperparameters, kept)
        missed = found.values[out] - sites[[out]].of(refit.mean)[0]
        assert residuals[out] == pytest.approx(missed, abs=1e-6)
    assert (deviations > replace(found, splines=()).leave_one_out[1]).all()


def test_a_step_is_kept_within_its_plateaus(fine_chamber: Chamber) -> None:
    step = np.where(fine_chamber.mesh.vertices[:, 0] > 0, 1.0, 0.0)
    sites = Sites.at_vertices(np.arange(0, 2_562, 20))
    found = GaussianProcess(fine_chamber, sites).fit(sites.of(step))
    assert found.mean.min() == 0.0
    assert found.mean.max() == 1.0
    beyond = np.maximum(found.process_mean - 1, -found.process_mean).max()
    assert beyond > 0.02


def test_a_noisy_step_has_flat_plateaus_and_a_smaller_error_than_its_members_mean(
    fine_chamber: Chamber,
) -> None:
    step = np.where(fine_chamber.mesh.vertices[:, 0] > 0, 1.0, 0.0)
    sites = Sites.at_vertices(np.arange(0, 2_562, 20))
    noise = 0.1 * np.random.default_rng(6).standard_normal(len(sites))
    found = GaussianProcess(fine_chamber, sites).fit(sites.of(step) + noise)
    assert found.values.min() < -0.2
    assert found.mean.min() == pytest.approx(0.0, abs=0.05)
    assert found.mean.max() == pytest.approx(1.0, abs=0.05)
    spline, term = found.splines[0]
    centre = found.values.mean()
    alone = spline.mean(found.values[:, None] - centre, term.smoothing)[:, 0] + centre
    plain = term.share * alone + (1 - term.share) * found.process_mean
    assert fine_chamber.nrmse(found.mean, step) < 0.96 * fine_chamber.nrmse(plain, step)


def test_the_mean_is_nearer_the_truth_than_its_members_are(atrium_chamber: Chamber) -> None:
    """In the root mean square over maps of several kinds."""
    vertices = atrium_chamber.mesh.vertices
    near = np.linalg.norm(vertices[:, None] - vertices[[40, 900, 1700]], axis=2)
    truths = [near.min(axis=1), np.exp(-(near[:, 0] ** 2) / 200), np.where(near[:, 1] < 15, 1, 0)]
    errors = []
    for truth in truths:
        found = fitted(atrium_chamber, truth.astype(float), 100)
        centre = found.values.mean()
        members = [found.process_mean] + [
            spline.mean(found.values[:, None] - centre, term.smoothing)[:, 0] + centre
            for spline, term in found.splines
        ]
        errors.append([atrium_chamber.nrmse(each, truth) for each in (found.mean, *members)])
    mixed, *alone = np.sqrt(np.square(errors).mean(axis=0))
    assert mixed < min(alone)


def test_a_stated_smoothness_and_what_says_nothing_go_without_splines(
    sphere_chamber: Chamber, monkeypatch: pytest.MonkeyPatch
) -> None:
    sites, truth = scattered(sphere_chamber, 30), activation(sphere_chamber)
    alone = GaussianProcess(sphere_chamber, sites, smoothness=1.5).fit(sites.of(truth))
    assert alone.splines == ()
    np.testing.assert_array_equal(alone.mean, alone.process_mean)
    assert GaussianProcess(sphere_chamber, sites).fit(np.full(30, 2.0)).splines == ()
    monkeypatch.setattr("auricle.sampling.gaussian_process.MOST_CORRELATED", 10)
    assert GaussianProcess(sphere_chamber, sites).fit(sites.of(truth)).splines == ()
