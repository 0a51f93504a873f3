"""The lines of an OFF file, held against the counts they begin with."""

from collections.abc import Iterator
from typing import BinaryIO

from auricle.errors import FormatError
from auricle.surface.formats.header import Header, count_of, damaged, require_bytes, shown
from auricle.surface.formats.number_text import numbers_in
from auricle.surface.formats.polygons import fan, fanned_remark

_LONGEST_LINE = 1 << 20
_KEYWORDS = (b"OFF", b"COFF")


def off_header(file: BinaryIO, size: int) -> Header:
    """Read the counts of an OFF file and hold its lines against them.

    Parameters
    ----------
    file
        Open in binary mode, at its start.
    size
        Its length in bytes.

    Raises
    ------
    FormatError
        If the file does not begin with OFF or COFF, holds other than the announced lines, or a
        line is not made of numbers.
    """
    lines = _lines(file)
    keyword, *counts = next(lines, [b""])
    if keyword.upper() not in _KEYWORDS:
        raise FormatError(f"begins with {shown(keyword)}, not with OFF: check the suffix")
    counts = counts or next(lines, [])
    if len(counts) not in (2, 3):
        raise damaged(f"gives the counts {shown(b' '.join(counts))}")
    vertices, faces = count_of(counts[0], "vertices"), count_of(counts[1], "faces")
    what = f"{vertices:,} vertices and {faces:,} faces"
    require_bytes(what, needed=6 * vertices + 8 * faces - 1, left=size - file.tell())
    for vertex in range(vertices):
        _check_vertex(next(lines, []), vertex)
    corners = [_corners(next(lines, []), face) for face in range(faces)]
    if next(lines, None) is not None:
        raise damaged(f"goes on after {what}")
    polygons = sum(count > 3 for count in corners)
    remarks = (fanned_remark(polygons),) if polygons else ()
    return Header(vertices, sum(corners) - 2 * faces, remarks=remarks)


def stripped_off(file: BinaryIO) -> bytes:
    """Give the same vertices and faces and nothing else, polygons cut into triangles."""
    lines = _lines(file)
    counts = next(lines)[1:] or next(lines)
    vertices, faces = int(counts[0]), int(counts[1])
    kept = [b" ".join(next(lines)[:3]) for _ in range(vertices)]
    for _ in range(faces):
        words = next(lines)
        corners = words[1 : int(words[0]) + 1]
        kept += (b"3 " + b" ".join(triangle) for triangle in fan(corners))
    head = b"OFF\n%d %d 0" % (vertices, len(kept) - vertices)
    return b"\n".join([head, *kept])


def _lines(file: BinaryIO) -> Iterator[list[bytes]]:
    """Words of the lines that hold any, without comments."""
    while line := file.readline(_LONGEST_LINE):
        words = line.partition(b"#")[0].split()
        if words:
            yield words


def _check_vertex(words: list[bytes], vertex: int) -> None:
    if numbers_in(b" ".join(words), f"the position of vertex {vertex}") < 3:
        raise damaged(f"ends, or has no three coordinates, at vertex {vertex}")


def _corners(words: list[bytes], face: int) -> int:
    held = numbers_in(b" ".join(words), f"face {face}")
    count = count_of(words[0], f"corners of face {face}") if words else 0
    if count < 3 or held < count + 1:
        raise damaged(f"ends, or has fewer than three corners, at face {face}")
    return count
