"""Dropped folders and files come over as they are, and lead nowhere else."""

import json
from pathlib import Path

import pytest

from auricle.errors import FormatError, InputError
from auricle.surface.shapes import icosphere
from auricle.surface.writing import write_surface
from auricle.viewer.dropped_files import unpacked
from auricle.viewer.open_case import OpenCase
from auricle.viewer.opening import Detail, open_path
from auricle.viewer.workspace import Workspace


def packed(place: Path, files: list[tuple[str, bytes]], *, extra: bytes = b"") -> Path:
    listed = json.dumps([[path, len(content)] for path, content in files])
    content = listed.encode() + b"\n" + b"".join(content for _, content in files) + extra
    (place / "packed").write_bytes(content)
    return place / "packed"


def test_a_folder_comes_over_whole(tmp_path: Path) -> None:
    files = [("ct/a/1.dcm", b"\x00\n1"), ("ct/a/2.dcm", b""), ("ct/note", b"n" * 3_000_000)]
    folder = unpacked(packed(tmp_path, files), tmp_path / "files")
    assert folder == tmp_path / "files" / "ct"
    found = {
        each.relative_to(tmp_path / "files").as_posix(): each.read_bytes()
        for each in folder.rglob("*")
        if each.is_file()
    }
    assert found == dict(files)


def test_no_name_leads_out_of_the_folder(tmp_path: Path) -> None:
    names = ["../../evil", "/etc/passwd", "a/../../b", "C:\\x\\y"]
    (tmp_path / "in").mkdir()
    unpacked(packed(tmp_path, [(name, b"x") for name in names]), tmp_path / "in" / "files")
    written = [each for each in tmp_path.rglob("*") if each.is_file()]
    outside = [each for each in written if tmp_path / "in" / "files" not in each.parents]
    assert outside == [tmp_path / "packed"]
    assert len(written) == 1 + len(names)


@pytest.mark.parametrize(
    ("files", "extra", "fault"),
    [
        ([("a", b"1"), ("a", b"2")], b"", InputError),
        ([("a", b"1"), ("a/b", b"2")], b"", InputError),
        ([("a:", b"1"), ("a", b"2")], b"", InputError),
        ([("", b"1")], b"", InputError),
        ([], b"", InputError),
        ([("a", b"1")], b"more than was told", FormatError),
    ],
)
def test_what_does_not_fit_together_is_refused_before_anything_is_written(
    tmp_path: Path, files: list[tuple[str, bytes]], extra: bytes, fault: type[Exception]
) -> None:
    with pytest.raises(fault, match="drop"):
        unpacked(packed(tmp_path, files, extra=extra), tmp_path / "files")
    assert not (tmp_path / "files").exists()


@pytest.mark.parametrize("line", [b"", b"[]\n", b"{}\n", b'[["a", -1]]\n', b'[["a"]]\n', b"[1]\n"])
def test_a_damaged_list_is_refused(tmp_path: Path, line: bytes) -> None:
    (tmp_path / "packed").write_bytes(line)
    with pytest.raises((FormatError, InputError), match="drop"):
        unpacked(tmp_path / "packed", tmp_path / "files")


def test_loose_files_open_as_the_one_case_among_them(tmp_path: Path) -> None:
    ball = icosphere(radius=20.0, subdivisions=2)
    folder, workspace = tmp_path / "loose", Workspace(tmp_path / "uploads")
    folder.mkdir()
    write_surface(folder / "ball.vtp", ball)
    (folder / "samples.csv").write_text("x,y,z,LAT\n20,0,0,5\n")
    open_path(workspace, folder, Detail(162, 20))
    assert workspace.name == "ball.vtp"
    before = workspace.require(OpenCase, "none")
    write_surface(folder / "other.ply", ball)
    with pytest.raises(InputError, match="one case at a time"):
        open_path(workspace, folder)
    assert workspace.find(OpenCase) is before
