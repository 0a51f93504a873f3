"""`auricle plan`, `reconstruct` and `next` from the command line: what they write and refuse."""

import csv
import io
import json
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from auricle.cli.app import main
from auricle.surface.cleaning import clean
from auricle.surface.reading import read_surface

OPTIONS = ("-n", 700, "-k", 60)
FILES = {
    "plan": {
        *("report.html", "result.json", "timings.json", "figures"),
        *("points.csv", "surface.vtp"),
    },
    "reconstruct": {
        *("report.html", "result.json", "timings.json", "figures"),
        *("map.vtp", "samples.csv", "next_points.csv"),
    },
}

_read_once = cache(read_surface)


@pytest.fixture
def here(monkeypatch, capsys):
    """Runs a command in this process: quicker than one of its own; exit code, output, errors."""
    monkeypatch.setattr("auricle.study.preparation.read_surface", _read_once)

    def run(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["auricle", *map(str, arguments)])
        with pytest.raises(SystemExit) as end:
            main()
        out, err = capsys.readouterr()
        return int(end.value.code or 0), out, err

    return run


@pytest.fixture(scope="module")
def vertices(surface) -> np.ndarray:
    return clean(_read_once(surface)).mesh.vertices


@pytest.fixture(scope="module")
def rows(vertices) -> np.ndarray:
    """Positions and values of 80 samples, with noise of 2 ms."""
    rng = np.random.default_rng(4)
    at = vertices[rng.permutation(len(vertices))[:80]]
    values = 80 + at[:, 0] + 0.02 * at[:, 1] ** 2 + rng.normal(0, 2, 80)
    return np.column_stack([at, values])


def text_of(rows: np.ndarray, header: str = "x_mm,y_mm,z_mm,LAT_ms", separator: str = ",") -> str:
    lines = [separator.join(f"{value:.9g}" for value in row) for row in rows]
    return "\n".join([header, *lines, ""])


