import numpy as np

from auricle.sampling.random_design import random_sampling
from auricle.sampling.sites import Sites


def test_a_shorter_draw_is_the_beginning_of_a_longer_one(atrium_chamber):
    longer = random_sampling(atrium_chamber, 60, rng=np.random.default_rng(3))
    shorter = random_sampling(atrium_chamber, 20, rng=np.random.default_rng(3))
    np.testing.assert_array_equal(shorter, longer[:20])
    assert len(np.unique(longer)) == 60


def test_vertices_are_drawn_in_proportion_to_their_area(atrium_chamber, rng):
    areas = atrium_chamber.basis.areas
    large = areas > np.median(areas)
    draws = np.concatenate([random_sampling(atrium_chamber, 50, rng=rng) for _ in range(200)])
    expected = areas[large].sum() / areas.sum()
    deviation = np.sqrt(expected * (1 - expected) / len(draws))
    assert abs(large[draws].mean() - expected) < 4 * deviation
    assert abs(large.mean() - expected) > 10 * deviation  # vertices alone would be told apart


def test_points_are_accessible_allowed_and_new(open_chamber, rng):
    allowed = open_chamber.mesh.vertices[:, 0] > 0
    free = allowed & open_chamber.accessible
    existing = Sites.at_vertices(np.flatnonzero(free)[::2])
    count = int(free.sum()) - len(existing)
    points = random_sampling(open_chamber, count, rng=rng, allowed=allowed, existing=existing)
    assert sorted(points) == sorted(np.flatnonzero(free)[1::2])
