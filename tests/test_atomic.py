"""Files are whole or absent."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from auricle.atomic import write_text, write_whole
from auricle.errors import OutputError


def test_a_failing_writer_leaves_the_old_file_and_nothing_else(tmp_path) -> None:
    place = tmp_path / "result.json"
    write_text(place, "old")

    def half(path: Path) -> None:
        path.write_text("ne")
        raise OSError(28, "No space left on device")

    with pytest.raises(OutputError, match="No space left"):
        write_whole(place, half)
    assert place.read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["result.json"]


def test_any_other_fault_of_the_writer_also_leaves_nothing(tmp_path) -> None:
    def broken(path: Path) -> None:
        path.write_text("x")
        raise ValueError("bug")

    with pytest.raises(ValueError, match="bug"):
        write_whole(tmp_path / "out", broken)
    assert list(tmp_path.iterdir()) == []


def test_a_place_inside_a_file_is_refused_in_one_line(tmp_path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot be written") as fault:
        write_text(tmp_path / "file" / "out", "text")
    assert "\n" not in str(fault.value)


def test_a_written_file_has_the_usual_permissions(tmp_path) -> None:
    write_text(tmp_path / "ours", "text")
    (tmp_path / "theirs").write_text("text")
    assert (tmp_path / "ours").stat().st_mode == (tmp_path / "theirs").stat().st_mode


@pytest.mark.skipif(os.name != "posix", reason="kill -9 is POSIX")
def test_a_killed_writer_leaves_the_old_or_the_new_file(tmp_path) -> None:
    place = tmp_path / "result.txt"
    letters = {character * 200_000 for character in "abcdefghij"}
    program = (
        "import itertools, pathlib, sys\n"
        "from auricle.atomic import write_text\n"
        "for letter in itertools.cycle('abcdefghij'):\n"
        "    write_text(pathlib.Path(sys.argv[1]), letter * 200_000)\n"
    )
    for tenth in range(6):
        writer = subprocess.Popen([sys.executable, "-c", program, str(place)])
        while not place.exists():
            time.sleep(0.01)
        time.sleep(0.013 * tenth)
        writer.send_signal(signal.SIGKILL)
        writer.wait()
        assert place.read_text() in letters
