"""The outline of a VTK XML file (``.vtp``, ``.vtu``), streamed by expat with DTDs forbidden."""

from dataclasses import dataclass
from typing import BinaryIO
from xml.parsers import expat

from auricle.errors import FormatError
from auricle.surface.formats.header import Header, count_of, damaged, require_bytes, shown
from auricle.surface.formats.number_text import numbers_in
from auricle.surface.formats.xml_blocks import (
    AppendedBlock,
    BlockLayout,
    require_appended,
    require_inline,
)

_BLOCK = 1 << 20
_DEEPEST = 32
_VOLUMES = ("ImageData", "StructuredGrid", "RectilinearGrid", "UniformGrid", "HyperTreeGrid")
_POLYDATA_CELLS = ("Verts", "Lines", "Strips", "Polys")
_ARRAYS = ("DataArray", "Array")
_COUNTED = ("NumberOfPoints", "NumberOfCells", *(f"NumberOf{kind}" for kind in _POLYDATA_CELLS))
_BEST_COMPRESSION = {
    "": 1,
    "vtkLZ4DataCompressor": 255,
    "vtkZLibDataCompressor": 1032,
    "vtkLZMADataCompressor": 7100,
}


def vtp_header(file: BinaryIO, size: int) -> Header:
    """Outline of a ``.vtp`` file: its counts, held against its bytes.

    Parameters
    ----------
    file
        Open in binary mode, at its start.
    size
        Its length in bytes.

    Raises
    ------
    FormatError
        If the file is not XML of this type, declares a DTD, announces more values than its bytes
        can hold even compressed, or writes values as text that are not numbers or not as many as
        announced.
    """
    return _header(file, size, "PolyData")


def vtu_header(file: BinaryIO, size: int) -> Header:
    """Outline of a ``.vtu`` file; otherwise as `vtp_header`."""
    return _header(file, size, "UnstructuredGrid")


def _header(file: BinaryIO, size: int, expected_type: str) -> Header:
    outline = _Outline(expected_type)
    try:
        outline.read(file)
    except expat.ExpatError as fault:
        raise damaged(f"is not well-formed XML ({fault})") from fault
    held = size * outline.compression
    require_bytes(
        "arrays" if held == size else "compressed arrays", needed=outline.bytes, left=held
    )
    if outline.appended_at is not None:
        require_appended(file, size, outline.appended_at, outline.blocks, outline.layout)
    return Header(outline.points, outline.cells)


class _Reached(Exception):  # noqa: N818 - no fault: the part that need not be XML begins
    """The appended data begin."""


