"""The sections of a legacy VTK file, walked from end to end without reading a value into a mesh.

Layout after the VTK file formats guide, versions 1.0 to 5.1 (lists of cells as OFFSETS and
CONNECTIVITY from 5.0 on).
"""

import re
from array import array
from collections.abc import Callable
from typing import BinaryIO

import numpy as np

from auricle.arrays import Integers
from auricle.errors import FormatError
from auricle.surface.formats.header import (
    Header,
    count_of,
    damaged,
    require_bytes,
    shown,
    space_in,
)
from auricle.surface.formats.number_text import numbers_in

_LONGEST_LINE = 4096
_BYTES_OF = {
    **dict.fromkeys(("char", "signed_char", "unsigned_char", "vtktypeint8", "vtktypeuint8"), 1),
    **dict.fromkeys(("short", "unsigned_short", "vtktypeint16", "vtktypeuint16"), 2),
    **dict.fromkeys(("int", "unsigned_int", "float", "vtkidtype"), 4),
    **dict.fromkeys(("vtktypeint32", "vtktypeuint32", "vtktypefloat32"), 4),
    **dict.fromkeys(("long", "unsigned_long", "long_long", "unsigned_long_long", "double"), 8),
    **dict.fromkeys(("vtktypeint64", "vtktypeuint64", "vtktypefloat64"), 8),
}
_COMPONENTS = {
    "VECTORS": 3,
    "NORMALS": 3,
    "TENSORS": 9,
    "TENSORS6": 6,
    "GLOBAL_IDS": 1,
    "PEDIGREE_IDS": 1,
    "EDGE_FLAGS": 1,
}
_VOLUMES = ("STRUCTURED_POINTS", "STRUCTURED_GRID", "RECTILINEAR_GRID")


def legacy_vtk_header(file: BinaryIO, size: int) -> Header:
    """Walk a legacy VTK file and hand back what it holds.

    Parameters
    ----------
    file
        Open in binary mode, at its start.
    size
        Its length in bytes.

    Raises
    ------
    FormatError
        If the file is not a legacy VTK surface, or its counts and its bytes disagree anywhere.
    """
    version = _version(file.readline(_LONGEST_LINE))
    title = file.readline(_LONGEST_LINE)
    encoding = file.readline(_LONGEST_LINE).strip().upper()
    if encoding not in (b"ASCII", b"BINARY"):
        raise damaged(f"says {shown(encoding)} where ASCII or BINARY should be")
    walk = _Walk(file, size, binary=encoding == b"BINARY", lists=version[0] < 5)
    walk.to_the_end()
    return Header(walk.points, walk.cells, space=space_in(title))


def _version(line: bytes) -> tuple[int, int]:
    found = re.match(rb"#\s*vtk\s+datafile\s+version\s+(\d+)\.(\d+)\s*$", line.strip(), re.I)
    if found is None:
        raise FormatError("is not a legacy VTK file: check the suffix (.vtp and .vtu hold XML)")
    version = int(found[1]), int(found[2])
    if not (1, 0) <= version <= (5, 1):
        raise FormatError(f"is of VTK version {version[0]}.{version[1]}: export it as 5.1 or older")
    return version


