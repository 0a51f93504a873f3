"""What a study's file may say, and what it stands for."""

from pathlib import Path

import pytest

from auricle.errors import InputError
from auricle.study.cohort.sources import case_names, expanded, is_generated
from auricle.study.cohort.study_file import chosen_study, read_study

EXAMPLES = Path(__file__).resolve().parents[3] / "examples" / "studies"


@pytest.fixture
def study(tmp_path, monkeypatch):
    """Reads a study written beside a folder of surfaces."""
    monkeypatch.delenv("AURICLE_DATA", raising=False)
    for name in ("a/left.vtp", "b/left.vtp", "b/right.pts", "b/right.elem", "scan/IM0001"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(name)

    def read(text: str):
        (tmp_path / "study.toml").write_text(text)
        return read_study(tmp_path / "study.toml")

    return read


def test_paths_patterns_folders_and_ranges_stand_for_cases_each_once(study, tmp_path) -> None:
    found = study('cases = ["a/left.vtp", "*/left.vtp", "b", "scan", "atrium:seed=1..2"]')
    within = [Path(each).relative_to(tmp_path).as_posix() for each in found.sources[:4]]
    assert within == ["a/left.vtp", "b/left.vtp", "b/right.pts", "scan"]
    assert found.sources[4:] == ("atrium:seed=1", "atrium:seed=2")


def test_a_folder_of_folders_of_slices_is_a_case_a_folder(tmp_path) -> None:
    for patient in ("p1", "p2"):
        (tmp_path / "all" / patient).mkdir(parents=True)
        (tmp_path / "all" / patient / "IM1").write_text("slice")
    assert case_names(expanded([str(tmp_path / "all")])) == ("p1", "p2")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('cases = ["a"]\ncase = 1', "study.toml: unknown key 'case': a study has title"),
        ('cases = "a"', "study.toml: cases: is no list"),
        ('cases = ["a"]\ntitle = 3', "study.toml: title: is no text"),
        ('cases = ["a"]\nparameters = 3', "study.toml: parameters: is no table"),
        ('cases = ["*.stl"]', "stands for no surface"),
        ('cases = ["c/left.vtp"]', "does not exist"),
        ('cases = ["$AURICLE_DATA/x.vtp"]', "AURICLE_DATA is not set"),
        ('cases = ["atrium:seed=4..2"]', "a range that is empty"),
        ("cases = []", "no cases"),
        ("cases = [", "not TOML"),
    ],
)
def test_what_is_wrong_is_told_with_the_file_and_the_key(study, tmp_path, text, words) -> None:
    with pytest.raises(InputError) as told:
        study(text)
    assert str(told.value).startswith(f"{tmp_path / 'study.toml'}: ")
    assert words in str(told.value)


def test_a_study_that_is_not_there_is_refused(tmp_path) -> None:
    with pytest.raises(InputError, match="No such file"):
        chosen_study([str(tmp_path / "study.toml")])


def test_optional_cases_are_left_out_aloud_where_their_folder_is_not_named(
    study, tmp_path, monkeypatch
) -> None:
    text = 'cases = ["a"]\noptional_cases = ["$AURICLE_DATA/b/left.vtp"]'
    without = study(text)
    assert (len(without.sources), len(without.remarks)) == (1, 1)
    monkeypatch.setenv("AURICLE_DATA", str(tmp_path))
    together = study(text)
    assert (len(together.sources), together.remarks) == (2, ())


def test_names_tell_cases_apart_by_no_more_folders_than_needed() -> None:
    sources = ["/home/me/x/p1/left.nii.gz", "/home/me/x/p2/left.nii.gz", "/home/me/x/other.vtp"]
    assert case_names(sources) == ("p1/left", "p2/left", "other")


def test_a_file_whose_name_looks_generated_is_a_file() -> None:
    assert not is_generated("C:\\scans\\a.vtp")
    assert not is_generated("scans/atrium.vtp")


def test_the_examples_are_studies(monkeypatch) -> None:
    monkeypatch.delenv("AURICLE_DATA", raising=False)
    paper = read_study(EXAMPLES / "paper.toml")
    assert paper.sources == tuple(f"phantom:seed={seed},preset=medium" for seed in range(1, 8))
    assert paper.remarks
    assert len(read_study(EXAMPLES / "tiny.toml").sources) == 3


def test_the_papers_study_has_seven_real_atria_too(monkeypatch, real_data) -> None:
    monkeypatch.setenv("AURICLE_DATA", str(real_data))
    assert len(read_study(EXAMPLES / "paper.toml").sources) == 14
