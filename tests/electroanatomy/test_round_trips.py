"""Synthetic studies written as three vendors lay them out, and read back."""

from pathlib import Path

import numpy as np
import pytest

from auricle.electroanatomy.formats.carto_writing import GAIN, write_carto
from auricle.electroanatomy.formats.ensite_writing import write_ensite
from auricle.electroanatomy.formats.openep_writing import write_openep
from auricle.electroanatomy.points import UNITS
from auricle.electroanatomy.reading import read_study
from auricle.electroanatomy.study import ElectroanatomicStudy
from auricle.electroanatomy.synthetic import Acquisition, synthetic_map
from auricle.errors import InputError, OutputError

SEEDS = range(10)


def study_of(one) -> ElectroanatomicStudy:
    return ElectroanatomicStudy("synthetic", (one,))


ROUNDING = 1e-9


def carto(folder: Path, one, seed: int = 1) -> Path:
    write_carto(folder / "export", study_of(one), version=4 + seed % 3)
    return folder / "export"


def ensite(folder: Path, one, seed: int = 1) -> Path:
    write_ensite(folder / "export", study_of(one), points_per_file=2 + seed)
    return folder / "export"


def openep(folder: Path, one, seed: int = 1) -> Path:
    write_openep(folder / "map.mat", one, version="7" if seed % 2 else "7.3")
    return folder / "map.mat"


