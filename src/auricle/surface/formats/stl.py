"""The two kinds of STL file, told apart by size and held against what they announce."""

from typing import BinaryIO

from auricle.surface.formats.header import UNKNOWN_SPACE, Header, damaged, shown, space_in
from auricle.surface.formats.number_text import numbers_in

HEADER_BYTES = 80
FACET_BYTES = 50
_LONGEST_LINE = 4096
_NUMBERS_AFTER = {b"facet": 2, b"vertex": 1}
_FACET = (b"facet", b"outer", b"vertex", b"vertex", b"vertex", b"endloop", b"endfacet")


def stl_header(file: BinaryIO, size: int) -> Header:
    """Count the facets of an STL file, binary or text.

    A binary file has exactly 84 + 50 n bytes; a file of another size that begins with ``solid``
    is read as text, line by line.

    Parameters
    ----------
    file
        Open in binary mode, at its start.
    size
        Its length in bytes.

    Raises
    ------
    FormatError
        If the size is not the one announced, or the text does not follow the grammar.
    """
    start = file.read(HEADER_BYTES + 4)
    facets = _announced(start)
    if is_binary_stl(start, size):
        return Header(3 * facets, facets, space=space_in(start[:HEADER_BYTES]))
    if not start.lstrip().lower().startswith(b"solid"):
        expected = HEADER_BYTES + 4 + FACET_BYTES * facets
        raise damaged(
            f"announces {facets:,} facets, {expected:,} bytes of binary STL, and holds {size:,}"
        )
    file.seek(0)
    return _text_header(file)


def is_binary_stl(start: bytes, size: int) -> bool:
    """Whether a file of `size` bytes that begins with `start`, 84 bytes of it, is binary STL."""
    return size == HEADER_BYTES + 4 + FACET_BYTES * _announced(start)


def _announced(start: bytes) -> int:
    return int.from_bytes(start[HEADER_BYTES : HEADER_BYTES + 4], "little")


def _text_header(file: BinaryIO) -> Header:
    lines, facets, inside, space = 0, 0, False, UNKNOWN_SPACE
    while line := file.readline(_LONGEST_LINE):
        words = line.lower().split()
        if not words:
            continue
        if lines == 0 and words[0] == (b"endsolid" if inside else b"solid"):
            space = space_in(line) if space == UNKNOWN_SPACE else space
            inside = not inside
            continue
        _check_line(line, words, _FACET[lines] if inside else b"solid")
        lines = (lines + 1) % len(_FACET)
        facets += lines == 0
    if inside or lines:
        raise damaged(f"ends within a solid, after {facets} facets")
    return Header(3 * facets, facets, space=space)


def _check_line(line: bytes, words: list[bytes], keyword: bytes) -> None:
    if words[0] != keyword or keyword == b"solid":
        raise damaged(f"holds {shown(line)} where {keyword.decode()} should be")
    first = _NUMBERS_AFTER.get(keyword)
    if first is not None and numbers_in(b" ".join(words[first:]), "coordinates") != 3:
        raise damaged(f"holds {shown(line)}, not three coordinates")


def stripped_stl(content: bytes) -> bytes:
    """Give the same facets in one nameless solid, and binary content as it is.

    A parser that looks for ``vertex`` and ``solid`` anywhere stumbles over the names of solids.
    """
    if is_binary_stl(content[: HEADER_BYTES + 4], len(content)):
        return content
    lines = (line.strip().lower() for line in content.splitlines())
    corners = (line for line in lines if line.startswith(b"vertex"))
    return b"\n".join([b"solid", *corners, b"endsolid", b""])
