import numpy as np
import pytest

from auricle.errors import InputError
from auricle.imaging.region_of_interest import BoxRegion, PolygonRegion

TRIANGLE = np.array([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0]])


def test_the_prism_holds_as_much_as_area_times_height(rng):
    prism = PolygonRegion(TRIANGLE, depth=3.0)
    points = rng.uniform([-2, -2, -5], [12, 12, 5], (40_000, 3))
    share = prism.contains(points).mean()
    assert share == pytest.approx(50.0 * 6.0 / (14 * 14 * 10), rel=0.04)


def test_a_turned_polygon_holds_the_turned_points(rng):
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    points = rng.uniform(-2, 12, (500, 3))
    here = PolygonRegion(TRIANGLE, depth=3.0).contains(points)
    there = PolygonRegion(TRIANGLE @ turn.T + 50.0, depth=3.0).contains(points @ turn.T + 50.0)
    np.testing.assert_array_equal(here, there)
    assert 0 < here.sum() < 500


def test_the_bounds_hold_the_prism_and_no_more(rng):
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    prism = PolygonRegion(TRIANGLE @ turn.T, depth=3.0)
    low, high = prism.bounds
    points = rng.uniform(-20, 20, (60_000, 3))
    inside = points[prism.contains(points)]
    assert (inside > low - 1e-9).all()
    assert (inside < high + 1e-9).all()
    np.testing.assert_allclose(inside.max(axis=0), high, atol=1.0)


def test_a_star_that_crosses_itself_is_read_by_the_even_odd_rule():
    angles = np.pi / 2 + 4 * np.pi / 5 * np.arange(5)
    star = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(5)]) * 10
    inside = PolygonRegion(star, depth=1.0).contains(np.array([[0.0, 0, 0], [0, 7.0, 0]]))
    assert inside.tolist() == [False, True]


@pytest.mark.parametrize(
    ("corners", "depth", "cause"),
    [
        (TRIANGLE[:2], 1.0, "three corners"),
        (TRIANGLE * [1, 0, 0], 1.0, "in a line"),
        (np.vstack([TRIANGLE, [5.0, 5.0, 9.0]]), 1.0, "in a plane"),
        (TRIANGLE, 0.0, "no depth"),
        (TRIANGLE * np.nan, 1.0, "infinite"),
    ],
)
def test_polygons_without_an_inside_are_refused(corners, depth, cause):
    with pytest.raises(InputError, match=cause):
        PolygonRegion(corners, depth)


@pytest.mark.parametrize("high", [[1, 1, 0], [1, 1, np.inf], [1, 1]])
def test_boxes_without_an_inside_are_refused(high):
    with pytest.raises(InputError):
        BoxRegion([0, 0, 0], high)