# What half a unit of each file's last digit comes to: positions of vertices and of points (mm),
# values of vertices, activation times (ms), values of points, samples (mV)
PRECISION = {
    carto: (5e-4, 5e-5, 5e-6, 0.0, 5e-4, GAIN / 2),
    ensite: (5e-5, 5e-5, 5e-5, 1e-3, 5e-5, 5e-5),
    openep: (0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
}
ROLES = {carto: ("bipolar", "unipolar", "reference"), ensite: ("bipolar", "reference")}


@pytest.mark.parametrize("vendor", [carto, ensite, openep], ids=lambda vendor: vendor.__name__)
@pytest.mark.parametrize("seed", SEEDS)
def test_a_study_comes_back_to_the_precision_of_its_file(vendor, seed, recorded, tmp_path) -> None:
    one = recorded(seed, n_points=7)
    (back,) = read_study(vendor(tmp_path, one, seed)).maps
    vertex, point, value, time, measured, sample = (p + ROUNDING for p in PRECISION[vendor])
    assert np.abs(back.surface.vertices - one.surface.vertices).max() <= vertex
    np.testing.assert_array_equal(back.surface.faces, one.surface.faces)
    for name, values in back.surface.point_fields.items():
        assert np.abs(values - one.surface.point_fields[name]).max() <= value, name
    assert {"local_activation_time", "bipolar_voltage"} <= set(back.surface.point_fields)
    assert np.abs(back.points.positions - one.points.positions).max() <= point
    assert np.abs(back.points.projected_positions - one.points.projected_positions).max() <= point
    lag = back.points.local_activation_time - one.points.local_activation_time
    assert np.abs(lag).max() <= time
    assert set(back.points.recorded) >= {"local_activation_time", "bipolar_voltage"}
    for name in set(back.points.recorded) - {"local_activation_time"}:
        off = getattr(back.points, name) - getattr(one.points, name)
        assert np.abs(off).max() <= measured, name
    assert sorted(back.electrograms) == sorted(one.electrograms)
    for row, signal in one.electrograms.items():
        read = back.electrograms[row]
        assert read.sampling_rate == signal.sampling_rate
        assert abs(read.local_activation_time - signal.local_activation_time) <= time
        assert read.reference_annotation == pytest.approx(signal.reference_annotation, abs=2e-3)
        for role in ROLES.get(vendor, ROLES[carto]):
            assert bool(getattr(read, role)) == bool(getattr(signal, role))
            if getattr(signal, role):
                there = signal.channel(getattr(signal, role))
                here = read.channel(getattr(read, role))
                assert np.abs(here - there).max() <= sample


def test_a_map_has_the_faults_it_was_asked_for(recorded) -> None:
    one = recorded(3, duplicates=0.5, missing=0.5, off_surface=2.0)
    steps = np.linalg.norm(np.diff(one.points.projected_positions, axis=0), axis=1)
    assert 0 < (steps == 0.0).sum() < len(steps)
    silent = [not signal.unipolar for signal in one.electrograms.values()]
    assert 0 < sum(silent) < len(silent)
    off = np.linalg.norm(one.points.positions - one.points.projected_positions, axis=1)
    assert 0.5 < off.std() + off.mean() < 8.0


def test_carto_names_missing_channels_and_counts_them(recorded, tmp_path) -> None:
    one = recorded(3, missing=0.5)
    lost = sum(not signal.unipolar for signal in one.electrograms.values())
    (back,) = read_study(carto(tmp_path, one)).maps
    assert f"named channels not there: {lost}" in back.remarks


@pytest.mark.parametrize("version", ["7", "7.3"])
def test_openep_files_are_the_same_bytes_every_time_and_read_alike(
    version, one_map, chamber, tmp_path
):
    for name in ("a.mat", "b.mat"):
        write_openep(tmp_path / name, one_map, version=version)
    assert (tmp_path / "a.mat").read_bytes() == (tmp_path / "b.mat").read_bytes()
    (back,) = read_study(tmp_path / "a.mat").maps
    np.testing.assert_array_equal(back.surface.faces, chamber.faces)
    np.testing.assert_array_equal(back.surface.vertices, chamber.vertices)
    for name in UNITS:
        ours, theirs = getattr(back.points, name), getattr(one_map.points, name)
        np.testing.assert_allclose(ours, theirs, rtol=1e-14)
    assert back.window_of_interest == one_map.window_of_interest


def test_a_map_without_electrograms_or_points_survives_openep(one_map, tmp_path) -> None:
    bare = type(one_map)("map 1", one_map.surface, one_map.points)
    write_openep(tmp_path / "bare.mat", bare)
    (back,) = read_study(tmp_path / "bare.mat").maps
    ours, theirs = back.points.local_activation_time, one_map.points.local_activation_time
    np.testing.assert_allclose(ours, theirs)
    assert back.electrograms == {}
    write_openep(tmp_path / "shell.mat", type(one_map)("map 1", one_map.surface), version="7.3")
    (back,) = read_study(tmp_path / "shell.mat").maps
    assert len(back.points) == 0


def test_carto_without_vertex_values_says_so(one_map, tmp_path) -> None:
    write_carto(tmp_path / "v7", study_of(one_map), vertex_values=False)
    (back,) = read_study(tmp_path / "v7").maps
    assert back.surface.point_fields == {}
    count = len(one_map.surface.vertices)
    assert f"vertices without a value of the vendor's: {count}" in back.remarks


def test_what_a_vendor_cannot_hold_is_refused_and_nothing_written(recorded, tmp_path) -> None:
    fast = recorded(1, sampling_rate=2000.0)
    with pytest.raises(OutputError, match="1000 Hz"):
        write_carto(tmp_path / "fast", study_of(fast))
    with pytest.raises(OutputError, match=r"\.mat"):
        write_openep(tmp_path / "map.txt", fast)
    with pytest.raises(OutputError, match="version"):
        write_openep(tmp_path / "map.mat", fast, version="6")
    assert list(tmp_path.iterdir()) == []


def test_a_truth_with_gaps_is_refused(chamber) -> None:
    gaps = {"local_activation_time": np.full(chamber.n_vertices, np.nan)}
    with pytest.raises(InputError, match="truth"):
        synthetic_map(chamber, gaps, acquisition=Acquisition(), rng=np.random.default_rng(0))
    with pytest.raises(InputError, match="mapping points"):
        Acquisition(n_points=0)