@pytest.fixture(scope="module")
def samples(rows, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("samples") / "samples.csv"
    path.write_text(text_of(rows))
    return path


@pytest.fixture(scope="module")
def plan_folder(auricle, surface, tmp_path_factory) -> Path:
    place = tmp_path_factory.mktemp("plan") / "out"
    done = auricle("plan", surface, "--gaussian", 16, "--target", 0.2, "-o", place, *OPTIONS)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[0].startswith("Take ")
    assert done.stdout.splitlines()[-1] == str(place / "report.html")
    return place


@pytest.fixture(scope="module")
def map_folder(auricle, surface, samples, tmp_path_factory) -> Path:
    place = tmp_path_factory.mktemp("map") / "out"
    done = auricle("reconstruct", surface, samples, "--noise", 2, "-o", place, *OPTIONS)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == str(place / "report.html")
    return place


def refused(done: tuple[int, str, str], path: Path | None, cause: str, *, code: int = 3) -> None:
    status, out, err = done
    assert status == code, err
    assert err.count("\n") == 1
    assert err.startswith(f"auricle: {path}: " if path else "auricle: ")
    assert cause in err
    assert out == ""


def test_a_plan_from_the_command_line_is_whole(plan_folder):
    assert {path.name for path in plan_folder.iterdir()} == FILES["plan"]
    document = json.loads((plan_folder / "result.json").read_text())
    with (plan_folder / "points.csv").open() as file:
        points = list(csv.DictReader(file))
    assert len(points) == document["n_planned"] == document["recommendation"]["n_samples"]


def test_a_map_from_the_command_line_is_whole(map_folder):
    assert {path.name for path in map_folder.iterdir()} == FILES["reconstruct"]
    document = json.loads((map_folder / "result.json").read_text())
    assert document["n_samples"] == 80
    assert document["unit"] == "ms"
    assert document["noise_stated"] == 2.0
    assert 0 < document["predicted_nrmse"] < 0.3


def test_the_same_input_gives_the_same_bytes(here, surface, samples, map_folder, tmp_path):
    """In another process; times stand in timings.json alone."""
    asked = (samples, "--noise", 2, "-o", tmp_path / "again")
    status, _, err = here("reconstruct", surface, *asked, *OPTIONS)
    assert status == 0, err
    for path in map_folder.rglob("*"):
        if path.is_file() and path.name != "timings.json":
            again = tmp_path / "again" / path.relative_to(map_folder)
            assert again.read_bytes() == path.read_bytes(), path.name
            assert b"wall_s" not in path.read_bytes()
            assert str(surface.parent).encode() not in path.read_bytes()


def test_next_prints_points_and_nothing_else(here, surface, samples):
    status, out, err = here("next", surface, samples, "--count", 3, *OPTIONS)
    assert status == 0
    points = list(csv.DictReader(io.StringIO(out)))
    assert [point["order"] for point in points] == ["1", "2", "3"]
    assert "nough" in err.splitlines()[-1]


def test_points_planned_are_samples_taken_for_the_next_plan(
    here, surface, plan_folder, tmp_path, monkeypatch
):
    monkeypatch.setattr("auricle.report.plan_page.drawn_files", lambda *_: {})
    asked = ("--gaussian", 16, "--target", 0.2, "--existing")
    header, *rest = (plan_folder / "points.csv").read_text().splitlines()
    half = tmp_path / "half.csv"
    half.write_text("\n".join([header, *rest[: len(rest) // 2], ""]))
    status, out, err = here("plan", surface, *asked, half, "-o", tmp_path / "out", *OPTIONS)
    assert status == 0, err
    document = json.loads((tmp_path / "out/result.json").read_text())
    assert document["n_existing"] == len(rest) // 2
    assert document["n_samples"] == len(rest)
    assert f"{len(rest) // 2} points taken already" in out


def test_next_keeps_out_of_a_forbidden_field(here, surface, samples):
    """The voltage is NaN above 20 mm and not 0 elsewhere: only the top is left."""
    asked = ("--count", 4, "--forbid", "bipolar_voltage")
    status, out, err = here("next", surface, samples, *asked, *OPTIONS)
    assert status == 0, err
    heights = [float(point["z_mm"]) for point in csv.DictReader(io.StringIO(out))]
    assert min(heights) > 20


def test_semicolons_and_decimal_commas_give_the_same_points(here, surface, samples, rows, tmp_path):
    other = tmp_path / "other.csv"
    header = "x_mm;y_mm;z_mm;LAT_ms"
    other.write_text(text_of(rows, header, ";").replace(".", ","))
    first, second = (here("next", surface, path, *OPTIONS) for path in (samples, other))
    assert first[0] == second[0] == 0
    assert first[1] == second[1]


@pytest.mark.parametrize("count", [1, 4])
def test_samples_that_say_nothing_give_no_number(here, surface, rows, tmp_path, count):
    path = tmp_path / "few.csv"
    path.write_text(text_of(rows[:count]))
    status, out, err = here("next", surface, path, *OPTIONS)
    assert status == 0
    assert next(csv.DictReader(io.StringIO(out)))["predicted_nrmse"] == ""
    assert "too little of the map to judge it by" in err
    assert "%" not in err


BAD = {
    "empty": ("", "is empty"),
    "no sample": ("x,y,z,LAT\n", "has a header but no sample"),
    "no header": ("1,2,3,4\n5,6,7,8\n", "has no header"),
    "no values": ("x,y,z,voltage\n1,2,3,4\n", "has no column 'LAT'"),
    "no positions": ("a,b,c,LAT\n1,2,3,4\n", "has no column 'x'"),
    "a word": ("x,y,z,LAT\n1,2,3,soon\n", "line 2, column 'LAT': 'soon' is no number"),
    "only NaN": ("x,y,z,LAT\n1,2,3,NaN\n", "none of 1 samples has a finite value"),
    "far away": ("x,y,z,LAT\n500,2,3,4\n", "more than 5 mm off the surface"),
    "metres": ("x,y,z,LAT\n0.03,0,0,4\n", "check that positions are in mm"),
    "decimal commas": ("x,y,z,LAT\n1,5,2,5,3,5,4,5\n", "need semicolons"),
    "binary": ("x,y,z,LAT\n\0\0\0", "is not text"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_samples_end_in_one_line_and_leave_nothing(here, surface, tmp_path, name):
    content, cause = BAD[name]
    path = tmp_path / "bad.csv"
    path.write_text(content)
    out = tmp_path / "out"
    refused(here("reconstruct", surface, path, "-o", out, *OPTIONS), path, cause)
    assert not out.exists()


def test_a_missing_file_of_samples_is_told_by_name(here, surface, tmp_path):
    for path in (tmp_path, tmp_path / "absent.csv"):
        done = here("reconstruct", surface, path, "-o", tmp_path / "out", *OPTIONS)
        refused(done, path, "")
    assert not (tmp_path / "out").exists()


def test_a_missing_surface_is_told_by_name(here, samples, tmp_path):
    path = tmp_path / "absent.vtp"
    refused(here("next", path, samples), path, "")
    refused(here("plan", path, "--bandwidth", 5, "-o", tmp_path / "out"), path, "")


IMPOSSIBLE = {
    "nothing to map": ((), "say what is to be mapped"),
    "two things to map": (("--gaussian", 8, "--bandwidth", 5), "say what is to be mapped"),
    "no such class": (("--class", "waves"), "no class of maps 'waves'"),
    "no such parameter": (("--class", "disc", "--parameter", "depth=1"), "no parameter 'depth'"),
    "no such design": (("--bandwidth", 5, "--design", "spiral"), "no design 'spiral'"),
    "no such catheter": (("--bandwidth", 5, "--catheter", "lasso"), "no catheter 'lasso'"),
    "error of 200 %": (("--bandwidth", 5, "--target", 2), "a target error of 2.0"),
    "no point": (("--bandwidth", 5, "--points", 0), "ask for at least 1"),
    "negative noise": (("--bandwidth", 5, "--noise", -1), "a noise of -1.0"),
}


@pytest.mark.parametrize("name", IMPOSSIBLE)
def test_an_impossible_plan_ends_in_one_line_and_leaves_nothing(here, surface, tmp_path, name):
    """The request is at fault and not the surface, so that this is not named."""
    asked, cause = IMPOSSIBLE[name]
    refused(here("plan", surface, *asked, "-o", tmp_path / "out", *OPTIONS), None, cause)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("asked", "cause"),
    [
        (("--map", "absent"), "no field named 'absent': the surface has bipolar_voltage, constant"),
        (("--map", "constant"), "field 'constant' is constant"),
        (("--map", "nothing"), "field 'nothing' has no values"),
        (("--bandwidth", 5, "--points", 700), "642 vertices allowed"),
        (("--bandwidth", 5, "--forbid", "veins"), "no field named 'veins'"),
        (("--bandwidth", 5, "--forbid", "constant"), "forbids all of the surface"),
        (("--bandwidth", 5, "-k", 642), "642 harmonics of 642 vertices"),
    ],
)
def test_what_the_surface_cannot_give_is_told_by_its_name(here, surface, tmp_path, asked, cause):
    refused(here("plan", surface, *OPTIONS, *asked, "-o", tmp_path / "out"), surface, cause)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("asked", "cause"),
    [
        (("--noise", -1), "a noise of -1.0"),
        (("--noise", 1, "--noise-column", "sd"), "given twice"),
        (("--cycle-length", 0), "a cycle length of 0.0 ms"),
        (("--cycle-length", 200, "--robust"), "not fitted robustly"),
        (("--max-distance", 0), "a distance of 0.0 mm"),
        (("--target", 0), "a target error of 0.0"),
    ],
)
def test_an_impossible_map_ends_in_one_line(here, surface, samples, tmp_path, asked, cause):
    done = here("reconstruct", surface, samples, *asked, "-o", tmp_path / "out", *OPTIONS)
    refused(done, None, cause)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("asked", [("--columns", "x,y"), ("--count", 0)])
def test_an_option_that_makes_no_sense_is_a_usage_error(here, surface, samples, asked):
    assert here("next", surface, samples, *asked, *OPTIONS)[0] == 2


def test_an_output_that_is_a_file_is_refused_before_the_work(here, surface, samples, tmp_path):
    place = tmp_path / "file"
    place.write_text("mine")
    refused(here("reconstruct", surface, samples, "-o", place), place, "is a file", code=1)
    refused(here("plan", surface, "--bandwidth", 5, "-o", place), place, "is a file", code=1)
    assert place.read_text() == "mine"


@pytest.mark.parametrize("command", ["plan", "reconstruct", "next"])
def test_help_has_an_example(here, command):
    status, out, _ = here(command, "--help")
    assert status == 0
    assert f"Example: auricle {command}" in " ".join(out.split())
