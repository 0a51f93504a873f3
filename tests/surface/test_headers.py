from collections.abc import Callable
from contextlib import suppress
from io import BytesIO
from pathlib import Path
from typing import BinaryIO

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from auricle.errors import FormatError
from auricle.surface.field import FieldMap
from auricle.surface.formats.header import (
    MOST_CELLS,
    MOST_VERTICES,
    Header,
    count_of,
    require_bytes,
    shown,
    space_in,
    unit_in,
)
from auricle.surface.formats.legacy_vtk import legacy_vtk_header
from auricle.surface.formats.number_text import first_other_word, numbers_in, rows_of_numbers
from auricle.surface.formats.obj import obj_header
from auricle.surface.formats.off import off_header
from auricle.surface.formats.ply import ply_header
from auricle.surface.formats.ply_writing import ply_bytes
from auricle.surface.formats.stl import stl_header
from auricle.surface.formats.stl_writing import stl_bytes
from auricle.surface.formats.vtp_writing import vtp_bytes
from auricle.surface.formats.xml_vtk import vtp_header
from auricle.surface.mesh import Mesh
from auricle.surface.reading import read_surface

TETRAHEDRON = Mesh(
    np.array([[0.0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]]),
    np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]),
)
TIMES = FieldMap(TETRAHEDRON, np.array([1.0, 2, np.nan, 4]), "lat", "ms")
TAGS = np.array([1, 2, 3, 4])
ROWS = b"0 0 0\n9 0 0\n0 9 0\n0 0 9\n"
LISTS = b"3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"
VTK_TEXT = (
    b"# vtk DataFile Version 3.0\nSPACE=LPS\nASCII\nDATASET POLYDATA\nFIELD about 1\n"
    b"UNITS 1 1 string\nlat=ms\nPOINTS 4 float\n" + ROWS + b"POLYGONS 4 16\n" + LISTS
    + b"POINT_DATA 4\nSCALARS lat double 1\nLOOKUP_TABLE default\n1 2 3 4\n"
    b"VECTORS v float\n" + ROWS + b"FIELD more 1\nage 2 4 int\n1 2 3 4 5 6 7 8\n"
    b"CELL_DATA 4\nCOLOR_SCALARS c 1\n0 0 0 1\nTEXTURE_COORDINATES t 1 float\n1 2 3 4\n"
)  # fmt: skip
VTK_BINARY = (
    b"# vtk DataFile Version 5.1\nSPACE=LPS\nBINARY\nDATASET POLYDATA\nFIELD about 1\n"
    b"UNITS 1 1 string\n\xc6lat=ms\nPOINTS 4 double\n"
    + TETRAHEDRON.vertices.astype(">f8").tobytes()
    + b"\nPOLYGONS 5 12\nOFFSETS vtktypeint64\n"
    + np.arange(0, 13, 3).astype(">i8").tobytes()
    + b"\nCONNECTIVITY vtktypeint64\n"
    + TETRAHEDRON.faces.astype(">i8").tobytes()
    + b"\nPOINT_DATA 4\nFIELD more 1\non 1 4 bit\n\xf0\n"
)
PLY_TEXT = (
    b"ply\nformat ascii 1.0\ncomment SPACE=LPS\nelement vertex 4\nproperty float x\n"
    b"property float y\nproperty float z\nelement face 4\n"
    b"property list uchar int vertex_indices\nend_header\n" + ROWS + LISTS
)
STL_TEXT = b"solid SPACE=LPS\n" + 4 * (
    b"facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 9 0 0\nvertex 0 9 0\nendloop\nendfacet\n"
) + b"endsolid\n"  # fmt: skip
OBJ = (
    b"# SPACE=LPS\nv "
    + ROWS.strip().replace(b"\n", b"\nv ")
    + b"\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4"
)

Check = Callable[[BinaryIO, int], Header]
WHOLE: dict[str, tuple[Check, bytes, int]] = {
    "legacy VTK, text": (legacy_vtk_header, VTK_TEXT, 4),
    "legacy VTK, binary": (legacy_vtk_header, VTK_BINARY, 4),
    "VTK XML": (vtp_header, vtp_bytes(TETRAHEDRON, [TIMES], space="LPS", tags=TAGS), 4),
    "PLY, text": (ply_header, PLY_TEXT, 4),
    "PLY, binary": (ply_header, ply_bytes(TETRAHEDRON, [TIMES], space="LPS", tags=TAGS), 4),
    "STL, text": (stl_header, STL_TEXT, 12),
    "STL, binary": (stl_header, stl_bytes(TETRAHEDRON, space="LPS"), 12),
    "OBJ": (obj_header, OBJ, 4),
    "OFF": (off_header, b"OFF\n4 4 6\n" + ROWS + LISTS, 4),
}
OPTIONAL = [b"POINT_DATA", b"CELL_DATA", b"SCALARS", b"VECTORS", b"FIELD", b"COLOR_SCALARS"]
OPTIONAL += [b"TEXTURE_COORDINATES"]
COUNTED = [name for name in WHOLE if name != "OBJ"]


def check(name: str, content: bytes) -> Header:
    return WHOLE[name][0](BytesIO(content), len(content))


@pytest.mark.parametrize("name", WHOLE)
def test_a_header_tells_vertices_faces_and_axes(name: str) -> None:
    header = check(name, WHOLE[name][1])
    assert (header.vertices, header.cells) == (WHOLE[name][2], 4)
    assert header.space == ("unknown" if name in ("VTK XML", "OFF") else "LPS")


def test_units_stand_in_the_comments_of_ply() -> None:
    assert check("PLY, binary", WHOLE["PLY, binary"][1]).units == {"lat": "ms"}


