"""NRRD headers, attached (``.nrrd``) and detached (``.nhdr``), their geometry in LPS."""

import re
from pathlib import Path
from typing import BinaryIO

import numpy as np

from auricle.arrays import Floats
from auricle.errors import FormatError
from auricle.foreign import count_of, damaged, shown
from auricle.imaging.header import ImageHeader, require_spacing
from auricle.imaging.header_text import data_file, numbers_in, sizes_in

_MOST_HEADER_BYTES = 1 << 20
_NAMES_OF_TYPES = {
    "i1": "signed char, int8, int8_t",
    "u1": "uchar, unsigned char, uint8, uint8_t",
    "i2": "short, short int, signed short, signed short int, int16, int16_t",
    "u2": "ushort, unsigned short, unsigned short int, uint16, uint16_t",
    "i4": "int, signed int, int32, int32_t",
    "u4": "uint, unsigned int, uint32, uint32_t",
    "i8": "longlong, long long, long long int, signed long long, signed long long int, int64,"
    " int64_t",
    "u8": "ulonglong, unsigned long long, unsigned long long int, uint64, uint64_t",
    "f4": "float",
    "f8": "double",
}
_TYPES = {name: code for code, names in _NAMES_OF_TYPES.items() for name in names.split(", ")}
_ENCODINGS = {"raw": "raw", "gzip": "gzip", "gz": "gzip"}
_LPS_FROM = {
    "left-posterior-superior": (1.0, 1.0, 1.0),
    "lps": (1.0, 1.0, 1.0),
    "right-anterior-superior": (-1.0, -1.0, 1.0),
    "ras": (-1.0, -1.0, 1.0),
    "left-anterior-superior": (1.0, -1.0, 1.0),
    "las": (1.0, -1.0, 1.0),
}


def nrrd_header(path: Path) -> ImageHeader:
    """Header of an NRRD file, its affine in LPS.

    Without ``space`` and ``space directions`` the orientation is unknown and the axes are taken
    for LPS as they are stored.

    Raises
    ------
    FormatError
        If it is no NRRD file, 4-D, coloured, sheared, in several files, encoded in another way
        than raw or gzip, or larger than its data.
    """
    with path.open("rb") as file:
        fields = _fields(file)
        offset = file.tell()
    detached = fields.get("data file", fields.get("datafile"))
    data = path if detached is None else data_file(path, detached)
    sizes, left_out = sizes_in(
        _required(fields, "sizes"),
        dimensions=count_of(_required(fields, "dimension"), "dimensions"),
        components="color" in fields.get("kinds", "") or "vector" in fields.get("kinds", ""),
    )
    dtype, encoding = _dtype(fields), _encoding(fields)
    start = 0 if detached is not None else offset
    skipped = _byte_skip(fields, raw=encoding == "raw")
    if skipped < 0:
        start = data.stat().st_size - int(np.prod(sizes, dtype=object)) * dtype.itemsize
    affine, known = _geometry(fields, left_out)
    nx, ny, nz = sizes
    return ImageHeader(
        data,
        dtype,
        (nx, ny, nz),
        affine,
        encoding=encoding,
        offset=max(start, 0),
        skip=max(skipped, 0),
        orientation_known=known,
        remarks=() if known else ("orientation unknown: the file names no space",),
    )


def _fields(file: BinaryIO) -> dict[str, str]:
    """Fields in lower case by name; the file stands behind the header."""
    if re.match(rb"NRRD000[1-6]\s*$", file.readline(64)) is None:
        raise FormatError("is no NRRD file, whatever its name: export it again")
    fields: dict[str, str] = {}
    while line := file.readline(_MOST_HEADER_BYTES):
        text = line.decode("utf-8", "replace").strip()
        if not text:
            break
        name, colon, value = text.partition(":")
        if not colon and not text.startswith("#"):
            raise damaged(f"holds the header line {shown(text)}")
        if text.startswith("#") or value.startswith("="):
            continue
        fields[name.strip().lower()] = value.strip()
        if file.tell() > _MOST_HEADER_BYTES:
            raise damaged("has a header without end")
    return fields


def _required(fields: dict[str, str], name: str) -> str:
    if name not in fields:
        raise damaged(f"has no {name} in its header")
    return fields[name]


def _dtype(fields: dict[str, str]) -> np.dtype[np.generic]:
    name = _required(fields, "type").lower()
    if name not in _TYPES:
        raise FormatError(f"holds numbers of type {shown(name)}: save it as 16-bit integers")
    dtype = np.dtype(_TYPES[name])
    if dtype.itemsize == 1:
        return dtype
    order = _required(fields, "endian").lower()
    if order not in ("little", "big"):
        raise damaged(f"gives {shown(order)} as its byte order")
    return dtype.newbyteorder("<" if order == "little" else ">")


def _encoding(fields: dict[str, str]) -> str:
    name = _required(fields, "encoding").lower()
    if name not in _ENCODINGS:
        raise FormatError(f"is encoded as {shown(name)}: save it as raw or gzip")
    if fields.get("line skip", fields.get("lineskip", "0")) != "0":
        raise FormatError("skips lines before its data: save it again, without line skip")
    return _ENCODINGS[name]


def _byte_skip(fields: dict[str, str], *, raw: bool) -> int:
    text = fields.get("byte skip", fields.get("byteskip", "0"))
    if text == "-1" and raw:
        return -1
    return count_of(text, "bytes to skip")


def _geometry(fields: dict[str, str], left_out: int) -> tuple[Floats, bool]:
    if fields.get("space units", "mm").replace('"', "").split()[:1] not in ([], ["mm"]):
        raise FormatError(f"measures in {shown(fields['space units'])}: save it in mm")
    signs = _LPS_FROM.get(fields.get("space", "").lower())
    affine = np.eye(4)
    if "space directions" not in fields:
        spacing = numbers_in(fields.get("spacings", ""), count=3, what="spacings")
        require_spacing(np.abs(spacing))
        affine[:3, :3] = np.diag(np.abs(spacing))
        return affine, False
    vectors = re.findall(r"\([^)]*\)|none", fields["space directions"])
    kept = [vector for axis, vector in enumerate(vectors) if axis != left_out]
    if len(kept) != 3:
        raise damaged(f"gives {shown(fields['space directions'])} as its space directions")
    for axis, vector in enumerate(kept):
        affine[:3, axis] = numbers_in(vector, count=3, what="space directions")
    if "space origin" in fields:
        affine[:3, 3] = numbers_in(fields["space origin"], count=3, what="space origin")
    return (affine, False) if signs is None else (np.diag([*signs, 1.0]) @ affine, True)
