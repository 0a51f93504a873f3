"""`auricle study` from the command line: from a study's file to its page, whole or in parts."""

import json
import re
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "studies"
TINY = (EXAMPLES / "tiny.toml").read_text(encoding="utf-8")
FILES = {
    "report.html",
    "reproduction.md",
    "table1.csv",
    "decay.csv",
    "cohort.csv",
    "cohort.parquet",
    "measurements.parquet",
    "costs.csv",
    "failures.csv",
    "ro-crate-metadata.json",
}


@pytest.fixture(scope="module")
def folder(auricle, tmp_path_factory) -> Path:
    """The tiny study, computed in two shards and gathered by a run without."""
    place = tmp_path_factory.mktemp("study") / "out"
    study = ("study", EXAMPLES / "tiny.toml", "-o", place)
    for part in ("1/2", "2/2"):
        done = auricle(*study, "--shard", part)
        assert done.returncode == 0, done.stderr
        assert not (place / "report.html").exists()
    done = auricle(*study)
    assert done.returncode == 0, done.stderr
    assert "0 computed, 3 found finished, 0 failed" in done.stdout
    assert done.stdout.strip().endswith(str(place / "report.html"))
    return place


@pytest.mark.slow
def test_the_folder_holds_page_tables_and_one_file_a_case(folder) -> None:
    assert {path.name for path in folder.iterdir()} >= FILES
    assert len(list((folder / "cases").iterdir())) == 3


@pytest.mark.slow
def test_every_result_says_where_it_comes_from_and_names_no_folder(folder) -> None:
    for path in (folder / "cases").iterdir():
        text = path.read_text()
        values = json.loads(text)["values"]
        assert values["source"]["sha256"]
        assert values["parameters"]["n_vertices"] == 400
        assert values["versions"]["numpy"]
    machine = re.compile(rf"{re.escape(str(folder.parent))}|{re.escape(str(Path.home()))}/")
    for path in folder.rglob("*"):
        if path.is_file() and path.suffix != ".png":
            assert not machine.search(path.read_bytes().decode("utf-8", "replace")), path.name


def test_a_bad_case_is_told_and_the_other_is_done(auricle, tmp_path) -> None:
    (tmp_path / "torn.vtp").write_text("<VTKFile")
    cases = 'cases = ["torn.vtp", "atrium:seed=1,spacing=3"]'
    (tmp_path / "study.toml").write_text(re.sub(r"cases = .*", cases, TINY))
    done = auricle("study", tmp_path / "study.toml", "-o", tmp_path / "out", "--shard", "1/1")
    assert done.returncode == 4
    assert done.stdout == "1 computed, 0 found finished, 1 failed\n"
    assert "[2/2] atrium:seed=1,spacing=3: " in done.stderr
    assert "1 of 2 cases have no result, first torn: torn.vtp: " in done.stderr
    (failure,) = (tmp_path / "out" / "failures").iterdir()
    assert json.loads(failure.read_text())["error"] in done.stderr
    (result,) = (tmp_path / "out" / "cases").iterdir()
    assert json.loads(result.read_text())["values"]["certificate"]["n_zero_modes"] == 1


def test_gathering_computes_nothing_and_says_what_is_missing(auricle, tmp_path) -> None:
    done = auricle("study", EXAMPLES / "tiny.toml", "-o", tmp_path, "--gather")
    assert done.returncode == 4
    assert "3 of 3 cases have no result" in done.stderr
    assert "not computed yet" in done.stderr
    assert not (tmp_path / "cases").exists()


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("n_vertex = 3", "study.toml: parameters: no parameter 'n_vertex'"),
        ("placements = 'two'", "study.toml: parameters: placements = 'two'"),
    ],
)
def test_a_parameter_that_is_wrong_is_named_with_the_file(auricle, tmp_path, line, words) -> None:
    (tmp_path / "study.toml").write_text(f'cases = ["atrium:seed=1"]\n[parameters]\n{line}\n')
    done = auricle("study", tmp_path / "study.toml", "-o", tmp_path / "out")
    assert done.returncode == 3
    assert words in done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("options", "code"), [(("--shard", "3/2"), 3), (("--gather", "--shard", "1/2"), 2)]
)
def test_a_part_that_does_not_exist_is_refused(auricle, tmp_path, options, code) -> None:
    done = auricle("study", "atrium:seed=1", "-o", tmp_path / "out", *options)
    assert done.returncode == code
