"""The lines of a Wavefront OBJ file, checked and stripped to positions and polygons."""

import re
from collections import Counter
from collections.abc import Iterator
from typing import BinaryIO

from auricle.errors import FormatError
from auricle.surface.formats.header import UNKNOWN_SPACE, Header, damaged, shown, space_in
from auricle.surface.formats.number_text import numbers_in
from auricle.surface.formats.polygons import fan, fanned_remark

_LONGEST_LINE = 1 << 20
_CORNER = re.compile(rb"(-?\d{1,15})(?:/-?\d*){0,2}")
_PASSED_OVER = frozenset(
    b"vt vn vp g o s mg usemtl mtllib usemap maplib shadow_obj trace_obj lod bevel"
    b" c_interp d_interp".split()
)
_LEFT_OUT = frozenset((b"l", b"p"))


def obj_header(file: BinaryIO, _size: int) -> Header:
    """Count the vertices and the triangles of an OBJ file, checking every line.

    Only positions and faces matter; lines and points are left out with a remark.

    Parameters
    ----------
    file
        Open in binary mode, at its start.

    Raises
    ------
    FormatError
        If a line is none that a polygonal OBJ file has, a coordinate is not a number, a face has
        fewer than three corners, or an index is 0, counts backwards or is beyond the vertices.
    """
    space, tally, greatest = UNKNOWN_SPACE, Counter[str](), 0
    for words in _lines(file):
        if words[0].startswith(b"#"):
            space = space_in(b" ".join(words)) if space == UNKNOWN_SPACE else space
        elif words[0] == b"f":
            corners = [_index(word) for word in words[1:]]
            greatest = max(greatest, *corners)
            tally.update(triangles=len(corners) - 2, polygons=len(corners) > 3)
        else:
            tally[_kind(words)] += 1
    if greatest > tally["vertices"]:
        raise damaged(f"names vertex {greatest} of {tally['vertices']}")
    return Header(tally["vertices"], tally["triangles"], space=space, remarks=_remarks(tally))


def stripped_obj(file: BinaryIO) -> bytes:
    """Give the same vertices and faces and nothing else, polygons cut into triangles.

    A parser that minds texture coordinates splits the vertices along their seams.
    """
    kept: list[bytes] = []
    for words in _lines(file):
        if words[0] == b"v":
            kept.append(b" ".join(words[:4]))
        elif words[0] == b"f":
            corners = [word.partition(b"/")[0] for word in words[1:]]
            kept += (b"f " + b" ".join(triangle) for triangle in fan(corners))
    return b"\n".join(kept)


def _lines(file: BinaryIO) -> Iterator[list[bytes]]:
    """Words of the lines that hold any; faces have three or more; a backslash joins two lines."""
    joined = b""
    while line := file.readline(_LONGEST_LINE):
        joined += line.rstrip()
        if joined.endswith(b"\\") and len(joined) < _LONGEST_LINE:
            joined = joined[:-1] + b" "
            continue
        comment = joined.lstrip().startswith(b"#")
        words = (joined if comment else joined.partition(b"#")[0]).split()
        joined = b""
        if words and words[0] == b"f" and len(words) < 4:
            raise damaged(f"holds the face {shown(b' '.join(words))} of fewer than three corners")
        if words:
            yield words


def _index(word: bytes) -> int:
    found = _CORNER.fullmatch(word)
    if found is None:
        raise damaged(f"holds {shown(word)} where the corner of a face should be")
    index = int(found[1])
    if index < 1:
        raise FormatError(
            f"names vertex {index}, but OBJ counts from 1 and auricle reads no indices relative "
            "to the end: export it with absolute indices"
        )
    return index


def _kind(words: list[bytes]) -> str:
    if words[0] == b"v":
        if numbers_in(b" ".join(words[1:]), "a position") < 3:
            raise damaged(f"holds {shown(b' '.join(words))}, not three coordinates")
        return "vertices"
    if words[0] in _LEFT_OUT:
        return "left out"
    if words[0] in _PASSED_OVER:
        return "passed over"
    raise damaged(f"holds the line {shown(b' '.join(words))}, which no polygonal OBJ file has")


def _remarks(tally: Counter[str]) -> tuple[str, ...]:
    remarks = []
    if tally["polygons"]:
        remarks.append(fanned_remark(tally["polygons"]))
    if tally["left out"]:
        remarks.append(f"{tally['left out']} lines and points left out: not faces")
    return tuple(remarks)
