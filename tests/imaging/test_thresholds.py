import numpy as np
import pytest

from auricle.imaging.thresholds import region_thresholds
from auricle.imaging.verdict import SegmentationError


def region(rng, *, wall=105.0, right=170.0, blood=400.0, noise=10.0):
    means = np.repeat([-850.0, -90.0, wall, right, blood], [4000, 1000, 3000, 4000, 2000])
    return means + rng.normal(0.0, noise, means.shape)


def test_the_surface_lies_half_way_between_wall_and_blood(rng):
    values = region(rng)
    found = region_thresholds(values, values[-2000:])
    assert found.blood == pytest.approx(400.0, abs=1.5)
    assert found.wall == pytest.approx(105.0, abs=6.0)
    assert found.lower == pytest.approx(0.5 * (found.wall + found.blood))
    assert found.noise == pytest.approx(10.0, rel=0.1)
    assert found.lower < found.growing < found.blood < found.upper


def test_weakly_contrasted_blood_of_the_right_heart_is_not_taken_for_wall(rng):
    values = region(rng, right=160.0, blood=220.0)
    assert region_thresholds(values, values[-2000:]).wall == pytest.approx(105.0, abs=6.0)


@pytest.mark.parametrize(("wall", "expected"), [(45.0, 90.0), (120.0, 120.0)])
def test_the_wall_is_not_taken_softer_than_atrial_wall_is(rng, wall, expected):
    values = region(rng, wall=wall)
    assert region_thresholds(values, values[-2000:]).wall == pytest.approx(expected, abs=6.0)


def test_blood_without_contrast_is_refused_with_its_code(rng):
    values = region(rng, blood=45.0)
    with pytest.raises(SegmentationError) as refusal:
        region_thresholds(values, values[-2000:])
    assert refusal.value.code == "no_contrast"
    assert refusal.value.remedy in str(refusal.value)


def test_contrast_within_the_noise_is_refused_with_its_code(rng):
    values = region(rng, blood=230.0, noise=60.0)
    with pytest.raises(SegmentationError) as refusal:
        region_thresholds(values, values[-2000:])
    assert refusal.value.code == "low_contrast"
