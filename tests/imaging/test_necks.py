import numpy as np
import pytest

from auricle.errors import ImageError
from auricle.imaging.necks import Basins, distance_basins, owners, wall_distance, widest_ways

X, Y, Z = np.indices((64, 34, 34))
AXIS = np.hypot(Y - 17, Z - 17)


def ball(x, radius):
    return (X - x) ** 2 + (Y - 17) ** 2 + (Z - 17) ** 2 <= radius**2


def dumb_bell(neck):
    """Balls of radius 14 and 10 at x = 16 and 48, a tube between."""
    return ball(16, 14) | ball(48, 10) | ((neck >= AXIS) & (X > 16) & (X < 48))


@pytest.mark.parametrize("neck", [3, 5, 7])
def test_the_neck_of_a_dumb_bell_has_the_radius_of_its_tube(neck):
    found = distance_basins(dumb_bell(neck), step=1.0, depth=1.0)
    chambers = [int(found.labels[x, 17, 17]) - 1 for x in (16, 48)]
    np.testing.assert_allclose(found.peaks[chambers], [14.0, 10.0], atol=1.0)
    way, _ = widest_ways(found, chambers[0])
    assert way[chambers[1]] == pytest.approx(neck, abs=1.0)
    assert way[chambers[0]] == found.peaks[chambers[0]]


def test_the_step_scales_radii_and_the_labels_cover_the_region():
    region = dumb_bell(5)
    fine, coarse = distance_basins(region, step=1.0), distance_basins(region, step=2.0, depth=1.0)
    np.testing.assert_array_equal(fine.labels > 0, region)
    np.testing.assert_array_equal(fine.labels, coarse.labels)
    np.testing.assert_allclose(coarse.peaks, 2.0 * fine.peaks)
    assert fine.n_voxels.sum() == region.sum()


def test_a_dent_shallower_than_the_depth_parts_nothing():
    region = ball(24, 14) | ball(34, 14)
    assert len(distance_basins(region, step=1.0, depth=0.1).peaks) == 2
    assert len(distance_basins(region, step=1.0, depth=3.0).peaks) == 1


def test_the_distance_to_the_wall_of_a_slab_is_its_half_thickness():
    slab = np.zeros((20, 40, 40), dtype=bool)
    slab[5:14] = True
    assert wall_distance(slab, step=0.5)[9, 20, 20] == pytest.approx(2.25)
    assert wall_distance(slab, step=0.5)[0, 0, 0] == 0.0


def test_what_lies_beyond_the_lattice_is_wall():
    everything = np.ones((9, 30, 30), dtype=bool)
    assert wall_distance(everything, step=1.0).max() == pytest.approx(4.5)


def basins(peaks, pairs, necks):
    n = len(peaks)
    return Basins(
        np.zeros((1, 1, 1), np.int32),
        np.array(peaks, float),
        np.zeros((n, 3), int),
        np.ones(n, int),
        np.array(pairs).reshape(-1, 2),
        np.array(necks, float),
    )


def test_a_vessel_belongs_to_the_chamber_it_opens_into_most_widely():
    vessel_between = basins([20, 4, 4, 15], [[0, 1], [1, 2], [2, 3]], [3.0, 1.0, 2.0])
    assert owners(vessel_between, [0, 3]).tolist() == [0, 0, 3, 3]


def test_what_no_chamber_reaches_belongs_to_none():
    apart = basins([20, 4, 4], [[0, 1]], [3.0])
    assert owners(apart, [0]).tolist() == [0, 0, -1]
    assert [ways.tolist() for ways in widest_ways(apart, 0)] == [[20.0, 3.0, 0.0], [-1, 1, -1]]


def test_the_widest_way_may_be_a_detour():
    ring = basins([9, 9, 9], [[0, 1], [1, 2], [0, 2]], [5.0, 4.0, 1.0])
    width, limb = widest_ways(ring, 0)
    assert (width.tolist(), limb.tolist()) == ([9.0, 5.0, 4.0], [-1, 1, 1])


def test_an_empty_region_is_refused():
    with pytest.raises(ImageError, match="empty"):
        distance_basins(np.zeros((4, 4, 4), bool), step=1.0)