@pytest.mark.parametrize("name", COUNTED)
def test_no_beginning_of_a_file_passes_for_the_whole(name: str) -> None:
    content = WHOLE[name][1].removesuffix(b"</VTKFile>\n").rstrip(b"\n")
    for end in range(len(content)):
        following = content[end:].split()
        if end and name.startswith("legacy") and following and following[0] in OPTIONAL:
            continue  # nothing in a legacy file tells that another section should follow
        with pytest.raises(FormatError):
            check(name, content[:end])


def changed(content: bytes, places: list[int], noise: bytes) -> bytes:
    """Overwrite, insert or cut at a few places."""
    for place, byte in zip(places, noise, strict=False):
        at = place % len(content)
        new = (bytes([byte]), b"", b"-", b"99999999999", b"\n", b"\xff\xff")[byte % 6]
        content = content[:at] + new + content[at + place % 3 :] or b"x"
    return content


@given(
    name=st.sampled_from(list(WHOLE)),
    places=st.lists(st.integers(0, 10_000), min_size=1, max_size=6),
    noise=st.binary(min_size=6, max_size=6),
)
def test_noise_in_a_file_costs_a_format_error_or_nothing(
    name: str, places: list[int], noise: bytes
) -> None:
    content = changed(WHOLE[name][1], places, noise)
    with suppress(FormatError):
        header = check(name, content)
        assert 0 < header.vertices <= len(content)
        assert 0 < header.cells <= len(content)


@example(places=[0, 62], noise=b"\x01\x1e\0\0\0\0", which=".dat")
@given(
    places=st.lists(st.integers(0, 10_000), min_size=1, max_size=4),
    noise=st.binary(min_size=6, max_size=6),
    which=st.sampled_from([".pts", ".elem", ".dat"]),
)
def test_noise_in_an_opencarp_pair_costs_a_format_error_or_nothing(
    places: list[int], noise: bytes, which: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = tmp_path_factory.mktemp("pair")
    files = {
        ".pts": b"4\n" + ROWS,
        ".elem": b"2\nTr 0 1 2 11\nTr 0 2 3 13\n",
        ".dat": b"1\n2\n3\n4\n",
    }
    files[which] = changed(files[which], places, noise)
    for suffix, content in files.items():
        (folder / f"la{suffix}").write_bytes(content)
    with suppress(FormatError):
        soup = read_surface(folder / "la.pts")
        assert soup.vertices.shape == (len(soup.point_fields["la"]), 3)


def test_a_header_of_nothing_or_of_too_much_is_refused() -> None:
    Header(MOST_VERTICES, MOST_CELLS)
    for vertices, cells in ((0, 1), (1, 0), (MOST_VERTICES + 1, 1), (1, MOST_CELLS + 1)):
        with pytest.raises(FormatError):
            Header(vertices, cells)


def test_an_stl_beyond_the_limits_is_refused_by_its_size_alone(tmp_path: Path) -> None:
    facets = MOST_VERTICES // 3 + 1
    with (tmp_path / "a.stl").open("wb+") as file:
        file.write(bytes(80) + facets.to_bytes(4, "little"))
        file.truncate(84 + 50 * facets)
        file.seek(0)
        with pytest.raises(FormatError, match="the limit is 20,000,000"):
            stl_header(file, 84 + 50 * facets)


@given(st.lists(st.floats(width=64), max_size=9))
def test_every_number_python_writes_counts_as_a_number(values: list[float]) -> None:
    line = " ".join(map(repr, values)).encode()
    assert first_other_word(line) is None
    assert numbers_in(line, "values") == len(values)


@pytest.mark.parametrize(
    "word", ["0,5", "1.2.3", "--1", "1e", "e5", "0x1f", "1_000", ".", "nano", "1;2"]
)
def test_what_a_lenient_parser_would_read_in_part_is_no_number(word: str) -> None:
    assert first_other_word(f"1 2 {word} 3".encode()) == word.encode()
    with pytest.raises(FormatError, match="where values should be"):
        numbers_in(word.encode(), "values")


@pytest.mark.parametrize("word", ["-5", "", "5.0", "1e3", "٣", "9" * 16, "0x10", "+3"])
def test_a_count_is_plain_digits_or_refused(word: str) -> None:
    with pytest.raises(FormatError, match="number of vertices"):
        count_of(word, "vertices")


def test_a_count_may_fill_the_rest_of_a_file_and_no_more() -> None:
    require_bytes("a table", needed=10, left=10)
    with pytest.raises(FormatError, match="11 bytes or more, with 10 bytes left"):
        require_bytes("a table", needed=11, left=10)


@given(st.binary(max_size=200))
def test_foreign_bytes_are_shown_in_one_short_line(words: bytes) -> None:
    assert shown(words).isprintable()
    assert len(shown(words)) <= 50


def test_axes_and_units_are_found_among_other_words() -> None:
    assert space_in(b"3D Slicer output. SPACE=RAS; units mm") == "RAS"
    assert space_in("AEROSPACE=LPS") == "unknown"
    assert unit_in("UNITS=a=b=mV") == {"a=b": "mV"}
    assert unit_in("made in UNITS") == {}


@pytest.mark.parametrize("space", [b"\x1c", b"\x1e", b"\x1f", b"\x85", b"\xa0", b""])
@pytest.mark.parametrize("around", [[], [b"1 2"], [b"1 2", b"3 4"]])
def test_a_line_of_no_number_is_not_left_out(space: bytes, around: list[bytes]) -> None:
    for place in range(len(around) + 1):
        with pytest.raises(ValueError, match=r"hold numbers|no data"):
            rows_of_numbers([*around[:place], space, *around[place:]], encoding="latin-1")
