"""Studies analysed whose truth is known."""

from dataclasses import replace

import numpy as np
import pytest

from auricle.electroanatomy.points import MappingPoints
from auricle.electroanatomy.study import ElectroanatomicMap, ElectroanatomicStudy
from auricle.errors import InputError
from auricle.study.exports import export_source, is_export, read_export
from auricle.study.map_analysis import analyze_export, analyze_study, used_positions
from auricle.study.map_study import MapStudy, MapStudyConfig
from auricle.study.map_study_store import map_study_document, points_csv
from auricle.study.result import Source
from auricle.study.store import json_text
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere
from auricle.surface.soup import TriangleSoup

BALL = icosphere(radius=30.0, subdivisions=3)
SURFACE = Mesh(BALL.vertices * [1.0, 0.9, 0.8], BALL.faces)
SOURCE = Source("an export", 1, "0" * 64)
CONFIG = MapStudyConfig(n_modes=80, n_draws=40)
TIMES = (SURFACE.vertices[:, 0] + 30.0) / 0.6
VOLTAGE = 1.0 + SURFACE.vertices[:, 2] / 40.0 + 0.3 * np.sin(SURFACE.vertices[:, 0] / 6.0)


NOISE = np.random.default_rng(9).normal(0.0, 0.1, SURFACE.n_vertices)


def a_map(rows: np.ndarray, *, vendor: bool = True, **columns) -> ElectroanatomicMap:
    fields = {"local_activation_time": TIMES, "bipolar_voltage": VOLTAGE} if vendor else {}
    points = MappingPoints(
        SURFACE.vertices[rows] * 1.05,
        SURFACE.vertices[rows],
        **{
            "local_activation_time": TIMES[rows],
            "bipolar_voltage": (VOLTAGE + NOISE)[rows],
            **columns,
        },
    )
    soup = TriangleSoup(SURFACE.vertices, SURFACE.faces, point_fields=fields)
    return ElectroanatomicMap("LA map", soup, points)


def analyzed(*maps: ElectroanatomicMap, config: MapStudyConfig = CONFIG) -> MapStudy:
    return analyze_study(ElectroanatomicStudy("test", maps), config, source=SOURCE)


def rows(count: int, seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).choice(SURFACE.n_vertices, count, replace=False)


@pytest.fixture(scope="module")
def study() -> MapStudy:
    """A well sampled map, one of the same chamber sampled on one side only, one of two points."""
    half = rows(200)
    half = half[SURFACE.vertices[half, 0] > 5.0]
    return analyzed(a_map(rows(150)), a_map(half), a_map(rows(2)))


def test_a_smooth_map_sampled_everywhere_is_enough_and_most_of_its_points_are_redundant(study):
    time, voltage = study.maps[0].fields
    assert (time.name, voltage.name) == ("local_activation_time", "bipolar_voltage")
    for field in (time, voltage):
        assert field.mapped_share > 0.95
        assert field.redundancy.n_redundant > 0
    assert time.mapped_nrmse < 0.05
    assert time.n_sufficient < 60
    assert 0.1 < voltage.mapped_nrmse < 0.4
    assert voltage.n_sufficient is None


def test_the_velocity_and_its_range_hold_the_truth(study) -> None:
    """The front runs at 0.6 m/s in space, and never slower along the surface."""
    velocity = study.maps[0].fields[0].velocity
    assert velocity.vendor == pytest.approx(velocity.expected, rel=0.02)
    assert velocity.low <= velocity.vendor <= velocity.high * 1.01
    assert velocity.high - velocity.low < 0.05


def test_the_low_voltage_area_and_its_range_hold_the_truth(study) -> None:
    low = study.maps[0].fields[1].low_voltage
    assert low.expected_mm2 == pytest.approx(low.vendor_mm2, rel=0.1)
    assert low.low_mm2 < low.vendor_mm2 < low.high_mm2
    assert low.mapped_mm2 <= SURFACE.area


