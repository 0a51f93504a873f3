"""MetaImage headers (``.mha``, ``.mhd``), their geometry in LPS as ITK means it."""

from pathlib import Path
from typing import BinaryIO

import numpy as np

from auricle.arrays import Floats
from auricle.errors import FormatError
from auricle.foreign import count_of, damaged, shown
from auricle.imaging.header import ImageHeader, require_spacing
from auricle.imaging.header_text import data_file, numbers_in, sizes_in

_MOST_HEADER_BYTES = 1 << 16
_TYPES = {
    "MET_CHAR": "i1",
    "MET_UCHAR": "u1",
    "MET_SHORT": "i2",
    "MET_USHORT": "u2",
    "MET_INT": "i4",
    "MET_UINT": "u4",
    "MET_LONG": "i4",
    "MET_ULONG": "u4",
    "MET_LONG_LONG": "i8",
    "MET_ULONG_LONG": "u8",
    "MET_FLOAT": "f4",
    "MET_DOUBLE": "f8",
}
_MATRICES = ("transformmatrix", "rotation", "orientation")
_PLACES = ("offset", "position", "origin")


def metaimage_header(path: Path) -> ImageHeader:
    """Header of a MetaImage, its affine in LPS.

    Without a ``TransformMatrix`` the orientation is unknown and the axes are taken for LPS as
    they are stored. ``AnatomicalOrientation`` is not read: ITK writes it, but does not use it.

    Raises
    ------
    FormatError
        If it is no MetaImage, 4-D, coloured, sheared, text, in several files, or larger than
        its data.
    """
    with path.open("rb") as file:
        fields = _fields(file)
        offset = file.tell()
    dimensions = count_of(_required(fields, "ndims"), "dimensions")
    if fields.get("elementnumberofchannels", "1") != "1":
        raise FormatError("is a colour or vector image: give the CT numbers themselves")
    sizes, left_out = sizes_in(_required(fields, "dimsize"), dimensions=dimensions)
    if left_out == 0:
        raise FormatError("holds several volumes (4-D): save one of them as its own file")
    place = _required(fields, "elementdatafile")
    local = place.upper() == "LOCAL"
    data = path if local else data_file(path, place)
    dtype = _dtype(fields)
    start = offset if local else 0
    if fields.get("headersize", "0") == "-1":
        start = data.stat().st_size - int(np.prod(sizes, dtype=object)) * dtype.itemsize
    elif not local:
        start = count_of(fields.get("headersize", "0"), "bytes of header")
    affine, known = _geometry(fields, dimensions)
    nx, ny, nz = sizes
    return ImageHeader(
        data,
        dtype,
        (nx, ny, nz),
        affine,
        encoding="zlib" if _truth(fields, "compresseddata") else "raw",
        offset=max(start, 0),
        orientation_known=known,
        remarks=() if known else ("orientation unknown: the file has no TransformMatrix",),
    )


def _fields(file: BinaryIO) -> dict[str, str]:
    """Fields by name in lower case, up to ElementDataFile; the file stands behind it."""
    fields: dict[str, str] = {}
    while line := file.readline(_MOST_HEADER_BYTES):
        name, equals, value = line.decode("utf-8", "replace").partition("=")
        if not equals or file.tell() > _MOST_HEADER_BYTES:
            break
        fields[name.strip().lower()] = value.strip()
        if name.strip().lower() == "elementdatafile":
            return fields
    if "ndims" not in fields:
        raise FormatError("is no MetaImage, whatever its name: export it again")
    raise damaged("has no ElementDataFile in its header")


def _required(fields: dict[str, str], name: str) -> str:
    if name not in fields:
        raise damaged(f"has no {name} in its header")
    return fields[name]


def _truth(fields: dict[str, str], name: str, default: str = "False") -> bool:
    return fields.get(name, default).strip().lower() in ("true", "1")


def _dtype(fields: dict[str, str]) -> np.dtype[np.generic]:
    name = _required(fields, "elementtype").upper()
    if not _truth(fields, "binarydata", "True"):
        raise FormatError("holds its voxels as text: save it as binary")
    if name not in _TYPES:
        raise FormatError(f"holds numbers of type {shown(name)}: save it as 16-bit integers")
    big = _truth(fields, "binarydatabyteordermsb") or _truth(fields, "elementbyteordermsb")
    return np.dtype(_TYPES[name]).newbyteorder(">" if big else "<")


def _geometry(fields: dict[str, str], dimensions: int) -> tuple[Floats, bool]:
    """Affine from axes (one a run of numbers), spacing and offset; whether the axes were given."""
    spacing = numbers_in(
        _required(fields, "elementspacing"), count=dimensions, what="ElementSpacing"
    )[:3]
    require_spacing(spacing)
    affine = np.eye(4)
    matrix = next((fields[name] for name in _MATRICES if name in fields), None)
    if matrix is not None:
        rows = numbers_in(matrix, count=dimensions**2, what="TransformMatrix")
        affine[:3, :3] = rows.reshape(dimensions, dimensions)[:3, :3].T
    lengths = np.linalg.norm(affine[:3, :3], axis=0)
    if np.abs(lengths - 1).max() > 1e-3:
        raise damaged("gives axes that are no unit vectors as its TransformMatrix")
    affine[:3, :3] *= spacing
    place = next((fields[name] for name in _PLACES if name in fields), None)
    if place is not None:
        affine[:3, 3] = numbers_in(place, count=dimensions, what="Offset")[:3]
    return affine, matrix is not None
