"""Samples taken out one after another, held against reconstructions without them."""

from dataclasses import replace

import numpy as np
import pytest

from auricle.sampling.chamber import Chamber, chamber
from auricle.sampling.gaussian_process import GaussianProcess
from auricle.sampling.reconstruction import Hyperparameters, Reconstruction
from auricle.sampling.sites import Sites
from auricle.study.redundancy import FEWEST, SAME_ERROR, redundancy
from auricle.surface.shapes import icosphere

HYPER = Hyperparameters(length=20.0, amplitude=10.0, noise=0.5)


@pytest.fixture(scope="module")
def ball() -> Chamber:
    return chamber(icosphere(radius=30.0, subdivisions=3), 100)


def reconstructed(ball: Chamber, places: np.ndarray) -> Reconstruction:
    values = ball.mesh.vertices[places, 0]
    return GaussianProcess(ball, Sites.at_vertices(places)).given(values, HYPER)


@pytest.fixture(scope="module")
def places(ball) -> np.ndarray:
    return np.random.default_rng(4).choice(ball.mesh.n_vertices, 40, replace=False)


def test_every_error_is_that_of_a_reconstruction_without_the_samples_taken_out(ball, places):
    areas = ball.accessible_areas
    found = reconstructed(ball, places)
    less = redundancy(found, areas)
    assert less.nrmse[0] == pytest.approx(found.predicted_nrmse, rel=1e-9)
    for step in (1, 10, 25, len(less.counts) - 1):
        count = int(less.counts[step])
        kept = np.delete(np.arange(40), less.removed[: 40 - count])
        without = reconstructed(ball, places[kept])
        rise = ball.mean(without.variance) / ball.mean(found.variance)
        assert less.nrmse[step] / less.nrmse[0] == pytest.approx(np.sqrt(rise), rel=1e-8)


def test_the_first_taken_out_is_the_one_whose_loss_is_least(ball, places) -> None:
    less = redundancy(reconstructed(ball, places), ball.accessible_areas)
    losses = [
        ball.mean(reconstructed(ball, np.delete(places, index)).variance) for index in range(40)
    ]
    assert less.removed[0] == int(np.argmin(losses))


def test_many_at_a_time_are_as_exact(ball) -> None:
    places = np.random.default_rng(5).choice(ball.mesh.n_vertices, 320, replace=False)
    less = redundancy(reconstructed(ball, places), ball.accessible_areas)
    assert less.counts[0] - less.counts[1] == 3
    kept = np.delete(np.arange(320), less.removed[: 320 - int(less.counts[8])])
    ratio = ball.mean(reconstructed(ball, places[kept]).variance) / ball.mean(
        reconstructed(ball, places).variance
    )
    assert less.nrmse[8] / less.nrmse[0] == pytest.approx(np.sqrt(ratio), rel=1e-8)


def test_samples_far_from_what_counts_go_first(ball, places) -> None:
    """Only the error of the right half counts; what lies far to the left is missed least."""
    x = ball.mesh.vertices[:, 0]
    less = redundancy(reconstructed(ball, places), np.where(x > 0, ball.basis.areas, 0.0))
    first = ball.mesh.vertices[places[less.removed[:8]], 0]
    assert first.max() < -10


def test_the_error_only_rises_and_each_sample_is_taken_out_once(ball, places) -> None:
    less = redundancy(reconstructed(ball, places), ball.accessible_areas)
    assert (np.diff(less.nrmse) >= 0).all()
    assert len(set(less.removed.tolist())) == len(less.removed) == 40 - FEWEST
    assert less.counts[-1] == FEWEST


def test_what_is_enough_keeps_within_the_error_and_one_fewer_does_not(ball, places) -> None:
    less = redundancy(reconstructed(ball, places), ball.accessible_areas)
    target = float(less.nrmse[12]) * 1.0001
    assert less.enough_for(target) == less.counts[12]
    assert less.enough_for(float(less.nrmse[0]) * 0.99) is None
    kept = 40 - less.n_redundant
    at_kept = less.nrmse[less.counts == kept][0]
    at_next = less.nrmse[less.counts == kept - 1][0]
    assert at_kept <= SAME_ERROR * less.nrmse[0] < at_next
    np.testing.assert_array_equal(less.redundant, less.removed[: less.n_redundant])


def test_detail_too_fine_for_any_number_of_samples_stays_in_the_error(ball, places) -> None:
    found = reconstructed(ball, places)
    bare = redundancy(found, ball.accessible_areas)
    detailed = redundancy(found, ball.accessible_areas, detail=3.0)
    assert detailed.nrmse[0] == pytest.approx(
        replace(found, hyperparameters=replace(HYPER, noise=3.0)).predicted_nrmse_with_detail(),
        rel=1e-9,
    )
    assert detailed.n_redundant >= bare.n_redundant


def test_of_two_samples_in_one_place_only_one_goes_at_a_time(ball) -> None:
    """Each twin is needless as long as the other is there; without both the place is lost."""
    first = np.random.default_rng(6).choice(ball.mesh.n_vertices, 150, replace=False)
    sites = Sites(
        np.repeat(Sites.at_vertices(first).corners, 2, axis=0),
        np.repeat(Sites.at_vertices(first).weights, 2, axis=0),
    )
    values = sites.of(ball.mesh.vertices[:, 0])
    less = redundancy(GaussianProcess(ball, sites).given(values, HYPER), ball.accessible_areas)
    at_once = less.removed[: int(less.counts[0] - less.counts[1])] // 2
    assert len(set(at_once.tolist())) == len(at_once) == 3