def test_the_vendors_map_is_the_truth_here_and_lies_within_the_uncertainty(study) -> None:
    for field in study.maps[0].fields:
        assert field.vendor.coloured_share == 1
        assert field.vendor.relative < field.mapped_nrmse
        assert field.vendor.beyond_share < 0.1
    time, voltage = study.maps[0].fields
    assert time.vendor.vendor_at_points < 1e-6
    noise = np.sqrt(np.mean(NOISE[rows(150)] ** 2))
    assert voltage.vendor.vendor_at_points == pytest.approx(noise)


def test_a_map_of_one_side_is_judged_by_that_side_and_says_how_much_it_is(study) -> None:
    for field in study.maps[1].fields:
        assert 0.3 < field.mapped_share < 0.7
        assert field.mapped_nrmse < 0.7 * field.rebuilt.predicted_nrmse
        x = SURFACE.vertices[:, 0]
        assert not field.mapped[x < -10].any()
        assert field.mapped[x > 20].all()
        shares = list(field.fill_shares.values())
        assert max(shares) < 1
        assert min(shares) < field.mapped_share
    assert not study.maps[1].fields[1].rebuilt.verdict.enough


def test_two_points_say_nothing_and_nothing_is_derived_from_them(study) -> None:
    one = study.maps[2]
    assert one.extent.n_places == 2
    for field in one.fields:
        assert field.knows_nothing
        assert np.isnan(field.mapped_nrmse)
        assert (field.n_sufficient, field.vendor, field.low_voltage, field.velocity) == (None,) * 4


def test_the_document_is_finite_and_the_same_again(study) -> None:
    text = json_text(map_study_document(study))
    again = analyzed(a_map(rows(150)), *(), a_map(rows(2)))
    document = map_study_document(study)
    assert map_study_document(again)["maps"][0] == document["maps"][0]
    assert text.count('"knows_nothing": true') == 2


def test_the_table_of_points_names_every_point_by_its_number(study) -> None:
    field = study.maps[0].fields[0]
    lines = points_csv(field).splitlines()
    assert lines[0].startswith("point,x_mm,y_mm,z_mm,local_activation_time_ms,n_merged")
    numbers = [int(line.split(",")[0]) for line in lines[1:]]
    assert sorted(numbers) == sorted(field.identifiers.tolist())
    redundant = sum(line.endswith(",1") for line in lines[1:])
    assert redundant == field.redundancy.n_redundant
    by_number = {int(line.split(",")[0]): float(line.split(",")[4]) for line in lines[1:]}
    for place, row in enumerate(rows(150).tolist(), start=1):
        assert by_number[place] == pytest.approx(TIMES[row], rel=1e-5)


def test_points_without_a_value_count_only_for_the_quantities_they_have() -> None:
    chosen = rows(60)
    voltage = VOLTAGE[chosen]
    voltage[:20] = np.nan
    (one,) = analyzed(a_map(chosen, bipolar_voltage=voltage)).maps
    counts = {field.name: int(field.rebuilt.placed.counts.sum()) for field in one.fields}
    assert counts == {"local_activation_time": 60, "bipolar_voltage": 40}
    assert min(one.fields[1].identifiers) == 21


def test_points_the_vendor_does_not_use_are_left_out_and_counted() -> None:
    used = np.arange(60) >= 10
    (one,) = analyzed(a_map(rows(60), included=used)).maps
    assert (one.n_points, one.n_included) == (60, 50)
    assert "points the vendor's map does not use left out: 10" in one.remarks


