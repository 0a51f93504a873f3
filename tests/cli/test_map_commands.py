"""`auricle import` and `auricle analyze` of exports, from the command line."""

import json
import sys
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from auricle.cli.app import main
from auricle.electroanatomy.formats.carto_writing import write_carto
from auricle.electroanatomy.formats.ensite_writing import write_ensite
from auricle.electroanatomy.formats.openep_writing import write_openep
from auricle.electroanatomy.study import ElectroanatomicMap, ElectroanatomicStudy
from auricle.electroanatomy.synthetic import Acquisition, synthetic_map
from auricle.study.map_analysis import analyze_export
from auricle.study.map_study import MapStudyConfig
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere

BALL = icosphere(radius=30.0, subdivisions=3)
SURFACE = Mesh(BALL.vertices * [1.0, 0.9, 0.8], BALL.faces)
QUICK = ("-k", 40)


@pytest.fixture(autouse=True, scope="module")
def _coarse() -> Iterator[None]:
    """Small pictures: quicker to draw."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("auricle.report.maps.RESOLUTION", 40)
        patch.setattr("auricle.report.gallery.RESOLUTION", 40)
        yield


@dataclass(frozen=True)
class Done:
    """How a run of the program ended."""

    returncode: int
    stdout: str
    stderr: str


@pytest.fixture
def program(monkeypatch, capsys):
    """Runs `auricle ARGUMENTS…` in this process: what it loads need not be loaded again."""

    def run(*arguments: object) -> Done:
        monkeypatch.setattr(sys, "argv", ["auricle", *map(str, arguments)])
        capsys.readouterr()
        try:
            main()
            code = 0
        except SystemExit as end:
            code = int(end.code or 0)
        told = capsys.readouterr()
        return Done(code, told.out, told.err)

    return run


@pytest.fixture(scope="module")
def recorded() -> ElectroanatomicMap:
    truth = {
        "local_activation_time": np.asarray(SURFACE.vertices[:, 0] / 0.6),
        "bipolar_voltage": 1.0 + SURFACE.vertices[:, 2] / 40.0,
    }
    acquisition = Acquisition(n_points=80, duration=300.0)
    return synthetic_map(SURFACE, truth, acquisition=acquisition, rng=np.random.default_rng(5))


@pytest.fixture(scope="module")
def exports(recorded, tmp_path_factory) -> dict[str, Path]:
    """The same map as three vendors export it, and the CARTO one zipped."""
    place = tmp_path_factory.mktemp("exports")
    study = ElectroanatomicStudy("synthetic", (recorded,))
    write_carto(place / "carto", study)
    write_ensite(place / "ensite", study)
    write_openep(place / "map.mat", recorded)
    with zipfile.ZipFile(place / "carto.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        for path in sorted((place / "carto").rglob("*")):
            archive.write(path, path.relative_to(place / "carto"))
    return {
        "zip": place / "carto.zip",
        "carto": place / "carto",
        "ensite": place / "ensite",
        "openep": place / "map.mat",
    }


@pytest.mark.parametrize(
    ("kind", "system"),
    [
        ("carto", "CARTO 3"),
        ("zip", "CARTO 3"),
        ("ensite", "EnSite Precision"),
        ("openep", "OpenEP"),
    ],
)
def test_an_export_of_each_vendor_is_analysed(exports, kind, system) -> None:
    config = MapStudyConfig(n_modes=40, n_draws=20, fields=("local_activation_time",))
    found = analyze_export(exports[kind], config)
    assert found.system == system
    (time,) = found.maps[0].fields
    assert len(found.maps) == 1
    assert time.velocity.expected == pytest.approx(0.62, abs=0.06)
    assert time.mapped_nrmse < 0.15
    assert time.vendor.relative < 0.2


def test_the_command_passes_its_options_on_and_says_the_answer_last_the_report(
    program, exports, tmp_path
) -> None:
    options = ("--field", "bipolar_voltage", "--low-voltage", 0.8, "--target", 0.3)
    more = ("--mapped-within", 15, "--max-distance", 7, "--cycle-length", 300)
    done = program("analyze", exports["zip"], "-o", tmp_path, *options, *more, *QUICK)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.strip().splitlines()
    assert lines[-1] == str(tmp_path / "report.html")
    assert "bipolar voltage: " in lines[0]
    assert "points are used where the system projected them" in done.stderr
    document = json.loads((tmp_path / "result.json").read_text())
    (quantity,) = document["maps"][0]["quantities"]
    assert quantity["low_voltage"]["threshold_mv"] == 0.8
    parameters = document["parameters"]
    assert (parameters["target_nrmse"], parameters["mapped_within_mm"]) == (0.3, 15.0)
    assert (parameters["max_distance_mm"], parameters["cycle_length_ms"]) == (7.0, 300.0)


def test_import_writes_every_map_and_says_what_it_left_out(program, exports, tmp_path) -> None:
    done = program("import", exports["carto"], "-o", tmp_path)
    assert done.returncode == 0, done.stderr
    assert "80 points, 80 with electrograms" in done.stdout
    names = {path.name for path in (tmp_path / "map_1").iterdir()}
    assert names == {"surface.vtp", "points.csv", "electrograms.npz", "electrograms.json"}


def test_a_table_is_read_by_the_columns_that_are_named(program, tmp_path) -> None:
    table = tmp_path / "points.csv"
    table.write_text("px;py;pz;t\n1,5;0;0;0,01\n0;2;0;0,02\n0;0;3;\n")
    named = ("--column", "position=px,py,pz:cm", "--column", "local_activation_time=t:s")
    style = ("--delimiter", ";", "--decimal", ",")
    done = program("import", table, "-o", tmp_path / "out", *named, *style)
    assert done.returncode == 0, done.stderr
    lines = (tmp_path / "out" / "map_1" / "points.csv").read_text().splitlines()
    assert lines[1].split(",")[2:5] == ["15.0", "0.0", "0.0"]
    assert [line.split(",")[-1] for line in lines[1:]] == ["10.0", "20.0", ""]


def test_points_without_a_surface_are_told_as_what_they_are(program, tmp_path) -> None:
    table = tmp_path / "points.csv"
    table.write_text("x,y,z,v\n" + "".join(f"{i},{i % 7},{i % 5},1.0\n" for i in range(40)))
    named = ("--column", "position=x,y,z:mm", "--column", "bipolar_voltage=v:mV")
    done = program("analyze", table, "-o", tmp_path / "out", *named)
    assert done.returncode == 0, done.stderr
    assert "40 points" in done.stdout
    assert "no surface" in done.stdout


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (("analyze", "absent.zip"), 3, "absent.zip: there is no such file"),
        (("import", "text.zip"), 3, "text.zip: "),
        (("analyze", "text.mat"), 3, "text.mat: "),
        (("analyze", "points.csv"), 3, "points.csv: the columns of a table are not guessed"),
        (("analyze", "points.csv", "--column", "position=x,y,z:feet"), 3, "'feet'"),
        (("analyze", "points.csv", "--column", "position=x,y:mm"), 2, "position=X,Y,Z:mm"),
        (("analyze", "points.csv", "--column", "nonsense"), 2, "WHAT=COLUMN:UNIT"),
        (("analyze", "points.csv", "--target", "2"), 3, "points.csv: a target error of 2.0"),
        (("import", "."), 3, "no known system"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else None,
)
def test_faults_are_one_line_with_the_file_and_nothing_is_written(
    program, tmp_path, monkeypatch, arguments, code, words
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("text.zip", "text.mat"):
        Path(name).write_text("this is text")
    Path("points.csv").write_text("x,y,z\n1,2,3\n")
    before = sorted(path.name for path in tmp_path.iterdir())
    done = program(*arguments, "-o", tmp_path / "out")
    assert done.returncode == code, done.stderr
    assert words in " ".join(done.stderr.split())
    assert "Traceback" not in done.stderr
    if code == 3:
        assert len(done.stderr.strip().splitlines()) == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == before


def test_the_phantoms_export_says_that_it_knows_nothing(program, real_data, tmp_path) -> None:
    export = real_data / "maps" / "carto3-export" / "carto_flat.zip"
    done = program("analyze", export, "-o", tmp_path, "-n", 1000, "-k", 60)
    assert done.returncode == 0, done.stderr
    answers = done.stdout.strip().splitlines()[:-1]
    assert sum("no mapping points" in answer for answer in answers) == 3
    assert sum("say nothing of the map" in answer for answer in answers) == 2
    assert not any("%" in answer for answer in answers)