class _Outline:
    """Counts of a VTK XML file, gathered element by element."""

    def __init__(self, expected_type: str) -> None:
        self._expected_type = expected_type
        self._parser = self._new_parser()
        self._path: list[str] = []
        self._piece: dict[str, int] = {}
        self._array: _Array | None = None
        self._text: list[bytes] = []
        self.compression = 1
        self.bytes = 0
        self.points = 0
        self.cells = 0
        self.layout = BlockLayout(4, "little", compressed=False)
        self.blocks: list[AppendedBlock] = []
        self.appended_at: int | None = None

    def read(self, file: BinaryIO) -> None:
        """Parse up to the appended data, or to the end."""
        try:
            while block := file.read(_BLOCK):
                self._parser.Parse(block, False)
            self._parser.Parse(b"", True)
        except _Reached:
            return

    def _new_parser(self) -> expat.XMLParserType:
        parser = expat.ParserCreate()
        parser.StartDoctypeDeclHandler = self._refuse_doctype
        parser.StartElementHandler = self._start
        parser.EndElementHandler = self._end
        parser.CharacterDataHandler = self._characters
        parser.buffer_text = True
        return parser

    def _refuse_doctype(self, *_declaration: object) -> None:
        raise FormatError("declares a document type (DTD), which no surface needs: remove it")

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        if not self._path:
            self._root(name, attributes)
        if name == "AppendedData":
            self.appended_at = self._parser.CurrentByteIndex
            raise _Reached
        self._path.append(name)
        if len(self._path) > _DEEPEST:
            raise damaged(f"nests its elements more than {_DEEPEST} deep")
        if name == "Piece":
            self._start_piece(attributes)
        elif name in _ARRAYS:
            self._start_array(attributes)

    def _root(self, name: str, attributes: dict[str, str]) -> None:
        if name != "VTKFile":
            raise FormatError(f"is XML of {shown(name)}, not of VTK: check the suffix")
        kind = attributes.get("type", "")
        if kind in _VOLUMES:
            raise FormatError(f"holds {kind}, a volume, not a surface: extract a surface first")
        if kind != self._expected_type:
            raise FormatError(
                f"holds {shown(kind)}, not the {self._expected_type} of its suffix: rename it"
            )
        compressor = attributes.get("compressor", "")
        if compressor not in _BEST_COMPRESSION:
            raise FormatError(f"is compressed by {shown(compressor)}: export it uncompressed")
        self.compression = _BEST_COMPRESSION[compressor]
        self.layout = BlockLayout(
            length_bytes=8 if attributes.get("header_type") == "UInt64" else 4,
            byte_order="big" if attributes.get("byte_order") == "BigEndian" else "little",
            compressed=bool(compressor),
        )

    def _start_piece(self, attributes: dict[str, str]) -> None:
        self._piece = {
            name: count_of(attributes.get(name, "0"), name.removeprefix("NumberOf"))
            for name in _COUNTED
        }
        self.points += self._piece["NumberOfPoints"]
        self.cells += self._piece_cells()

    def _piece_cells(self) -> int:
        return sum(self._piece[name] for name in _COUNTED[1:])

    def _start_array(self, attributes: dict[str, str]) -> None:
        tuples = self._tuples(attributes)
        components = count_of(attributes.get("NumberOfComponents", "1"), "components")
        numbers = None if tuples is None else tuples * components
        array = _Array(numbers, attributes.get("type", ""), attributes.get("format", "ascii"))
        self._array, self._text = array, []
        self.bytes += array.smallest_size()
        if array.form == "appended":
            offset = count_of(attributes.get("offset", ""), "the offset of an array")
            self.blocks.append(AppendedBlock(offset, array.size()))

    def _tuples(self, attributes: dict[str, str]) -> int | None:
        """Rows the open array must have; None where only its values tell."""
        section = self._path[-2] if len(self._path) > 1 else ""
        if not self._piece:
            return None
        if section in ("PointData", "Points"):
            return self._piece["NumberOfPoints"]
        if section == "CellData":
            return self._piece_cells()
        if attributes.get("Name") in ("offsets", "types"):
            return self._piece.get("NumberOfCells" if section == "Cells" else f"NumberOf{section}")
        return None

    def _characters(self, text: str) -> None:
        if self._array is not None and self._path[-1] in _ARRAYS:
            self._text.append(text.encode())

    def _end(self, name: str) -> None:
        self._path.pop()
        if name == "Piece":
            self._piece = {}
        if name in _ARRAYS and self._array is not None:
            self._array.require(b"".join(self._text), self.layout)
            self._array = None


@dataclass(frozen=True)
class _Array:
    """An array as its tag announces it."""

    numbers: int | None
    kind: str
    form: str

    def size(self) -> int | None:
        """Bytes of its values in memory, where they can be told."""
        if self.numbers is None or self.kind == "String":
            return None
        bits = 1 if self.kind == "Bit" else int("".join(filter(str.isdigit, self.kind)) or 0)
        if bits not in (1, 8, 16, 32, 64):
            raise damaged(f"holds an array of type {shown(self.kind)}")
        return -(-self.numbers * bits // 8)

    def smallest_size(self) -> int:
        """Fewest bytes of the file that hold its values before compression."""
        if self.form == "ascii":
            return max(2 * (self.numbers or 0) - 1, 0)
        return self.size() or 0

    def require(self, text: bytes, layout: BlockLayout) -> None:
        """Refuse content that is not what the tag announces."""
        if self.form == "binary":
            require_inline(text, self.size(), layout)
        elif self.form == "ascii":
            found = numbers_in(text, "the values of an array")
            if self.kind != "String" and self.numbers not in (None, found):
                raise damaged(f"announces {self.numbers} values of an array and holds {found}")