def test_a_re_entry_is_fitted_round_the_circle() -> None:
    """Whole cycles added to the times of some points change neither the map nor the velocity."""
    chosen = rows(150)
    cycle = 200.0
    angle = np.arctan2(SURFACE.vertices[:, 1], SURFACE.vertices[:, 0]) / (2 * np.pi)
    times = (angle * cycle)[chosen] + np.where(np.arange(150) % 3 == 0, cycle, 0.0)
    plain = a_map(chosen, vendor=False, local_activation_time=times)
    config = replace(CONFIG, cycle_length_ms=cycle, fields=("local_activation_time",))
    (field,) = analyzed(plain, config=config).maps[0].fields
    assert field.rebuilt.config.cycle_length_ms == cycle
    equator = np.abs(SURFACE.vertices[:, 2]) < 10
    radius = np.hypot(*SURFACE.vertices[equator, :2].T)
    speed = np.nanmedian(field.velocity.local[equator])
    assert speed == pytest.approx(2 * np.pi * np.median(radius) / cycle, rel=0.05)
    told = replace(plain, cycle_length=cycle)
    (same,) = analyzed(told, config=replace(config, cycle_length_ms=None)).maps[0].fields
    assert same.velocity.expected == field.velocity.expected


def test_what_cannot_be_analysed_is_named_and_the_rest_goes_on() -> None:
    far = a_map(rows(30))
    moved = MappingPoints(far.points.positions + 500.0, bipolar_voltage=VOLTAGE[:30])
    torn = TriangleSoup(SURFACE.vertices, SURFACE.faces[:3])
    maps = analyzed(
        replace(far, points=MappingPoints(np.empty((0, 3)))),
        replace(far, surface=None),
        replace(far, points=moved),
        replace(far, surface=torn),
        far,
    ).maps
    assert [len(one.fields) for one in maps] == [0, 0, 0, 0, 2]
    words = [" ".join(one.remarks) for one in maps]
    assert "no mapping points" in words[0]
    assert "no surface" in words[1]
    assert maps[1].extent.n_places == 30
    assert "bipolar_voltage not analysed: all 30 samples lie more than 5 mm off" in words[2]
    assert "surface not analysed" in words[3]


def test_a_quantity_nobody_recorded_is_refused() -> None:
    with pytest.raises(InputError, match="no quantity 'voltage'"):
        analyzed(a_map(rows(9)), config=replace(CONFIG, fields=("voltage",)))
    with pytest.raises(InputError, match="no point has a impedance"):
        analyzed(a_map(rows(9)), config=replace(CONFIG, fields=("impedance",)))
    with pytest.raises(InputError, match="no map"):
        analyzed()


def test_points_count_where_the_vendor_projected_them_else_where_they_were_measured() -> None:
    projected = np.array([[1.0, 1, 1], [np.nan] * 3])
    points = MappingPoints(np.zeros((2, 3)), projected)
    np.testing.assert_array_equal(used_positions(points), [[1, 1, 1], [0, 0, 0]])


@pytest.mark.parametrize(
    "changed",
    [
        {"target_nrmse": 1.0},
        {"cycle_length_ms": -5.0},
        {"low_voltage_mv": 0.0},
        {"mapped_within_mm": float("inf")},
        {"n_draws": 3},
    ],
)
def test_parameters_out_of_range_are_refused(changed) -> None:
    with pytest.raises(InputError):
        MapStudyConfig(**changed)


def test_an_export_is_known_by_its_content_and_never_by_its_name(tmp_path) -> None:
    for name in ("Smith", "Jones"):
        (tmp_path / name / "deep").mkdir(parents=True)
        (tmp_path / name / "deep" / "a.txt").write_text("1")
    one, other = (export_source(tmp_path / name, "CARTO 3") for name in ("Smith", "Jones"))
    assert one == other
    assert (one.name, one.n_bytes) == ("CARTO 3 export", 1)
    (tmp_path / "Jones" / "deep" / "a.txt").write_text("2")
    assert export_source(tmp_path / "Jones", "CARTO 3").sha256 != one.sha256
    assert is_export(tmp_path)
    assert not is_export(tmp_path / "a.vtp")


def test_a_table_without_named_columns_and_a_study_with_them_are_refused(tmp_path) -> None:
    table = tmp_path / "points.csv"
    table.write_text("x,y,z\n1,2,3\n")
    with pytest.raises(InputError, match=r"points\.csv: the columns of a table are not guessed"):
        read_export(table)
    with pytest.raises(InputError, match="no such file"):
        analyze_export(tmp_path / "absent.zip")
