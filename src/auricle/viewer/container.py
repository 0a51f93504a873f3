"""The container of what the browser draws: a JSON header, then arrays, little-endian."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

MAGIC = b"AURC"
ALIGNMENT = 8
_KINDS = ("int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64")


def packed(header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> bytes:
    """Header and arrays as bytes.

    Four bytes ``AURC``, the length of the header (uint32), the header as JSON in UTF-8 with the
    arrays' `dtype`, `shape` and `offset` under ``arrays``, then the arrays, each at a multiple of
    8 bytes from the end of the header's padding, in C order.

    Raises
    ------
    ValueError
        If an array is of a type the page does not read.

    Examples
    --------
    >>> content = packed({"unit": "ms"}, {"map": np.array([1.0, 2.0], dtype=np.float32)})
    >>> header, arrays = unpacked(content)
    >>> header["unit"], arrays["map"].tolist()
    ('ms', [1.0, 2.0])
    """
    described: dict[str, Any] = {}
    parts: list[bytes] = []
    offset = 0
    for name, array in arrays.items():
        if array.dtype.name not in _KINDS:
            raise ValueError(f"array {name!r} is of type {array.dtype}")
        content = np.ascontiguousarray(array, array.dtype.newbyteorder("<")).tobytes()
        described[name] = {"dtype": array.dtype.name, "shape": array.shape, "offset": offset}
        padded = content + bytes(-len(content) % ALIGNMENT)
        parts.append(padded)
        offset += len(padded)
    text = json.dumps({**header, "arrays": described}, allow_nan=False).encode()
    text += b" " * (-(len(MAGIC) + 4 + len(text)) % ALIGNMENT)
    return b"".join([MAGIC, np.uint32(len(text)).astype("<u4").tobytes(), text, *parts])


def unpacked(content: bytes) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Header and arrays of bytes that `packed` made."""
    begin = len(MAGIC) + 4
    length = int(np.frombuffer(content[len(MAGIC) : begin], "<u4")[0])
    header = json.loads(content[begin : begin + length])
    arrays = {}
    for name, each in header.pop("arrays").items():
        kind = np.dtype(each["dtype"]).newbyteorder("<")
        count = int(np.prod(each["shape"], dtype=np.int64))
        flat = np.frombuffer(content, kind, count, begin + length + each["offset"])
        arrays[name] = flat.reshape(each["shape"])
    return header, arrays
