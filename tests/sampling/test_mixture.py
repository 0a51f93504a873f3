"""The map as mean of process and splines: linear, bounded, as unsure as its members differ."""

from dataclasses import replace

import numpy as np
import pytest

from auricle.arrays import Floats
from auricle.sampling.chamber import Chamber
from auricle.sampling.cross_validation import from_some
from auricle.sampling.gaussian_process import GaussianProcess
from auricle.sampling.mixture import LEAST_SHARE, POWERS, PROCESS, shares
from auricle.sampling.neighbourhoods import left_out_together, neighbourhoods
from auricle.sampling.reconstruction import Reconstruction
from auricle.sampling.sites import Sites
from auricle.sampling.splines import Spline


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
    assert found.hyperparameters.splines == tuple(term for _, term in found.splines)
    expected = (1 - sum(term.share for _, term in found.splines)) * found.process_mean
    centre = found.values.mean()
    for spline, term in found.splines:
        alone = spline.mean(found.values[:, None] - centre, term.smoothing)[:, 0] + centre
        expected = expected + term.share * alone
    free = np.abs(found.mean - found.values.min()) > 1e-9
    free &= np.abs(found.mean - found.values.max()) > 1e-9
    assert free.mean() > 0.95
    np.testing.assert_allclose(found.mean[free], expected[free], atol=1e-9)


def test_shares_are_those_of_what_each_misses_without_the_neighbours(
    fine_chamber: Chamber,
) -> None:
    """Of few samples of a step, where rougher splines share too."""
    step = np.where(fine_chamber.mesh.vertices[:, 0] > 0, 1.0, 0.0)
    found = fitted(fine_chamber, step, 30)
    assert found.sites is not None
    together = neighbourhoods(fine_chamber, found.sites)
    values, alike = found.values[:, None], np.ones(30)
    missed = [left_out_together(found.posterior.precision, values, together)]
    for power in POWERS:
        spline = Spline(fine_chamber, found.sites, power, alike)
        smoothing = spline.smoothing(values, found.hyperparameters.noise)
        missed.append(left_out_together(spline.precision(smoothing), values, together))
    expected = dict(zip(POWERS, shares(np.array(missed))[1:], strict=True))
    mine = {term.power: term.share for _, term in found.splines}
    assert len(mine) > 1
    assert mine == pytest.approx({key: each for key, each in expected.items() if each > 0})


def test_where_nothing_tells_them_apart_shares_are_those_beforehand() -> None:
    alike = np.random.default_rng(1).standard_normal((40, 2)) * np.ones((5, 1, 1))
    found = shares(alike)
    assert found[0] == pytest.approx(PROCESS, rel=0.01)
    kept = found[1:] > 0
    assert kept.tolist() == [(1 - PROCESS) * each >= LEAST_SHARE for each in POWERS.values()]
    between = np.array(list(POWERS.values()))[kept]
    np.testing.assert_allclose(found[1:][kept] / found[-1], between / between[-1])
    np.testing.assert_array_equal(shares(np.zeros((5, 40, 2)))[1:] > 0, kept)


def test_a_spline_that_misses_less_gains_the_surer_the_more_samples_say_so() -> None:
    gained = []
    for count in (20, 60, 180, 5_000):
        missed = np.random.default_rng(2).standard_normal((5, count, 1))
        missed[1:] = missed[1] * np.array([1.0, 0.93, 1.0, 1.0])[:, None, None]
        found = shares(missed)
        assert found.sum() == pytest.approx(1.0)
        gained.append(found[2] / found[1:].sum())
    assert np.diff(gained[:3]).min() > 0.02
    assert 0.8 < gained[2] < gained[3] < 0.99


def test_the_process_gains_where_the_splines_miss_more_and_loses_where_it_does() -> None:
    rng = np.random.default_rng(3)
    common, own = rng.standard_normal((200, 1)), rng.standard_normal((2, 200, 1))
    process, splines = common + 0.5 * own[0], common + 0.5 * own[1]

    def share(process: Floats, splines: Floats) -> float:
        return float(shares(np.array([process, *[splines] * 4]))[0])

    even = share(process, splines)
    assert even == pytest.approx(PROCESS, abs=0.05)
    assert share(process, 2 * splines) > even + 0.2
    assert share(2 * process, splines) < even - 0.2
    assert 0 < share(9 * process, common) < share(2 * process, splines)


def test_clusters_are_asked_for_the_map_between_them(
    fine_chamber: Chamber, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a scar's rim a smooth spline goes on falling beyond the cluster that saw it."""
    vertices = fine_chamber.mesh.vertices
    places = vertices[[5, 900, 1500, 2300, 2550]]
    order = np.linalg.norm(vertices[:, None] - places, axis=2).argsort(axis=0)
    sites = Sites.at_vertices(np.unique(order[:12]))
    ramp = np.clip(np.linalg.norm(vertices - places[0], axis=1) / 12, 0, 1)
    values = sites.of(ramp)
    together = GaussianProcess(fine_chamber, sites).fit(values)
    lone = tuple(np.array([index]) for index in range(len(sites)))
    name = "auricle.sampling.gaussian_process.neighbourhoods"
    monkeypatch.setattr(name, lambda *_: lone)
    alone = GaussianProcess(fine_chamber, sites).fit(values)
    errors = [fine_chamber.nrmse(each.mean, ramp) for each in (together, alone)]
    assert errors[0] < errors[1]


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
    centre = found.values.mean()
    plain = (1 - sum(term.share for _, term in found.splines)) * found.process_mean
    for spline, term in found.splines:
        alone = spline.mean(found.values[:, None] - centre, term.smoothing)[:, 0] + centre
        plain = plain + term.share * alone
    assert fine_chamber.nrmse(found.mean, step) < 0.96 * fine_chamber.nrmse(plain, step)


def test_the_mean_is_nearer_the_truth_than_its_members_are(atrium_chamber: Chamber) -> None:
    """In the root mean square over maps of several kinds."""
    vertices = atrium_chamber.mesh.vertices
    near = np.linalg.norm(vertices[:, None] - vertices[[40, 900, 1700]], axis=2)
    truths = [near.min(axis=1), np.exp(-(near[:, 0] ** 2) / 200), np.where(near[:, 1] < 15, 1, 0)]
    errors = []
    for truth in truths:
        found = fitted(atrium_chamber, truth.astype(float), 100)
        centre, sites = found.values.mean(), scattered(atrium_chamber, 100)
        values, members = found.values[:, None] - centre, [found.process_mean]
        for power in POWERS:
            spline = Spline(atrium_chamber, sites, power, np.ones(100))
            smoothing = spline.smoothing(values, found.hyperparameters.noise)
            members.append(spline.mean(values, smoothing)[:, 0] + centre)
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
