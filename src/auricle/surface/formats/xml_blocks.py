"""Binary arrays of VTK XML files: a length, then that many bytes, raw or in base64.

VTK reads a block that ends early without a murmur and leaves the rest of the array unset, so
lengths are checked here. Compressed blocks carry checksums, which VTK does check.
"""

import binascii
import re
from dataclasses import dataclass
from typing import BinaryIO, Literal

from auricle.surface.formats.header import damaged, require_bytes

_END = b"</AppendedData>"
_LAST_BYTES = 4096


@dataclass(frozen=True)
class BlockLayout:
    """How the lengths of a file's blocks are written, and whether they are compressed."""

    length_bytes: int
    byte_order: Literal["little", "big"]
    compressed: bool

    def length(self, block: bytes) -> int:
        """Read the number of bytes a block announces."""
        return int.from_bytes(block[: self.length_bytes], self.byte_order)


@dataclass(frozen=True)
class AppendedBlock:
    """Where an array begins in the appended data, and its length where the outline tells it."""

    offset: int
    expected: int | None


def require_inline(text: bytes, expected: int | None, layout: BlockLayout) -> None:
    """Refuse base64 between the tags of an array unless it holds what its length says.

    Raises
    ------
    FormatError
        If it does not, or its length is not the `expected` one.
    """
    if layout.compressed:
        return
    block = _decoded(b"".join(text.split()))
    _require_length(layout.length(block), expected)
    held = len(block) - layout.length_bytes
    if held != layout.length(block):
        raise damaged(f"announces {layout.length(block)} bytes of an array and holds {held}")


def require_appended(
    file: BinaryIO, size: int, tag: int, blocks: list[AppendedBlock], layout: BlockLayout
) -> None:
    """Refuse appended data that end before their arrays do.

    Parameters
    ----------
    file, size
        The file and its length in bytes.
    tag
        Where its ``<AppendedData`` begins.
    blocks
        The arrays that refer to it.
    layout
        How they are written.

    Raises
    ------
    FormatError
        If the data lack their end tag, or an array its bytes.
    """
    file.seek(max(size - _LAST_BYTES, tag))
    end = file.tell() + (tail := file.read()).rfind(_END)
    if _END not in tail:
        raise damaged("ends within its appended data")
    file.seek(tag)
    opening = file.read(_LAST_BYTES)
    start = tag + opening.find(b"_", opening.find(b">")) + 1
    is_base64 = re.search(rb"encoding\s*=\s*[\"']base64", opening.partition(b">")[0]) is not None
    for block in blocks:
        span = start + block.offset, end
        _require_block(file, span, block.expected, layout, is_base64=is_base64)


def _require_block(
    file: BinaryIO,
    span: tuple[int, int],
    expected: int | None,
    layout: BlockLayout,
    *,
    is_base64: bool,
) -> None:
    start, end = span
    head = _written(layout.length_bytes, is_base64=is_base64)
    require_bytes("the length of an array", needed=head, left=end - start)
    if layout.compressed:
        return
    file.seek(start)
    length = layout.length(_decoded(file.read(head)) if is_base64 else file.read(head))
    _require_length(length, expected)
    whole = _written(layout.length_bytes + length, is_base64=is_base64)
    require_bytes(f"an array of {length:,} bytes", needed=whole, left=end - start)
    if is_base64:
        file.seek(start)
        _decoded(file.read(whole))


def _written(length: int, *, is_base64: bool) -> int:
    """Bytes in the file of `length` bytes of data."""
    return 4 * -(-length // 3) if is_base64 else length


def _decoded(text: bytes) -> bytes:
    try:
        return binascii.a2b_base64(text, strict_mode=True)
    except binascii.Error as fault:
        raise damaged(f"holds an array that is not base64 ({fault})") from fault


def _require_length(length: int, expected: int | None) -> None:
    if expected not in (None, length):
        raise damaged(f"announces an array of {expected:,} bytes and then one of {length:,}")
