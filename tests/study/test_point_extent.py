"""Extents of points that are known."""

import numpy as np
import pytest

from auricle.study.point_extent import point_extent
from auricle.surface.shapes import icosphere


def test_points_on_a_sphere_have_its_area_and_its_density() -> None:
    found = point_extent(icosphere(radius=20.0, subdivisions=4).vertices)
    assert found.hull_area_mm2 == pytest.approx(4 * np.pi * 400, rel=0.01)
    assert found.per_cm2_of_hull == pytest.approx(2562 / (4 * np.pi * 4), rel=0.01)
    assert max(found.sides_mm) == pytest.approx(40.0, abs=0.1)


def test_points_in_one_place_count_once() -> None:
    found = point_extent(np.array([[0.0, 0, 0], [0, 0, 0], [3, 4, 0]]))
    assert (found.n_places, found.spacing_mm, found.largest_gap_mm) == (2, 5.0, 5.0)


def test_what_has_no_hull_or_no_neighbour_says_so() -> None:
    flat = np.random.default_rng(1).random((9, 3)) * [1, 1, 0]
    assert np.isnan(point_extent(flat).hull_area_mm2)
    alone = point_extent(np.ones((1, 3)))
    assert np.isnan(alone.spacing_mm)
    assert np.isnan(alone.hull_area_mm2)
    assert point_extent(np.empty((0, 3))) is None
