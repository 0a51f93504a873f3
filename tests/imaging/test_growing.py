import numpy as np
import pytest

from auricle.errors import ImageError
from auricle.imaging.growing import grown_region, pieces_by_size, spread_labels


def test_growth_stops_at_both_thresholds_and_does_not_cross_corners():
    values = np.zeros((6, 5, 4))
    values[1:3, 1:3, 1:3] = 300.0
    values[3, 3, 3] = 300.0  # touches in a corner only
    values[1:3, 3, 1] = 700.0
    region = grown_region(values, (1, 1, 1), lower=200.0, upper=600.0)
    assert region.sum() == 8
    assert grown_region(values, (1, 1, 1), lower=200.0).sum() == 10


def test_every_voxel_of_a_region_grows_the_same_region(rng):
    values = rng.normal(size=(8, 8, 8))
    first = grown_region(values, tuple(np.unravel_index(values.argmax(), (8, 8, 8))), lower=0.2)
    for seed in np.argwhere(first)[::17]:
        np.testing.assert_array_equal(grown_region(values, tuple(seed), lower=0.2), first)


def test_a_seed_outside_the_lattice_or_the_thresholds_is_refused():
    values = np.zeros((4, 4, 4))
    with pytest.raises(ImageError, match="outside the lattice"):
        grown_region(values, (4, 0, 0), lower=-1.0)
    with pytest.raises(ImageError, match="put the seed into blood"):
        grown_region(values, (0, 0, 0), lower=1.0)


def test_pieces_are_ranked_by_size_and_small_ones_left_out():
    region = np.zeros((12, 3, 3), dtype=bool)
    region[0, 0, :1] = region[2:5, 0, 0] = region[6:11, 0, 0] = True
    labels, sizes = pieces_by_size(region, smallest=2)
    assert sizes.tolist() == [5, 3]
    assert (labels[7, 0, 0], labels[3, 0, 0], labels[0, 0, 0]) == (1, 2, 0)
    assert pieces_by_size(np.zeros((2, 2, 2), bool))[1].tolist() == []


def test_labels_spread_to_the_nearest_and_no_further_than_their_reach():
    labels = np.zeros((12, 2, 2), dtype=np.int8)
    labels[0], labels[9] = 1, 2
    spread = spread_labels(labels, np.ones(labels.shape, bool), reach=3.0, step=1.0)
    assert spread[:, 0, 0].tolist() == [1, 1, 1, 1, 0, 0, 2, 2, 2, 2, 2, 2]
    half = spread_labels(labels, np.ones(labels.shape, bool), reach=3.0, step=2.0)
    assert half[:3, 0, 0].tolist() == [1, 1, 0]
