"""Surfaces read from files, untrusted until proven sound."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import BinaryIO

import numpy as np

from auricle.errors import FormatError
from auricle.foreign import printable
from auricle.surface.formats.header import UNKNOWN_SPACE, Header, within_limits
from auricle.surface.formats.isolation import parse_isolated
from auricle.surface.formats.legacy_vtk import legacy_vtk_header
from auricle.surface.formats.obj import obj_header
from auricle.surface.formats.off import off_header
from auricle.surface.formats.opencarp import read_opencarp
from auricle.surface.formats.ply import ply_header
from auricle.surface.formats.stl import stl_header
from auricle.surface.formats.xml_vtk import vtp_header, vtu_header
from auricle.surface.soup import TriangleSoup

_HEADERS: dict[str, Callable[[BinaryIO, int], Header]] = {
    ".vtp": vtp_header,
    ".vtk": legacy_vtk_header,
    ".vtu": vtu_header,
    ".ply": ply_header,
    ".stl": stl_header,
    ".obj": obj_header,
    ".off": off_header,
}
_OPENCARP = (".pts", ".elem")
_VOLUMES = (".vti", ".vtr", ".vts", ".nii", ".nii.gz", ".nrrd", ".nhdr", ".mha", ".mhd", ".dcm")
READABLE = (*_HEADERS, *_OPENCARP)
"""Suffixes `read_surface` knows, in lower case."""


def read_surface(path: Path) -> TriangleSoup:
    """Read a surface of triangles with its fields, by the file's suffix (case does not matter).

    The header is held against the file's size before any parser sees the file, and third-party
    parsers run in a child process: a damaged file costs an error, never the session.

    ==================== ========================================================================
    suffix               read
    ==================== ========================================================================
    .vtp .vtu .vtk       Numeric point arrays as fields, whole-number cell arrays as face tags;
                         lines and vertices are left out, polygons and strips cut into triangles
    .ply                 Vertex properties but normals and colours as fields, whole-number face
                         properties as face tags
    .stl                 Three vertices a face, nothing merged
    .obj .off            Vertices and faces
    .pts .elem           openCARP's pair, µm turned into mm, element tags as ``elemTag``, fields
                         from ``STEM.dat``, ``STEM_NAME.dat``, ``STEM.NAME.dat``
    ==================== ========================================================================

    Positions are taken for mm. Where the file says ``SPACE=RAS`` (a field-data array, a comment
    or the STL header, as 3D Slicer writes it) they are turned into LPS.

    Parameters
    ----------
    path
        A file of a suffix in `READABLE`; openCARP's pair by either of its names.

    Raises
    ------
    FormatError
        If the file is missing, of another kind, damaged, or holds a volume; the message begins
        with the path.
    """
    try:
        return _in_lps(_checked(_read(path)))
    except OSError as fault:
        reason = fault.strerror or str(fault)
        shown = printable(str(path))
        raise FormatError(f"{shown}: cannot be read ({reason}): check the place") from fault
    except FormatError as fault:
        raise FormatError(f"{printable(str(path))}: {printable(str(fault))}") from fault


def _read(path: Path) -> TriangleSoup:
    if not path.exists():
        raise FormatError("there is no such file: check the name")
    if not path.is_file():
        raise FormatError("is a folder or a device, not a file: give a file inside it")
    suffix = path.suffix.lower()
    if path.name.lower().endswith(_VOLUMES):
        raise FormatError("is a volume, not a surface: segment it, or extract a surface first")
    if suffix not in READABLE:
        raise FormatError(f"its suffix is none of {' '.join(READABLE)}: export it as one of these")
    size = within_limits(path)
    if suffix in _OPENCARP:
        return read_opencarp(path)
    with path.open("rb") as file:
        header = _HEADERS[suffix](file, size)
    soup, cells = parse_isolated(suffix, path)
    if (len(soup.vertices), cells) != (header.vertices, header.cells):
        raise FormatError(
            f"announces {header.vertices} vertices and {header.cells} faces, its reader found "
            f"{len(soup.vertices)} and {cells}: the file is damaged; export it again"
        )
    return replace(
        soup,
        space=header.space if soup.space == UNKNOWN_SPACE else soup.space,
        units={**header.units, **soup.units},
        remarks=header.remarks + soup.remarks,
    )


def _checked(soup: TriangleSoup) -> TriangleSoup:
    """Refuse what no cleaning could mend: no faces, or faces at positions that are no numbers."""
    if not len(soup.faces):
        raise FormatError("holds no faces: give a surface made of triangles")
    known = (soup.faces >= 0) & (soup.faces < len(soup.vertices))
    used = np.unique(soup.faces[known])
    lost = int((~np.isfinite(soup.vertices[used])).any(axis=1).sum())
    if lost:
        raise FormatError(
            f"holds NaN or infinite positions at {lost} vertices of faces: export it again"
        )
    return soup


def _in_lps(soup: TriangleSoup) -> TriangleSoup:
    """Turn RAS positions into LPS, and forget axes that are neither."""
    space = soup.space.strip().upper()
    if space in ("LPS", UNKNOWN_SPACE.upper()):
        return replace(soup, space="LPS" if space == "LPS" else UNKNOWN_SPACE)
    if space != "RAS":
        remark = f"SPACE={printable(soup.space)[:20]} is neither LPS nor RAS: axes taken as unknown"
        return replace(soup, space=UNKNOWN_SPACE, remarks=(*soup.remarks, remark))
    remark = "positions turned from RAS into LPS axes (x and y negated)"
    rows = [name for name, values in soup.point_fields.items() if values.ndim > 1]
    if rows:
        remark += f"; fields of several components left as they were: {', '.join(rows)}"
    return replace(
        soup,
        vertices=soup.vertices * np.array([-1.0, -1.0, 1.0]),
        space="LPS",
        remarks=(*soup.remarks, remark),
    )