class _Walk:
    """A position in the file and the counts announced up to it."""

    def __init__(self, file: BinaryIO, size: int, *, binary: bool, lists: bool) -> None:
        self._file = file
        self._size = size
        self._binary = binary
        self._lists = lists
        self._tuples = 0
        self._cell_values: int | None = None
        self.points = 0
        self.cells = 0

    def to_the_end(self) -> None:
        """Pass every section, then hold the counts against one another."""
        while words := self._words():
            self._section(words[0].upper())(words)
        if self._cell_values not in (None, self.cells):
            raise damaged(f"announces {self._cell_values} cell values for {self.cells} cells")

    def _section(self, keyword: str) -> Callable[[list[str]], None]:
        sections: dict[str, Callable[[list[str]], None]] = {
            "DATASET": self._dataset,
            "POINTS": self._points,
            "CELL_TYPES": self._cell_types,
            "POINT_DATA": self._point_data,
            "CELL_DATA": self._cell_data,
            "FIELD": self._field,
            "SCALARS": self._scalars,
            "COLOR_SCALARS": self._color_scalars,
            "LOOKUP_TABLE": self._lookup_table,
            "TEXTURE_COORDINATES": self._texture_coordinates,
            "METADATA": self._metadata,
        }
        sections.update(dict.fromkeys(_COMPONENTS, self._attribute))
        for kind in ("VERTICES", "LINES", "POLYGONS", "TRIANGLE_STRIPS", "CELLS"):
            sections[kind] = self._cell_lists
        if keyword not in sections:
            raise damaged(f"holds {shown(keyword)} where a section of the file should begin")
        return sections[keyword]

    def _words(self) -> list[str]:
        """Words of the next line that has any; none at the end of the file."""
        while line := self._file.readline(_LONGEST_LINE):
            if line.strip():
                return line.decode("utf-8", "backslashreplace").split()
        return []

    def _word(self, words: list[str], place: int) -> str:
        if place >= len(words):
            raise damaged(f"breaks off after {shown(' '.join(words))}")
        return words[place]

    def _count(self, words: list[str], place: int) -> int:
        return count_of(self._word(words, place), words[0])

    def _skip(self, count: int, kind: str, what: str) -> None:
        """Pass `count` numbers of type `kind`."""
        if self._binary:
            width = _BYTES_OF.get(kind.lower())
            needed = -(-count // 8) if kind.lower() == "bit" else count * (width or 0)
            if width is None and kind.lower() != "bit":
                raise damaged(f"gives {what} the type {shown(kind)}")
            self._skip_bytes(needed, f"{count} numbers of {what}")
        else:
            self._skip_text(count, what)

    def _skip_bytes(self, needed: int, what: str) -> None:
        require_bytes(what, needed=needed, left=self._size - self._file.tell())
        self._file.seek(needed, 1)

    def _skip_text(self, count: int, what: str) -> None:
        left = self._size - self._file.tell()
        require_bytes(f"{count} numbers of {what}", needed=2 * count - 1, left=left)
        missing = count
        while missing > 0:
            line = self._file.readline()
            if not line:
                raise damaged(f"ends {missing} numbers before the end of {what}")
            missing -= numbers_in(line, f"the {count} numbers of {what}")
        if missing:
            raise damaged(f"holds {count - missing} numbers in the {count} of {what}")

    def _dataset(self, words: list[str]) -> None:
        kind = self._word(words, 1).upper()
        if kind in _VOLUMES:
            raise FormatError(
                f"holds {kind}, a volume, not a surface: extract a surface from it first"
            )
        if kind not in ("POLYDATA", "UNSTRUCTURED_GRID"):
            raise FormatError(f"holds {shown(kind)}, not a surface: export the surface as POLYDATA")

    def _points(self, words: list[str]) -> None:
        self.points = self._count(words, 1)
        self._skip(3 * self.points, self._word(words, 2), "POINTS")

    def _cell_lists(self, words: list[str]) -> None:
        count, total = self._count(words, 1), self._count(words, 2)
        if self._lists:
            _require_whole_lists(self._integers(total, words[0]), count)
            self.cells += count
            return
        for part, length in (("OFFSETS", count), ("CONNECTIVITY", total)):
            line = self._words()
            if not line or line[0].upper() != part:
                raise damaged(f"lacks the {part} of its {words[0]}")
            self._skip(length, self._word(line, 1), f"{words[0]} {part}")
        self.cells += max(count - 1, 0)

    def _integers(self, count: int, what: str) -> Integers:
        start = self._file.tell()
        self._skip(count, "int", what)
        end = self._file.tell()
        self._file.seek(start)
        content = self._file.read(end - start)
        if self._binary:
            return np.frombuffer(content, ">i4").astype(np.int64)
        try:
            return np.array(array("q", map(int, content.split())), dtype=np.int64)
        except (ValueError, OverflowError) as fault:
            raise damaged(f"holds {what} that are not whole numbers") from fault

    def _cell_types(self, words: list[str]) -> None:
        self._skip(self._count(words, 1), "int", "CELL_TYPES")

    def _point_data(self, words: list[str]) -> None:
        self._tuples = self._count(words, 1)
        if self._tuples != self.points:
            raise damaged(f"announces {self._tuples} point values for {self.points} points")

    def _cell_data(self, words: list[str]) -> None:
        self._tuples = self._cell_values = self._count(words, 1)

    def _attribute(self, words: list[str]) -> None:
        components = _COMPONENTS[words[0].upper()]
        self._skip(self._tuples * components, self._word(words, 2), words[0])

    def _scalars(self, words: list[str]) -> None:
        components = self._count(words, 3) if len(words) > 3 else 1
        before = self._file.tell()
        line = self._file.readline(_LONGEST_LINE)
        if not line.upper().startswith(b"LOOKUP_TABLE"):
            self._file.seek(before)
        self._skip(self._tuples * components, self._word(words, 2), f"SCALARS {words[1]}")

    def _color_scalars(self, words: list[str]) -> None:
        self._skip(self._tuples * self._count(words, 2), "unsigned_char", words[0])

    def _lookup_table(self, words: list[str]) -> None:
        self._skip(4 * self._count(words, 2), "unsigned_char", words[0])

    def _texture_coordinates(self, words: list[str]) -> None:
        self._skip(self._tuples * self._count(words, 2), self._word(words, 3), words[0])

    def _field(self, words: list[str]) -> None:
        """Pass the arrays of a FIELD, each a line ``name components tuples type`` and its data."""
        for _ in range(self._count(words, 2)):
            line = self._words()
            while line and line[0].upper() == "METADATA":
                self._metadata(line)
                line = self._words()
            if not line:
                raise damaged(f"breaks off within {shown(' '.join(words))}")
            count = self._count(line, 1) * self._count(line, 2)
            if self._word(line, 3).lower() == "string":
                self._skip_strings(count)
            else:
                self._skip(count, line[3], f"FIELD {line[0]}")

    def _skip_strings(self, count: int) -> None:
        require_bytes(f"{count} strings", needed=count, left=self._size - self._file.tell())
        for _ in range(count):
            if self._binary:
                self._skip_bytes(self._string_length(), "a string")
            else:
                self._file.readline()

    def _string_length(self) -> int:
        """Length of a binary string: the two top bits of its first byte say how it is written."""
        first = self._file.read(1) or b"\xc0"
        more = (7, 3, 1, 0)[first[0] >> 6]
        rest = self._file.read(more)
        return int.from_bytes(bytes([first[0] & 0x3F]) + rest, "big")

    def _metadata(self, words: list[str]) -> None:  # noqa: ARG002 - a section like the others
        """Pass a block that only a blank line ends."""
        while self._file.readline(_LONGEST_LINE).strip():
            pass


def _require_whole_lists(values: Integers, count: int) -> None:
    """Refuse lists ``n i1 … in`` that do not fill their section exactly."""
    if len(values) == 4 * count and (values[::4] == 3).all():
        return
    lengths = values.tolist()
    place = 0
    for _ in range(count):
        if place >= len(lengths) or lengths[place] < 0:
            raise damaged(f"holds lists of cells that do not add up to {len(lengths)} numbers")
        place += lengths[place] + 1
    if place != len(lengths):
        raise damaged(f"holds {count} lists of cells that fill {place} of {len(lengths)} numbers")
