"""EnSite's surfaces: DIF XML (``DxLandmarkGeo.xml``, ``ModelGroups.xml``), faces from 1.

Each ``Map_data`` is named by the comment before it.
"""

from xml.etree.ElementTree import Comment, Element

import numpy as np

from auricle.arrays import Floats
from auricle.electroanatomy.formats.number_tables import number_table
from auricle.electroanatomy.formats.omissions import Omissions
from auricle.electroanatomy.formats.plain_xml import parse_xml
from auricle.electroanatomy.formats.positions import require_positions
from auricle.errors import FormatError
from auricle.surface.formats.header import MOST_CELLS, MOST_VERTICES, count_of, damaged
from auricle.surface.soup import TriangleSoup

_WHERE = "its geometry"
_MAPS = (("LAT", "local_activation_time", "ms"), ("P-P", "bipolar_voltage", "mV"))


def parse_dif(content: bytes) -> TriangleSoup:
    """Surface of the first volume of a DIF file, with the map data it carries.

    Raises
    ------
    FormatError
        If it is no DIF file, its counts lie, or a face names a vertex that is not there.
    """
    root = parse_xml(content, where=_WHERE, comments=True)
    body = root.find("DIFBody")
    if root.tag != "DIF" or body is None:
        raise FormatError("holds XML of another kind than DIF: give EnSite's geometry")
    volumes = list(body.iter("Volume"))
    if not volumes:
        raise damaged("holds no volume in its geometry")
    omissions = Omissions()
    omissions.add("further volumes left out", len(volumes) - 1)
    vertices = _table(volumes[0], "Vertices", 3)
    polygons = _table(volumes[0], "Polygons", 3)
    whole = (polygons == np.round(polygons)) & (polygons >= 1) & (polygons <= len(vertices))
    if not whole.all():
        raise damaged(f"holds a face at a vertex that is none of 1 … {len(vertices):,}")
    faces = polygons.astype(np.int64) - 1
    require_positions(vertices, faces)
    fields, units = _map_data(volumes[0], len(vertices), omissions)
    return TriangleSoup(
        vertices,
        faces,
        point_fields=fields,
        units=units,
        remarks=omissions.remarks,
    )


def _table(volume: Element, tag: str, columns: int) -> Floats:
    element = volume.find(tag)
    if element is None:
        raise damaged(f"holds no {tag} in its geometry")
    table = _numbers(element)
    if not len(table):
        return np.empty((0, columns))
    if table.shape[1] != columns:
        raise damaged(f"holds {tag} of {table.shape[1]} numbers, not {columns}")
    return table


def _numbers(element: Element) -> Floats:
    """Rows of numbers in an element, as many as it announces."""
    count = count_of(element.get("number", ""), str(element.tag))
    if count > max(MOST_VERTICES, MOST_CELLS):
        raise damaged(f"announces {count:,} {element.tag}")
    lines = [line for line in (element.text or "").encode().splitlines() if line.strip()]
    if len(lines) != count:
        raise damaged(f"announces {count:,} {element.tag} and holds {len(lines):,}")
    return number_table(lines, where=_WHERE)


def _map_data(
    volume: Element, count: int, omissions: Omissions
) -> tuple[dict[str, Floats], dict[str, str]]:
    fields: dict[str, Floats] = {}
    units: dict[str, str] = {}
    comment = ""
    for element in volume:
        tag: object = element.tag
        if tag is Comment:
            comment = element.text or ""
        elif tag == "Map_data":
            name, unit = _named(comment)
            values = _numbers(element)
            if values.shape != (count, 1):
                raise damaged(f"holds {len(values):,} values of a map for {count:,} vertices")
            if name and name not in fields:
                fields[name], units[name] = values[:, 0], unit
            else:
                omissions.add("maps of another meaning left out")
    return fields, units


def _named(comment: str) -> tuple[str, str]:
    found = ((name, unit) for mark, name, unit in _MAPS if mark in comment)
    return next(found, ("", ""))
