"""A genuine CARTO 3 export, held against what counting lines and words in its files gives."""

import re
import zipfile
from pathlib import Path

import numpy as np
import pytest

from auricle.electroanatomy.reading import read_study
from auricle.electroanatomy.study import ElectroanatomicStudy
from auricle.surface.cleaning import clean

# By hand: grep -c of the rows of each section
COUNTED = {
    "1-Map": (3513, 7022, 0),
    "1-1-ReMap": (3513, 7022, 0),
    "2-Map": (2916, 5828, 2),
    "3-Map": (2083, 4162, 0),
}


@pytest.fixture(scope="module")
def archive(real_data: Path) -> Path:
    return real_data / "maps" / "carto3-export" / "carto_flat.zip"


@pytest.fixture(scope="module")
def study(archive: Path) -> ElectroanatomicStudy:
    return read_study(archive)


@pytest.fixture(scope="module")
def folder(archive: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("unpacked")
    with zipfile.ZipFile(archive) as packed:
        packed.extractall(place)
    return place


def test_all_four_maps_have_the_vertices_faces_and_points_counted_by_hand(study) -> None:
    found = {
        one.name: (len(one.surface.vertices), len(one.surface.faces), len(one.points))
        for one in study.maps
    }
    assert found == COUNTED
    assert {one.space for one in study.maps} == {"unknown"}


def test_the_counts_are_those_of_grep(folder, study) -> None:
    for one in study.maps:
        text = (folder / f"{one.name}.mesh").read_text("latin-1")
        section = re.split(r"^\[(\w+)\]", text, flags=re.MULTILINE)
        rows = dict(zip(section[1::2], section[2::2], strict=True))
        for name, count in zip(
            ("VerticesSection", "TrianglesSection"), COUNTED[one.name][:2], strict=True
        ):
            assert len(re.findall(r"^ *\d+ =", rows[name], re.MULTILINE)) == count


def test_every_surface_is_sound_enough_to_be_cleaned(study) -> None:
    for one in study.maps:
        assert clean(one.surface).mesh.n_faces > 4000


def test_colours_are_read_and_minus_10000_is_missing(study) -> None:
    fields = study.maps[2].surface.point_fields
    assert set(fields) == {"unipolar_voltage", "bipolar_voltage", "impedance", "force"}
    assert {values[0] for values in fields.values()} == {1.884, 0.027, 100.5, 6.0}
    assert all(np.nanmin(values) > -10000 for values in fields.values())
    assert "colour columns without a value left out: 9" in study.maps[2].remarks


def test_points_have_the_positions_and_values_of_their_files(study) -> None:
    points = study.maps[2].points
    np.testing.assert_array_equal(
        points.positions, [[13.5681, 20.6895, 12.563], [13.5551, 20.7717, 12.4805]]
    )
    np.testing.assert_array_equal(points.projected_positions, [[12.8292, 19.4914, 5.15766]] * 2)
    np.testing.assert_array_equal(points.unipolar_voltage, [1.902, 1.866])
    np.testing.assert_array_equal(points.bipolar_voltage, [0.024, 0.03])
    np.testing.assert_array_equal(points.impedance, [100.75, 100.25])
    assert points.identifiers.tolist() == [1, 2]
    assert study.maps[2].window_of_interest == (20.0, 180.0)


def test_electrograms_have_2500_samples_at_1_khz_in_mv_by_the_files_gain(study, folder) -> None:
    electrograms = study.maps[2].electrograms
    assert sorted(electrograms) == [0, 1]
    for row, signal in electrograms.items():
        assert signal.samples.shape == (2500, 3)
        assert signal.sampling_rate == 1000.0
        assert (signal.unipolar, signal.bipolar, signal.reference) == ("M1", "M1-M2", "I")
        lines = (folder / f"2-Map_P{row + 1}_ECG_Export.txt").read_text().splitlines()
        names = lines[3].split()
        for channel, column in (("M1", "M1(1)"), ("M1-M2", "M1-M2(92)"), ("I", "I(110)")):
            written = [int(line.split()[names.index(column)]) for line in lines[4:]]
            np.testing.assert_allclose(signal.channel(channel), np.array(written) * 0.003)
        assert signal.reference_annotation == 2000.0


def test_all_channels_are_kept_on_demand(archive) -> None:
    signal = read_study(archive, all_channels=True).maps[2].electrograms[0]
    assert signal.samples.shape == (2500, 26)
    assert signal.channels[:2] == ("M1", "M2")


def test_an_annotation_of_minus_10000_is_no_activation_time(study) -> None:
    one = study.maps[2]
    assert np.isnan(one.points.local_activation_time).all()
    assert np.isnan(one.electrograms[0].map_annotation)


def test_the_activation_time_is_map_minus_reference_annotation(folder, tmp_path) -> None:
    for place in folder.iterdir():
        if place.is_file():
            (tmp_path / place.name).write_bytes(place.read_bytes())
    for number, annotation in ((1, 2087), (2, 1942)):
        place = tmp_path / f"2-Map_P{number}_Point_Export.xml"
        content = place.read_text().replace('="-8000"', f'="{annotation}"')
        place.write_text(content)
    one = read_study(tmp_path).maps[2]
    assert one.points.local_activation_time.tolist() == [87.0, -58.0]
    assert one.electrograms[1].local_activation_time == -58.0


def test_the_same_from_an_unpacked_folder(study, folder) -> None:
    unpacked = read_study(folder)
    assert unpacked.remarks == study.remarks
    for ours, theirs in zip(unpacked.maps, study.maps, strict=True):
        assert (ours.name, ours.remarks) == (theirs.name, theirs.remarks)
        np.testing.assert_array_equal(ours.surface.vertices, theirs.surface.vertices)
        np.testing.assert_array_equal(ours.points.positions, theirs.points.positions)
        for row, signal in ours.electrograms.items():
            np.testing.assert_array_equal(signal.samples, theirs.electrograms[row].samples)


def test_the_same_from_a_zip_with_everything_in_a_folder(folder, study, tmp_path) -> None:
    with zipfile.ZipFile(tmp_path / "deep.zip", "w", zipfile.ZIP_DEFLATED) as packed:
        for place in folder.glob("*"):
            if place.is_file() and not place.name.startswith(("RF", "Contact")):
                packed.write(place, f"Export Smith/{place.name}")
    deep = read_study(tmp_path / "deep.zip")
    assert [len(one.points) for one in deep.maps] == [len(one.points) for one in study.maps]
    assert [len(one.electrograms) for one in deep.maps] == [0, 0, 2, 0]


def test_what_was_not_read_is_counted_by_kind(study) -> None:
    assert "ablation files not read: 35" in study.remarks
    assert "catheter sensor files not read: 4" in study.remarks


def test_dates_and_the_studys_name_never_leave_the_reader(study) -> None:
    told = repr((study.remarks, [(one.name, one.remarks) for one in study.maps]))
    assert not re.search(r"2021|11[/_]25|15[:-]01", told)
