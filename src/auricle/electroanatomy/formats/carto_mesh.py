"""CARTO 3's ``.mesh``: sections of text, vertices and triangles counted in the first.

Layout as Biosense Webster's comments in the files state it: ``-10000`` marks a value that is not
there, GroupID ``-1000000`` anatomy the operator deleted.
"""

import re

import numpy as np

from auricle.arrays import Faces, Floats, Truths
from auricle.electroanatomy.formats.number_tables import number_table
from auricle.electroanatomy.formats.omissions import Omissions
from auricle.electroanatomy.formats.positions import require_positions
from auricle.surface.formats.header import MOST_CELLS, MOST_VERTICES, count_of, damaged
from auricle.surface.soup import TriangleSoup

MISSING = -10000.0
DELETED_GROUP = -1000000
MAGIC = b"#TriangulatedMesh"
COLOURS = {
    "Unipolar": ("unipolar_voltage", "mV"),
    "Bipolar": ("bipolar_voltage", "mV"),
    "LAT": ("local_activation_time", "ms"),
    "Impedance": ("impedance", "ohm"),
    "Force": ("force", "g"),
    "A1": ("A1", "ms"),
    "A2": ("A2", "ms"),
    "A2-A1": ("A2-A1", "ms"),
    "SCI": ("shortest_complex_interval", "ms"),
    "ICL": ("interval_confidence_level", ""),
    "ACL": ("average_complex_interval", "ms"),
    "ACI": ("average_complex_interval", "ms"),
    "Paso": ("paso_correlation", ""),
}
"""Colour columns by CARTO's name: OpenEP's name where it has one, and the unit."""
_MICRO_BIPOLAR = ("micro_bipolar_voltage", "mV")
_SECTION = re.compile(rb"^\[(\w+)\]")
_VERTEX_COLUMNS, _TRIANGLE_COLUMNS = 8, 8


def parse_carto_mesh(content: bytes) -> TriangleSoup:
    """Surface of one map.

    Deleted triangles are left out, and those at a deleted vertex; vertices stay, so that values
    keep their order. A colour column without a single value is no field; vertices marked
    as scar make the field ``scar`` of 0 and 1.

    Raises
    ------
    FormatError
        If it is no such mesh, its counts lie, or its numbers are none.
    """
    if not content.startswith(MAGIC):
        raise damaged("does not begin as a CARTO mesh does")
    sections = _sections(content)
    about = _attributes(sections.get("GeneralAttributes", []))
    counts = {
        name: count_of(about.get(name, b""), what)
        for name, what in (("NumVertex", "vertices"), ("NumTriangle", "triangles"))
    }
    if counts["NumVertex"] > MOST_VERTICES or counts["NumTriangle"] > MOST_CELLS:
        raise damaged("announces more vertices or triangles than any map has")
    vertices = _rows(sections, "VerticesSection", counts["NumVertex"], _VERTEX_COLUMNS)
    triangles = _rows(sections, "TrianglesSection", counts["NumTriangle"], _TRIANGLE_COLUMNS)
    omissions = Omissions()
    faces = _kept_faces(vertices, triangles, omissions)
    fields, units = _colours(sections, about, counts["NumVertex"], omissions)
    scar = _scar(sections, counts["NumVertex"])
    if scar.any():
        fields["scar"], units["scar"] = scar, ""
    return TriangleSoup(
        vertices[:, 1:4], faces, point_fields=fields, units=units, remarks=omissions.remarks
    )


def _sections(content: bytes) -> dict[str, list[bytes]]:
    """Lines of each section without comments, by its name."""
    sections: dict[str, list[bytes]] = {}
    lines: list[bytes] = []
    for raw in content.splitlines():
        line = raw.strip()
        if not line or line.startswith((b";", b"#")):
            continue
        opened = _SECTION.match(line)
        if opened is None:
            lines.append(line)
            continue
        lines = sections.setdefault(opened[1].decode(), [])
        if lines:
            raise damaged("holds a section of the mesh twice")
    return sections


def _attributes(lines: list[bytes]) -> dict[str, bytes]:
    parts = (line.partition(b"=") for line in lines)
    return {name.strip().decode("latin-1"): value.strip() for name, _, value in parts}


def _rows(sections: dict[str, list[bytes]], name: str, count: int, columns: int) -> Floats:
    """Rows ``index = numbers`` of a section, the index first."""
    lines = sections.get(name, [])
    if len(lines) != count:
        raise damaged(f"announces {count:,} rows of {name} and holds {len(lines):,}")
    if not count:
        return np.empty((0, columns))
    table = number_table([line.replace(b"=", b" ", 1) for line in lines], where=f"its {name}")
    if table.shape[1] < columns:
        raise damaged(f"holds rows of {table.shape[1]} numbers in {name}, not {columns}")
    if (table[:, 0] != np.arange(count)).any():
        raise damaged(f"numbers the rows of {name} in another way than 0, 1, 2 …")
    return table


def _kept_faces(vertices: Floats, triangles: Floats, omissions: Omissions) -> Faces:
    corners = triangles[:, 1:4]
    named = (corners == np.round(corners)) & (corners >= 0) & (corners < len(vertices))
    if not named.all():
        raise damaged(f"holds a triangle at a vertex that is none of its {len(vertices):,}")
    faces = corners.astype(np.int64)
    deleted: Truths = triangles[:, 7] == DELETED_GROUP
    if len(vertices):
        deleted |= (vertices[:, 7] == DELETED_GROUP)[faces].any(axis=1)
    omissions.add("triangles of deleted anatomy left out", int(deleted.sum()))
    kept: Faces = faces[~deleted]
    require_positions(vertices[:, 1:4], kept)
    return kept


def _colours(
    sections: dict[str, list[bytes]], about: dict[str, bytes], count: int, omissions: Omissions
) -> tuple[dict[str, Floats], dict[str, str]]:
    if not sections.get("VerticesColorsSection"):
        omissions.add("vertices without a value of the vendor's", count)
        return {}, {}
    table = _rows(sections, "VerticesColorsSection", count, 1)[:, 1:]
    names = about.get("ColorsNames", b"").decode("latin-1").split()
    omissions.add("colour columns without a name left out", max(table.shape[1] - len(names), 0))
    fields: dict[str, Floats] = {}
    units: dict[str, str] = {}
    for written, column in zip(names, table.T, strict=False):
        name, unit = _colour(written)
        values = np.where(column == MISSING, np.nan, column)
        if not np.isfinite(values).any():
            omissions.add("colour columns without a value left out")
        elif not name or name in fields:
            omissions.add("colour columns of another meaning left out")
        else:
            fields[name], units[name] = values, unit
    return fields, units


def _scar(sections: dict[str, list[bytes]], count: int) -> Floats:
    """The first of the vertices' attributes: 1 where the operator marked scar."""
    if not sections.get("VerticesAttributesSection"):
        return np.zeros(count)
    marks: Floats = _rows(sections, "VerticesAttributesSection", count, 2)[:, 1]
    return marks


def _colour(written: str) -> tuple[str, str]:
    if written in COLOURS:
        return COLOURS[written]
    # The micro sign is written in several encodings, as M-5Bi among them
    return _MICRO_BIPOLAR if written.endswith("Bi") else ("", "")
