"""Areas below a threshold on maps where they are known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from auricle.study.low_voltage import MappedRegion, low_voltage
from auricle.surface.shapes import icosphere

BALL = icosphere(radius=10.0, subdivisions=3)
AREAS = np.bincount(BALL.faces.reshape(-1), np.repeat(BALL.face_areas / 3, 3))
HEIGHT = BALL.vertices[:, 2] / 10.0
EVERYWHERE = MappedRegion(np.ones(BALL.n_vertices, dtype=bool), AREAS)


def test_a_cap_of_low_voltage_has_the_area_of_the_cap() -> None:
    """Voltage rises with height; below 0.5 lies what is lower than 0: half of the sphere."""
    voltage = 0.5 + HEIGHT - 1e-9
    found = low_voltage(EVERYWHERE, voltage, voltage[None], voltage)
    assert found.of_map_mm2 == pytest.approx(2 * np.pi * 100, rel=0.06)
    assert found.low_mm2 == found.expected_mm2 == found.high_mm2 == found.of_map_mm2
    assert found.share_of_points == pytest.approx(0.5, abs=0.06)
    assert np.isnan(found.vendor_mm2)


@given(st.floats(-1, 1), st.floats(-1, 1))
def test_a_higher_threshold_never_finds_less(one, other) -> None:
    low, high = sorted((one, other))
    assert EVERYWHERE.below(HEIGHT, low) <= EVERYWHERE.below(HEIGHT, high)


def test_what_was_not_mapped_and_what_the_vendor_left_out_is_not_low() -> None:
    region = MappedRegion(HEIGHT > 0, AREAS)
    voltage = np.zeros(BALL.n_vertices)
    vendor = np.where(HEIGHT > 0.5, 0.1, np.nan)
    found = low_voltage(region, voltage, voltage[None], np.array([0.0]), vendor=vendor)
    assert found.of_map_mm2 == pytest.approx(found.mapped_mm2)
    assert found.mapped_mm2 == pytest.approx(AREAS[HEIGHT > 0].sum())
    assert found.vendor_mm2 == pytest.approx(AREAS[HEIGHT > 0.5].sum())
    assert found.vendor_mapped_mm2 == pytest.approx(found.vendor_mm2)


def test_the_expected_area_is_the_mean_and_one_in_twenty_lies_beyond_either_end() -> None:
    """Of maps that are low on 1, 2, … 100 vertices of one area each."""
    region = MappedRegion(np.ones(100, dtype=bool), np.ones(100))
    draws = np.where(np.tri(100, dtype=bool), 0.1, 0.9)
    found = low_voltage(region, draws[0], draws, draws[0])
    assert found.expected_mm2 == pytest.approx(50.5)
    assert found.low_mm2 == pytest.approx(1 + 0.05 * 99)
    assert found.high_mm2 == pytest.approx(1 + 0.95 * 99)
