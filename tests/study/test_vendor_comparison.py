"""Two maps whose difference is known."""

import numpy as np
import pytest

from auricle.sampling.sites import Sites
from auricle.study.vendor_comparison import MapOnSurface, vendor_comparison

N = 50
MEAN = np.linspace(0.0, 100.0, N)
AREAS = np.ones(N)
EVERYWHERE = np.ones(N, dtype=bool)
SITES = Sites.at_vertices([0, 10, 20])


def compared(vendor, std=1.0, cycle_length=None, mapped=EVERYWHERE, samples=None):
    ours = MapOnSurface(MEAN, np.full(N, std), cycle_length)
    values = MEAN[[0, 10, 20]] if samples is None else samples
    return vendor_comparison(ours, vendor, AREAS, mapped, SITES, values)


def test_the_same_map_differs_by_nothing() -> None:
    found = compared(MEAN)
    assert found.rms_difference == found.beyond_share == found.vendor_at_points == 0
    assert found.coloured_share == 1


def test_a_shift_is_its_own_root_mean_square_and_is_beyond_where_it_exceeds_two_deviations() -> (
    None
):
    assert compared(MEAN + 3.0).rms_difference == pytest.approx(3.0)
    assert compared(MEAN + 3.0).beyond_share == pytest.approx(1.0)
    assert compared(MEAN + 3.0, std=1.6).beyond_share == 0
    assert compared(MEAN + 3.0).relative == pytest.approx(3.0 / MEAN.std())


def test_a_whole_cycle_is_no_difference() -> None:
    assert compared(MEAN + 200.0, cycle_length=200.0).rms_difference == pytest.approx(0, abs=1e-9)


def test_only_what_is_coloured_and_mapped_is_compared() -> None:
    vendor = np.where(np.arange(N) < 25, MEAN, np.nan)
    vendor[0] = 1e6
    mapped = np.arange(N) > 0
    found = compared(vendor, mapped=mapped)
    assert found.rms_difference == 0
    assert found.coloured_share == pytest.approx(0.5)
    assert compared(np.full(N, np.nan)) is None
    assert compared(vendor, mapped=np.arange(N) > 30) is None


def test_each_map_is_held_against_the_samples() -> None:
    found = compared(MEAN - 2.0, samples=MEAN[[0, 10, 20]] + 1.0)
    assert found.vendor_at_points == pytest.approx(3.0)
    assert found.map_at_points == pytest.approx(1.0)
