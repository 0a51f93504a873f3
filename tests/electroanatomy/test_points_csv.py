"""Points from text tables whose columns the user names."""

from pathlib import Path

import numpy as np
import pytest

from auricle.electroanatomy.points import UNITS as QUANTITIES
from auricle.electroanatomy.points import MappingPoints, no_points
from auricle.electroanatomy.points_csv import PointTable, read_points_csv
from auricle.electroanatomy.points_writing import write_points_csv
from auricle.errors import FormatError, InputError

XYZ = ("x", "y", "z")
UNITS = {"position": "mm", "local_activation_time": "ms"}
TIMES = {"local_activation_time": "t"}


def written(folder: Path, text: str, encoding: str = "utf-8") -> Path:
    path = folder / "points.csv"
    path.write_bytes(text.encode(encoding))
    return path


def test_real_points_come_back_as_awk_counts_and_sums_them(real_data) -> None:
    path = real_data / "maps" / "points-csv" / "epPoints.csv"
    table = PointTable(
        ("X", "Y", "Z"),
        units={**UNITS, "bipolar_voltage": "mV"},
        values={"local_activation_time": "LAT", "bipolar_voltage": "Volt"},
    )
    one = read_points_csv(path, table)
    assert one.surface is None
    assert len(one.points) == 152
    np.testing.assert_array_equal(one.points.positions[0], [-15.9375, -29.8125, 11.2656])
    rows = [line.split(",") for line in path.read_text().splitlines()[1:]]
    times = sum(float(row[6]) for row in rows)
    assert one.points.local_activation_time.sum() == pytest.approx(times, rel=1e-12)
    assert one.points.bipolar_voltage.sum() == pytest.approx(sum(float(row[10]) for row in rows))
    assert one.space == "unknown"


def test_units_are_turned_into_mm_ms_and_mv(tmp_path) -> None:
    path = written(tmp_path, "x,y,z,t,v\n1,2,3,0.25,250\n")
    table = PointTable(
        XYZ,
        units={"position": "cm", "local_activation_time": "s", "bipolar_voltage": "uV"},
        values={**TIMES, "bipolar_voltage": "v"},
    )
    points = read_points_csv(path, table).points
    assert points.positions.tolist() == [[10.0, 20.0, 30.0]]
    assert points.local_activation_time.tolist() == [250.0]
    assert points.bipolar_voltage.tolist() == [0.25]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_decimal_commas_and_encodings_are_read_when_stated(encoding, tmp_path) -> None:
    path = written(tmp_path, "x;y;z;größe\n1,5;-2,25;3;4\n", encoding)
    table = PointTable(
        XYZ, units=UNITS, values={"local_activation_time": "größe"},
        delimiter=";", decimal=",", encoding=encoding,
    )  # fmt: skip
    assert read_points_csv(path, table).points.positions.tolist() == [[1.5, -2.25, 3.0]]


def test_missing_values_are_nan_and_rows_without_a_place_counted(tmp_path) -> None:
    path = written(tmp_path, "x,y,z,t\n1,2,3,-10000\n1,2,3,\n,2,3,5\n4,5,6,7\n")
    one = read_points_csv(path, PointTable(XYZ, units=UNITS, values=TIMES, missing=-10000.0))
    np.testing.assert_array_equal(one.points.local_activation_time, [np.nan, np.nan, 7.0])
    assert one.points.identifiers.tolist() == [1, 2, 4]
    assert one.remarks == ("points without a position left out: 1",)


@pytest.mark.parametrize(
    ("text", "options", "cause"),
    [
        ("x,y,z,t\n1,5,2,3,4\n", {}, "delimiter"),
        ("x;y;z;t\n1,5;2;3;4\n", {"delimiter": ";"}, "decimal mark"),
        ("x,y,z\n1,2,3\n", {}, "0 columns of the name 't'"),
        ("x,y,z,t,t\n1,2,3,4,5\n", {}, "2 columns"),
        ("x,y,z,t\n1,2,3,4\n", {"encoding": "utf-7x"}, "encoding"),
        ("x,y,z,t\n1,2,3,early\n", {}, "not a number"),
        ("x,y,z,t\n1,2,3,inf\n", {}, "infinite number in column 't'"),
        ("", {}, "empty"),
        ("\n\n", {}, "column names"),
        ("1.000,5;2;3;4", {"delimiter": ";", "decimal": ","}, "name 'x'"),
        ("x;y;z;t\n1.000,5;2;3;4", {"delimiter": ";", "decimal": ","}, "not a number"),
    ],
)
def test_tables_that_are_written_otherwise_are_refused(text, options, cause, tmp_path) -> None:
    path = written(tmp_path, text)
    with pytest.raises(FormatError, match=cause) as caught:
        read_points_csv(path, PointTable(XYZ, units=UNITS, values=TIMES, **options))
    assert str(caught.value).startswith(str(path))


def test_text_in_another_encoding_is_refused(tmp_path) -> None:
    path = written(tmp_path, "x,y,z,größe\n1,2,3,4\n", "cp1252")
    with pytest.raises(FormatError, match="state its encoding"):
        read_points_csv(path, PointTable(XYZ, units=UNITS))


def test_no_unit_is_guessed() -> None:
    with pytest.raises(InputError, match="state one of mm, cm, m, um"):
        PointTable(XYZ, units={})
    with pytest.raises(InputError, match="unit of local_activation_time is None"):
        PointTable(XYZ, units={"position": "mm"}, values=TIMES)
    with pytest.raises(InputError, match="unknown"):
        PointTable(XYZ, units={"position": "mm"}, values={"temperature": "T"})
    with pytest.raises(InputError, match="decimal"):
        PointTable(XYZ, units={"position": "mm"}, decimal=",")


def test_a_written_table_comes_back_to_the_last_digit(one_map, tmp_path) -> None:
    write_points_csv(tmp_path / "points.csv", one_map.points)
    table = PointTable(
        ("x_mm", "y_mm", "z_mm"),
        units={**QUANTITIES, "position": "mm"},
        values={name: f"{name}_{unit}" for name, unit in QUANTITIES.items()},
        projected_position=("projected_x_mm", "projected_y_mm", "projected_z_mm"),
    )
    back = read_points_csv(tmp_path / "points.csv", table).points
    for name in ("positions", "projected_positions", *QUANTITIES):
        np.testing.assert_array_equal(getattr(back, name), getattr(one_map.points, name))


def test_an_empty_table_and_missing_values_are_written(tmp_path) -> None:
    write_points_csv(tmp_path / "none.csv", no_points())
    assert (tmp_path / "none.csv").read_text().count("\n") == 1
    some = MappingPoints(np.zeros((2, 3)), force=np.array([np.nan, 4.0]))
    write_points_csv(tmp_path / "some.csv", some)
    lines = (tmp_path / "some.csv").read_text().splitlines()
    assert lines[1:] == ["1,1,0.0,0.0,0.0,,,,", "2,1,0.0,0.0,0.0,,,,4.0"]
