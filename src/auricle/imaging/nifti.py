"""NIfTI-1 and NIfTI-2 headers, their RAS+ geometry turned into LPS."""

import gzip
import struct
import zlib
from pathlib import Path
from typing import Any, Literal

import numpy as np

from auricle.arrays import Floats
from auricle.errors import FormatError
from auricle.foreign import damaged
from auricle.imaging.header import ImageHeader, require_straight

_LENGTHS = {348: 1, 540: 2}
_TYPES = {
    2: "u1",
    4: "i2",
    8: "i4",
    16: "f4",
    64: "f8",
    256: "i1",
    512: "u2",
    768: "u4",
    1024: "i8",
    1280: "u8",
}
_COLOURS = (128, 2304)
_MM_PER_UNIT = {0: 1.0, 1: 1000.0, 2: 1.0, 3: 0.001}
_LPS_FROM_RAS = np.diag([-1.0, -1.0, 1.0, 1.0])
_AGREEMENT_MM = 0.1

_COMMON_1 = np.dtype(
    [
        ("sizeof_hdr", "i4"),
        ("unused", "S36"),
        ("dim", "i2", 8),
        ("intent", "S14"),
        ("datatype", "i2"),
        ("bitpix", "i2"),
        ("slice_start", "i2"),
        ("pixdim", "f4", 8),
        ("vox_offset", "f4"),
        ("scl_slope", "f4"),
        ("scl_inter", "f4"),
        ("slice_end", "S3"),
        ("xyzt_units", "u1"),
        ("texts", "S128"),
        ("qform_code", "i2"),
        ("sform_code", "i2"),
        ("quatern", "f4", 3),
        ("qoffset", "f4", 3),
        ("srow", "f4", (3, 4)),
        ("intent_name", "S16"),
        ("magic", "S4"),
    ]
)
_COMMON_2 = np.dtype(
    [
        ("sizeof_hdr", "i4"),
        ("magic", "S8"),
        ("datatype", "i2"),
        ("bitpix", "i2"),
        ("dim", "i8", 8),
        ("intent_p", "f8", 3),
        ("pixdim", "f8", 8),
        ("vox_offset", "i8"),
        ("scl_slope", "f8"),
        ("scl_inter", "f8"),
        ("windows", "f8", 4),
        ("slices", "i8", 2),
        ("texts", "S104"),
        ("qform_code", "i4"),
        ("sform_code", "i4"),
        ("quatern", "f8", 3),
        ("qoffset", "f8", 3),
        ("srow", "f8", (3, 4)),
        ("slice_code", "i4"),
        ("xyzt_units", "i4"),
        ("rest", "S36"),
    ]
)


def nifti_header(path: Path) -> ImageHeader:
    """Header of a ``.nii`` or ``.nii.gz`` file, its affine in LPS.

    The sform counts if its code says so, else the qform (as nibabel has it); without either the
    orientation is unknown and the axes are taken for LPS as they are stored.

    Raises
    ------
    FormatError
        If it is no single NIfTI file, 4-D, coloured, complex, sheared, or too large for itself.
    """
    packed, raw = _first_bytes(path)
    fields = _fields(raw)
    shape = _shape(fields)
    dtype = _dtype(int(fields["datatype"]), byteorder=fields.dtype["dim"].base.byteorder)
    affine, known, remarks = _geometry(fields)
    slope, intercept = float(fields["scl_slope"]), float(fields["scl_inter"])
    scaled = np.isfinite([slope, intercept]).all() and slope != 0
    return ImageHeader(
        path,
        dtype,
        shape,
        affine,
        encoding="gzip" if packed else "raw",
        skip=_data_offset(fields),
        slope=slope if scaled else 1.0,
        intercept=intercept if scaled else 0.0,
        orientation_known=known,
        remarks=remarks,
    )


def _first_bytes(path: Path) -> tuple[bool, bytes]:
    """Whether the file is gzipped, and its (unpacked) first bytes."""
    with path.open("rb") as file:
        packed = file.read(2) == b"\x1f\x8b"
        file.seek(0)
        if not packed:
            return packed, file.read(max(_LENGTHS))
        try:
            return packed, gzip.GzipFile(fileobj=file).read(max(_LENGTHS))
        except (gzip.BadGzipFile, zlib.error, EOFError) as fault:
            raise damaged("holds compressed data that cannot be unpacked") from fault


