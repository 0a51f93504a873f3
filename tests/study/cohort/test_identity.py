"""A case's key changes with everything its result depends on, and with nothing else."""

import os
import subprocess
import sys
from dataclasses import dataclass

import pytest

import auricle.study.cohort.identity as identity
from auricle.errors import InputError
from auricle.study.cohort.identity import identified, input_digest


@dataclass(frozen=True)
class Choice:
    n: int = 1


@pytest.fixture
def pair(tmp_path):
    place = tmp_path / "atrium.pts"
    place.write_text("points")
    place.with_suffix(".elem").write_text("triangles")
    return place


def key(place, choice=Choice()) -> str:
    return identified((str(place),), choice)[0].key


def test_the_place_and_the_time_of_a_file_do_not_matter(pair, tmp_path) -> None:
    before = key(pair)
    (tmp_path / "moved").mkdir()
    for suffix in (".pts", ".elem"):
        pair.with_suffix(suffix).rename(tmp_path / "moved" / f"atrium{suffix}")
    moved = tmp_path / "moved" / "atrium.pts"
    os.utime(moved, (0, 0))
    assert key(moved) == before


def test_its_bytes_its_name_and_the_parameters_do(pair) -> None:
    keys = [key(pair), key(pair, Choice(2))]
    pair.write_text("other points")
    keys.append(key(pair))
    named = pair.rename(pair.with_name("left.pts"))
    keys.append(key(named))
    assert len(set(keys)) == 4


@pytest.mark.parametrize("suffix", [".elem", ".dat"])
def test_so_do_the_files_that_belong_to_it(pair, suffix) -> None:
    before = key(pair)
    pair.with_name(f"atrium_voltage{suffix}" if suffix == ".dat" else "atrium.elem").write_text("x")
    assert key(pair) != before


def test_so_do_the_slices_of_a_folder_and_their_names(tmp_path) -> None:
    scan = tmp_path / "scan"
    scan.mkdir()
    (scan / "1").write_text("slice")
    digests = [input_digest(str(scan))]
    (scan / "1").rename(scan / "2")
    digests.append(input_digest(str(scan)))
    (scan / "1").write_text("slice")
    digests.append(input_digest(str(scan)))
    assert len(set(digests)) == 3


def test_so_does_code_that_can_enter_a_number_and_no_other(pair, tmp_path, monkeypatch) -> None:
    package = tmp_path / "auricle"
    for room in ("spectral", "report", "study/cohort"):
        (package / room).mkdir(parents=True)
        (package / room / "module.py").write_text("a = 1")
    monkeypatch.setattr(identity.auricle, "__file__", str(package / "__init__.py"))
    keys = []
    for room in ("nothing", "report", "study/cohort", "spectral"):
        if room != "nothing":
            (package / room / "module.py").write_text("a = 2")
        identity.code_digest.cache_clear()
        keys.append(key(pair))
    identity.code_digest.cache_clear()
    assert keys[0] == keys[1] == keys[2] != keys[3]


def test_an_input_that_cannot_be_read_is_told(tmp_path) -> None:
    with pytest.raises(InputError, match=r"gone\.vtp: No such file"):
        key(tmp_path / "gone.vtp")


def test_a_case_has_the_same_name_in_a_shard_as_in_the_study(tmp_path) -> None:
    study = [str(tmp_path / patient / "left.vtp") for patient in ("p1", "p2")]
    for place in study:
        (tmp_path / place).parent.mkdir()
        (tmp_path / place).write_text(place)
    whole = identified(study, Choice())
    assert identified(study[1:], Choice(), among=study) == whole[1:]


def test_what_is_left_out_of_the_hash_is_not_loaded_by_a_case() -> None:
    code = (
        "import sys, auricle.study.paper.case\n"
        "print(*(name for name in sys.modules if name.startswith('auricle.')))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = [name.removeprefix("auricle.").replace(".", "/") for name in done.stdout.split()]
    left_out = [part.removesuffix("/").removesuffix(".py") for part in identity.NOT_OF_A_CASE]
    assert "study/paper/conventions" in loaded
    assert not [name for name in loaded if name.startswith(tuple(left_out))]
