"""The header of a PLY file, and its body held against it."""

from dataclasses import dataclass, field
from typing import BinaryIO

from auricle.errors import FormatError
from auricle.surface.formats.header import (
    Header,
    count_of,
    damaged,
    require_bytes,
    shown,
    space_in,
    unit_in,
)
from auricle.surface.formats.number_text import numbers_in

_LONGEST_LINE = 4096
_MOST_LINES = 10_000
NO_FIELDS = frozenset((*"xyz", "nx", "ny", "nz", "red", "green", "blue", "alpha"))
"""Vertex properties that are positions, normals and colours."""
FACE_LISTS = ("vertex_indices", "vertex_index")
_FORMATS = (b"ascii", b"binary_little_endian", b"binary_big_endian")
_BYTES_OF = {
    **dict.fromkeys(("char", "uchar", "int8", "uint8"), 1),
    **dict.fromkeys(("short", "ushort", "int16", "uint16"), 2),
    **dict.fromkeys(("int", "uint", "int32", "uint32", "float", "float32"), 4),
    **dict.fromkeys(("double", "float64", "int64", "uint64"), 8),
}


@dataclass(frozen=True)
class _Property:
    """One number a record, or a list led by its length.

    `width` is that number's in bytes, `entry` that of an entry of the list, 0 without one.
    """

    width: int
    entry: int = 0


@dataclass(frozen=True)
class _Element:
    """A kind of record: how many there are and what each holds, in order."""

    count: int
    properties: dict[str, _Property] = field(default_factory=dict)

    def names(self, *, lists: bool) -> tuple[str, ...]:
        """Names of the lists, or of the single numbers."""
        return tuple(name for name, held in self.properties.items() if bool(held.entry) == lists)

    def smallest_size(self, *, is_text: bool) -> int:
        """Fewest bytes of all records: a face has three corners, other lists may be empty."""
        record = 0
        for name, held in self.properties.items():
            entries = 3 if name in FACE_LISTS and held.entry else 0
            record += 2 * (1 + entries) if is_text else held.width + entries * held.entry
        return self.count * record

    def numbers(self, words: list[bytes]) -> int:
        """How many numbers the record that begins with `words` has."""
        place = 0
        for held in self.properties.values():
            if held.entry:
                length = words[place] if place < len(words) else b"0"
                place += count_of(length, "entries of a list")
            place += 1
        return place


def ply_header(file: BinaryIO, size: int) -> Header:
    """Read the header of a PLY file and hold the body against it.

    Parameters
    ----------
    file
        Open in binary mode, at its start.
    size
        Its length in bytes.

    Raises
    ------
    FormatError
        If the file is not PLY, its header cannot be understood or its body is too short for it;
        in a text body, if a line holds anything but as many numbers as its element has.
    """
    if file.readline(_LONGEST_LINE).strip() != b"ply":
        raise FormatError("is not a PLY file: check the suffix")
    encoding, comments, elements = _header_lines(file)
    vertex, face = _surface_elements(elements)
    is_text = encoding == b"ascii"
    needed = sum(element.smallest_size(is_text=is_text) for element in elements.values())
    counts = ", ".join(f"{element.count} {shown(name)}" for name, element in elements.items())
    require_bytes(counts, needed=max(needed - is_text, 0), left=size - file.tell())
    if is_text:
        _check_lines(file, elements)
    units: dict[str, str] = {}
    for comment in comments:
        units.update(unit_in(comment))
    return Header(vertex.count, face.count, space=space_in(b"\n".join(comments)), units=units)


def _header_lines(file: BinaryIO) -> tuple[bytes, list[bytes], dict[str, _Element]]:
    encoding = b""
    comments: list[bytes] = []
    elements: dict[str, _Element] = {}
    for _ in range(_MOST_LINES):
        words = file.readline(_LONGEST_LINE).split()
        match words:
            case [b"end_header"]:
                if encoding not in _FORMATS:
                    raise damaged(f"says {shown(encoding)} where its PLY format should be")
                return encoding, comments, elements
            case [b"format", encoding, b"1.0"]:
                pass
            case [b"comment" | b"obj_info", *rest] if b"end_header" not in rest:
                comments.append(b" ".join(rest))
            case [b"element", name, count]:
                _add_element(elements, _text(name), count)
            case [b"property", *rest] if elements:
                _add_property(list(elements.values())[-1], rest)
            case _:
                raise damaged(f"holds {shown(b' '.join(words))} in its PLY header")
    raise damaged(f"has no end_header in its first {_MOST_LINES} lines")


def _add_element(elements: dict[str, _Element], name: str, count: bytes) -> None:
    if name in elements:
        raise damaged(f"announces element {shown(name)} twice")
    elements[name] = _Element(count_of(count, f"{name} elements"))


def _add_property(element: _Element, words: list[bytes]) -> None:
    match [_text(word) for word in words]:
        case ["list", count_kind, kind, name] if kind in _BYTES_OF and count_kind in _BYTES_OF:
            held = _Property(_BYTES_OF[count_kind], entry=_BYTES_OF[kind])
        case [kind, name] if kind in _BYTES_OF:
            held = _Property(_BYTES_OF[kind])
        case _:
            raise damaged(f"holds the property {shown(b' '.join(words))}")
    if name in element.properties:
        raise damaged(f"announces property {shown(name)} twice")
    element.properties[name] = held


def _surface_elements(elements: dict[str, _Element]) -> tuple[_Element, _Element]:
    for kind in ("vertex", "face"):
        if kind not in elements:
            raise FormatError(f"holds no {kind} element, so no surface: export the triangles too")
    vertex, face = elements["vertex"], elements["face"]
    missing = [axis for axis in "xyz" if axis not in vertex.names(lists=False)]
    if missing:
        raise damaged(f"lacks the vertex property {' and '.join(missing)}")
    if not any(name in face.names(lists=True) for name in FACE_LISTS):
        raise damaged("lacks the list vertex_indices of its faces")
    return vertex, face


def _check_lines(file: BinaryIO, elements: dict[str, _Element]) -> None:
    for name, element in elements.items():
        for record in range(element.count):
            line = file.readline()
            if not line:
                raise damaged(f"ends after {record} of {element.count} lines of {shown(name)}")
            found = numbers_in(line, f"{shown(name)} {record}")
            expected = element.numbers(line.split())
            if found != expected:
                raise damaged(f"holds {found} of the {expected} numbers of {shown(name)} {record}")
    if file.read().strip():
        raise damaged("goes on after its last element")


def _text(word: bytes) -> str:
    return word.decode("utf-8", "backslashreplace")
