"""What is missed without the neighbours: whom that is, and that the closed form is a refit."""

import numpy as np
import pytest

from auricle.arrays import Floats
from auricle.sampling.chamber import Chamber
from auricle.sampling.farthest_point import farthest_point_sampling
from auricle.sampling.neighbourhoods import (
    MOST_TOGETHER,
    left_out_together,
    neighbourhoods,
)
from auricle.sampling.posterior import Posterior
from auricle.sampling.sites import Sites
from auricle.sampling.splines import Spline


def clusters(chamber: Chamber, count: int) -> Sites:
    """A cluster of so many samples at either end of a sphere, and three lone ones between."""
    vertices = chamber.mesh.vertices
    ends = [np.argsort(end * vertices[:, 0])[:count] for end in (1, -1)]
    angles = np.array([0.0, 2.0, 4.0])
    between = 30 * np.column_stack([0 * angles, np.cos(angles), np.sin(angles)])
    away = np.linalg.norm(vertices[:, None] - between, axis=2)
    return Sites.at_vertices(np.concatenate([*ends, away.argmin(axis=0)]))


def smooth(chamber: Chamber) -> Floats:
    x, y, z = chamber.mesh.vertices.T / 30
    return np.column_stack([np.sin(3 * x) + y * z, np.cos(2 * y)])


def test_samples_spread_evenly_are_left_out_alone(fine_chamber: Chamber) -> None:
    for count in (2, 12, 100):
        sites = Sites.at_vertices(farthest_point_sampling(fine_chamber, count))
        found = neighbourhoods(fine_chamber, sites)
        assert [each.tolist() for each in found] == [[index] for index in range(count)]


def test_of_clusters_those_near_are_left_out_together_and_lone_samples_alone(
    fine_chamber: Chamber,
) -> None:
    sites = clusters(fine_chamber, 8)
    found = neighbourhoods(fine_chamber, sites)
    positions = sites.positions(fine_chamber.mesh)
    away = np.linalg.norm(fine_chamber.mesh.vertices[:, None] - positions, axis=2).min(axis=1)
    reach = fine_chamber.mean(away)
    for index, some in enumerate(found[:16]):
        assert some[0] == index
        within = np.linalg.norm(positions - positions[index], axis=1) <= reach
        assert set(some.tolist()) == set(np.flatnonzero(within).tolist())
        assert len(some) == 8
    assert [each.tolist() for each in found[16:]] == [[16], [17], [18]]


def test_no_more_than_half_and_no_more_than_the_most_go_together(fine_chamber: Chamber) -> None:
    vertices = fine_chamber.mesh.vertices
    order = np.argsort(np.linalg.norm(vertices - vertices[7], axis=1))
    for count, most in ((1, 1), (3, 1), (11, 5), (150, MOST_TOGETHER)):
        found = neighbourhoods(fine_chamber, Sites.at_vertices(order[:count]))
        assert [len(each) for each in found] == [most] * count
    same = neighbourhoods(fine_chamber, Sites.at_vertices(np.full(9, 5)))
    assert [each[0] for each in same] == list(range(9))
    assert all(len(set(each.tolist())) == len(each) for each in same)


def test_how_far_samples_are_is_a_mean_over_the_area_that_can_be_sampled(
    fine_chamber: Chamber,
) -> None:
    """Of the sphere's near half and of all of it: in the half two samples are not so far."""
    vertices = fine_chamber.mesh.vertices
    away = np.linalg.norm(vertices - vertices[0], axis=1)
    near = Chamber(fine_chamber.mesh, fine_chamber.basis, np.asarray(away < 20))
    pairs = Sites.at_vertices([0, int(np.abs(away - 13).argmin()), *np.argsort(-away)[:2]])
    assert [len(each) for each in neighbourhoods(fine_chamber, pairs)] == [2, 2, 2, 2]
    assert [len(each) for each in neighbourhoods(near, pairs)[:2]] == [1, 1]


@pytest.mark.parametrize("power", [0.6, 1.8])
def test_a_spline_misses_what_a_refit_without_them_does(
    fine_chamber: Chamber, power: float
) -> None:
    sites = clusters(fine_chamber, 8)
    values, together = sites.of(smooth(fine_chamber)), neighbourhoods(fine_chamber, sites)
    shape = np.linspace(0.5, 1.5, len(sites))
    precision = Spline(fine_chamber, sites, power, shape).precision(0.01)
    found = left_out_together(precision, values, together)
    for out in (0, 9, 17):
        kept = np.setdiff1d(np.arange(len(sites)), together[out])
        refit = Spline(fine_chamber, sites[kept], power, shape[kept]).mean(values[kept], 0.01)
        missed = values[out] - sites[[out]].of(refit)[0]
        assert found[out] == pytest.approx(missed, abs=1e-8)


def test_the_process_misses_what_a_refit_without_them_does(fine_chamber: Chamber) -> None:
    sites = clusters(fine_chamber, 8)
    values, together = sites.of(smooth(fine_chamber)), neighbourhoods(fine_chamber, sites)
    modes, prior = fine_chamber.basis.modes[:, :100], np.geomspace(50.0, 0.5, 100)
    noise = np.linspace(0.01, 0.02, len(sites))
    posterior = Posterior.of(sites.of(modes), prior, noise)
    found = left_out_together(posterior.precision, values, together)
    for out in (3, 12, 18):
        kept = np.setdiff1d(np.arange(len(sites)), together[out])
        refit = Posterior.of(sites[kept].of(modes), prior, noise[kept])
        missed = values[out] - (sites[[out]].of(modes) @ (refit.operator @ values[kept]))[0]
        assert found[out] == pytest.approx(missed, abs=1e-8)