def _fields(raw: bytes) -> Any:
    if len(raw) < min(_LENGTHS):
        raise damaged(f"ends after {len(raw)} bytes, within its header")
    orders: tuple[Literal["<"], Literal[">"]] = ("<", ">")
    for order in orders:
        (length,) = struct.unpack(order + "i", raw[:4])
        layout = {1: _COMMON_1, 2: _COMMON_2}.get(_LENGTHS.get(length, 0))
        if layout is not None and len(raw) >= layout.itemsize:
            fields = np.frombuffer(raw, layout.newbyteorder(order), count=1)[0]
            if bytes(fields["magic"])[:3] in (b"n+1", b"n+2"):
                return fields
            raise FormatError("is no single NIfTI file (.hdr with .img?): save it as one .nii")
    raise FormatError("is no NIfTI file, whatever its name: export it again")


def _shape(fields: Any) -> tuple[int, int, int]:
    dimensions = int(fields["dim"][0])
    if not 1 <= dimensions <= 7:
        raise damaged(f"announces {dimensions} dimensions")
    sizes = [int(size) for size in fields["dim"][1 : dimensions + 1]]
    extra = [size for size in sizes[3:] if size != 1]
    if extra:
        raise FormatError(
            f"holds {extra[0]} volumes or components (4-D): save one of them as its own file"
        )
    nx, ny, nz = (*sizes, 1, 1)[:3]
    return nx, ny, nz


def _dtype(code: int, *, byteorder: str) -> np.dtype[np.generic]:
    if code in _COLOURS:
        raise FormatError("is a colour image: give the CT numbers themselves")
    if code not in _TYPES:
        raise FormatError(f"holds numbers of NIfTI type {code}: save it as 16-bit integers")
    return np.dtype(byteorder + _TYPES[code])


def _data_offset(fields: Any) -> int:
    offset = float(fields["vox_offset"])
    if not np.isfinite(offset) or not 0 <= offset < 2**31 or offset != int(offset):
        raise damaged(f"announces its voxels at byte {offset:g}")
    return max(int(offset), int(fields["sizeof_hdr"]) + 4)


def _geometry(fields: Any) -> tuple[Floats, bool, tuple[str, ...]]:
    unit = int(fields["xyzt_units"]) & 7
    if unit not in _MM_PER_UNIT:
        raise damaged(f"announces a unit of length number {unit}")
    to_mm = np.diag([_MM_PER_UNIT[unit]] * 3 + [1.0])
    for numbers in ("pixdim", "quatern", "qoffset", "srow"):
        if not np.isfinite(fields[numbers]).all():
            raise damaged(f"announces a position or spacing ({numbers}) that is NaN or infinite")
    oriented = {
        name: _LPS_FROM_RAS @ to_mm @ transform(fields)
        for name, transform in (("sform", _sform), ("qform", _qform))
        if fields[f"{name}_code"] > 0
    }
    if not oriented:
        remark = "orientation unknown: neither qform nor sform says which way the patient lies"
        spacing = np.abs(fields["pixdim"][1:4].astype(np.float64))
        return to_mm @ np.diag([*spacing, 1.0]), False, (remark,)
    name, affine = next(iter(oriented.items()))
    require_straight(affine, f"the axes of its {name}")
    return affine, True, _disagreement(fields, oriented)


def _disagreement(fields: Any, oriented: dict[str, Floats]) -> tuple[str, ...]:
    if len(oriented) < 2:
        return ()
    far = fields["dim"][1:4].astype(np.float64) - 1
    corners = np.array([[0, 0, 0, 1], [*far, 1]]).T
    apart = np.abs((oriented["sform"] - oriented["qform"]) @ corners).max()
    if apart <= _AGREEMENT_MM:
        return ()
    return (f"sform and qform place the volume up to {apart:.3g} mm apart: the sform was used",)


def _sform(fields: Any) -> Floats:
    affine = np.eye(4)
    affine[:3] = fields["srow"]
    return affine


def _qform(fields: Any) -> Floats:
    """Rotation of a unit quaternion times the spacing; ``pixdim[0]`` −1 turns the third axis."""
    b, c, d = fields["quatern"].astype(np.float64)
    a = np.sqrt(max(1.0 - (b * b + c * c + d * d), 0.0))
    length = np.sqrt(a * a + b * b + c * c + d * d)
    a, b, c, d = (part / length for part in (a, b, c, d))
    rotation = np.array(
        [
            [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
            [2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)],
            [2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c],
        ]
    )
    spacing = np.abs(fields["pixdim"][1:4].astype(np.float64))
    spacing[2] *= -1.0 if fields["pixdim"][0] < 0 else 1.0
    affine = np.eye(4)
    affine[:3, :3] = rotation * spacing
    affine[:3, 3] = fields["qoffset"]
    return affine
