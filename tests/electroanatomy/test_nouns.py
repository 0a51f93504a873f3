"""Mapping points, electrograms, maps and their names."""

import math

import numpy as np
import pytest

from auricle.electroanatomy.electrogram import Electrogram
from auricle.electroanatomy.naming import channel_names, map_name
from auricle.electroanatomy.points import MappingPoints, no_points
from auricle.electroanatomy.study import ElectroanatomicMap
from auricle.errors import InputError


def test_columns_are_copied_and_frozen() -> None:
    positions = np.zeros((2, 3))
    points = MappingPoints(positions)
    positions[0] = 7.0
    assert points.positions[0, 0] == 0.0
    for column in (points.positions, points.force, points.included):
        with pytest.raises(ValueError, match="read-only"):
            column[0] = 1


@pytest.mark.parametrize(
    ("columns", "cause"),
    [
        ({"positions": np.zeros((2, 2))}, "n, 3"),
        ({"positions": np.full((2, 3), np.nan)}, "not|NaN"),
        ({"force": np.zeros(3)}, "force has shape"),
        ({"impedance": np.array([1.0, np.inf])}, "infinite"),
        ({"projected_positions": np.zeros((1, 3))}, "projected_positions"),
    ],
)
def test_columns_that_do_not_fit_are_refused(columns, cause) -> None:
    with pytest.raises(InputError, match=cause):
        MappingPoints(**{"positions": np.zeros((2, 3)), **columns})


def test_a_table_tells_what_it_holds_and_can_be_cut(one_map) -> None:
    points = one_map.points
    assert set(points.recorded) == {
        "local_activation_time", "bipolar_voltage", "unipolar_voltage", "impedance", "force",
    }  # fmt: skip
    some = points.chosen(np.array([4, 2]))
    assert some.identifiers.tolist() == [5, 3]
    np.testing.assert_array_equal(some.force, points.force[[4, 2]])
    assert len(no_points()) == 0
    assert no_points().recorded == ()


def test_electrograms_that_contradict_themselves_are_refused() -> None:
    with pytest.raises(InputError, match="one column a channel"):
        Electrogram(np.zeros((5, 2)), 1000.0, ("a",))
    with pytest.raises(InputError, match="positive"):
        Electrogram(np.zeros((5, 1)), 0.0, ("a",))
    with pytest.raises(InputError, match="not there"):
        Electrogram(np.zeros((5, 1)), 1000.0, ("a",), bipolar="b")
    with pytest.raises(InputError, match="no channel"):
        Electrogram(np.zeros((5, 1)), 1000.0, ("a",)).channel("b")


def test_the_window_is_counted_from_the_reference_and_cut_to_the_recording() -> None:
    def window(first: float, last: float) -> slice:
        return Electrogram(
            np.zeros((100, 1)),
            500.0,
            ("a",),
            reference_annotation=50.0,
            window_of_interest=(first, last),
        ).window

    assert window(-20.0, 40.0) == slice(40, 71)
    assert window(-900.0, 900.0) == slice(0, 100)
    assert window(math.nan, math.nan) == slice(0, 100)
    with pytest.raises(InputError, match="outside"):
        window(500.0, 600.0)


def test_an_electrogram_belongs_to_a_point() -> None:
    signal = Electrogram(np.zeros((5, 1)), 1000.0, ("a",))
    with pytest.raises(InputError, match="none of 0 points"):
        ElectroanatomicMap("map 1", electrograms={0: signal})


@pytest.mark.parametrize("name", ["1-Map", "2-1-ReMap", "LA", "LA endo SR", "RA_post ablation 2"])
def test_names_of_chambers_and_vendors_are_kept(name) -> None:
    assert map_name(name, 4) == (name, True)


@pytest.mark.parametrize(
    "name", ["LA Smith", "LA 14.03.1961", "", "1961-03-14", "Dr. No", "x" * 99]
)
def test_other_names_become_numbers(name) -> None:
    assert map_name(name, 4) == ("map 4", False)


def test_channels_keep_electrodes_names_and_differ() -> None:
    names = channel_names(["CS 1-2", "aVR", "A1", "A1", "", "Ünser Kanal"])
    assert names == ("CS 1-2", "aVR", "A1", "channel 4", "channel 5", "channel 6")
