"""Exports as plain files, read back."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from auricle.electroanatomy.electrogram import Electrogram
from auricle.electroanatomy.formats.carto_writing import write_carto
from auricle.electroanatomy.points import MappingPoints
from auricle.electroanatomy.reading import read_study
from auricle.electroanatomy.study import ElectroanatomicMap, ElectroanatomicStudy
from auricle.electroanatomy.synthetic import Acquisition, synthetic_map
from auricle.sampling.samples_file import read_samples
from auricle.study.exports import export_source
from auricle.study.imported_study import drawable, write_study
from auricle.study.result import Source
from auricle.surface.reading import read_surface
from auricle.surface.shapes import ellipsoid
from auricle.surface.soup import TriangleSoup

CHAMBER = ellipsoid(semi_axes=(30.0, 25.0, 20.0), subdivisions=2)
SOURCE = Source("an export", 1, "0" * 64)


@pytest.fixture(scope="module")
def one() -> ElectroanatomicMap:
    truth = {
        "local_activation_time": np.asarray(CHAMBER.vertices[:, 0] / 0.5),
        "bipolar_voltage": 2.0 + CHAMBER.vertices[:, 2] / 20.0,
    }
    acquisition = Acquisition(n_points=9, duration=400.0, missing=0.5)
    return synthetic_map(CHAMBER, truth, acquisition=acquisition, rng=np.random.default_rng(3))


def written(folder: Path, *maps: ElectroanatomicMap) -> dict:
    document = write_study(ElectroanatomicStudy("test", maps), folder, source=SOURCE)
    assert json.loads((folder / "summary.json").read_text()) == document
    return document


def test_surface_points_and_electrograms_come_back_to_the_last_digit(one, tmp_path) -> None:
    written(tmp_path, one)
    soup = read_surface(tmp_path / "map_1" / "surface.vtp")
    np.testing.assert_array_equal(soup.vertices, one.surface.vertices)
    np.testing.assert_array_equal(soup.faces, one.surface.faces)
    for name, values in one.surface.point_fields.items():
        np.testing.assert_array_equal(soup.point_fields[name], values)
    assert soup.units["local_activation_time"] == "ms"
    with (tmp_path / "map_1" / "points.csv").open() as file:
        rows = list(csv.DictReader(file))
    found = [float(row["local_activation_time_ms"]) for row in rows]
    np.testing.assert_array_equal(found, one.points.local_activation_time)
    described = json.loads((tmp_path / "map_1" / "electrograms.json").read_text())
    with np.load(tmp_path / "map_1" / "electrograms.npz", allow_pickle=False) as archive:
        assert set(archive) == set(described["electrograms"])
        for row, signal in one.electrograms.items():
            name = f"point_{one.points.identifiers[row]}"
            np.testing.assert_array_equal(archive[name], signal.samples)
            told = described["electrograms"][name]
            assert told["row"] == row + 1
            assert told["channels"] == list(signal.channels)
            assert told["sampling_rate_hz"] == signal.sampling_rate
            lag = told["map_annotation_sample"] - told["reference_annotation_sample"]
            assert lag == one.points.local_activation_time[row]


def test_the_points_are_samples_as_the_other_commands_read_them(one, tmp_path) -> None:
    written(tmp_path, one)
    columns = {axis: f"projected_{axis}" for axis in "xyz"}
    samples = read_samples(
        tmp_path / "map_1" / "points.csv", columns=columns, value="local_activation_time"
    )
    np.testing.assert_array_equal(samples.positions, one.points.projected_positions)
    np.testing.assert_array_equal(samples.values, one.points.local_activation_time)
    assert samples.unit.lower() == "ms"


def test_what_a_map_lacks_has_no_file(one, tmp_path) -> None:
    bare = ElectroanatomicMap("bare")
    no_signals = replace(one, electrograms={}, surface=None)
    document = written(tmp_path, bare, no_signals)
    assert [each["files"] for each in document["maps"]] == [[], ["points.csv"]]
    assert document["maps"][0]["folder"] is None
    assert {path.name for path in tmp_path.iterdir()} == {"map_2", "summary.json"}


def test_triangles_that_are_none_are_left_out_and_counted_the_vertices_stay(tmp_path) -> None:
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    soup = TriangleSoup(vertices, np.array([[0, 1, 2], [0, 0, 1], [0, 1, 7]]))
    mesh, remark = drawable(soup)
    assert (mesh.n_vertices, mesh.n_faces) == (3, 1)
    assert remark == "triangles that are none left out: 2"
    nothing, why = drawable(TriangleSoup(vertices * np.nan, np.array([[0, 1, 2]])))
    assert nothing is None
    assert why.startswith("surface left out: ")
    document = written(tmp_path, ElectroanatomicMap("torn", soup))
    assert document["maps"][0]["left_out"] == [remark]


def test_the_same_export_gives_the_same_bytes(one, tmp_path) -> None:
    written(tmp_path / "a", one)
    written(tmp_path / "b", one)
    for place in sorted((tmp_path / "a").rglob("*.*")):
        other = tmp_path / "b" / place.relative_to(tmp_path / "a")
        assert place.read_bytes() == other.read_bytes(), place.name


def test_missing_annotations_are_null_and_not_a_number_of_any_kind(tmp_path) -> None:
    signal = Electrogram(np.zeros((4, 1)), 1000.0, ("M1-M2",))
    points = MappingPoints(np.zeros((1, 3)))
    written(tmp_path, ElectroanatomicMap("one", None, points, {0: signal}))
    (told,) = json.loads((tmp_path / "map_1" / "electrograms.json").read_text())[
        "electrograms"
    ].values()
    assert told["map_annotation_sample"] is None
    assert told["window_of_interest_ms"] is None
    assert told["bipolar"] is None


def test_names_given_to_files_and_maps_stay_behind(one, tmp_path) -> None:
    export = tmp_path / "Planted Patient 1957-03-02"
    write_carto(export, ElectroanatomicStudy("s", (replace(one, name="Planted LA"),)))
    study = read_study(export)
    out = tmp_path / "out"
    write_study(study, out, source=export_source(export, study.system))
    for place in out.rglob("*.*"):
        content = place.read_bytes()
        assert b"Planted" not in content, place.name
        assert b"1957" not in content, place.name
