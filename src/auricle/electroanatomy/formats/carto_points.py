"""CARTO 3's mapping points: ``_car.txt``, the study's points and ``Point_Export`` files."""

import math
import re
from dataclasses import dataclass, field
from xml.etree.ElementTree import Element

import numpy as np

from auricle.electroanatomy.formats.carto_mesh import MISSING
from auricle.electroanatomy.formats.number_tables import number
from auricle.errors import FormatError
from auricle.surface.formats.header import damaged

Triple = tuple[float, float, float]
NOWHERE: Triple = (math.nan, math.nan, math.nan)
_VERSION = re.compile(rb"VERSION_(\d+)_\d+")
_VERSIONS = (4, 5, 6)
_LEAST_COLUMNS = 14
_IDENTIFIER, _POSITION = 2, 4
_VALUE_COLUMNS = {
    "unipolar_voltage": 10,
    "bipolar_voltage": 11,
    "local_activation_time": 12,
    "impedance": 13,
}


@dataclass
class CartoPoint:
    """One point while its files are brought together; NaN is missing.

    Attributes
    ----------
    identifier
        Its number in the map.
    position, projected
        mm.
    values
        By OpenEP's name.
    """

    identifier: int
    position: Triple = NOWHERE
    projected: Triple = NOWHERE
    values: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class PointExport:
    """What a ``Point_Export`` file adds: annotations (samples), window (ms), names of files."""

    reference_annotation: float
    map_annotation: float
    window_of_interest: tuple[float, float]
    voltages: dict[str, float]
    signals_file: str
    force_file: str

    @property
    def local_activation_time(self) -> float:
        """Map annotation minus reference annotation, ms at 1 kHz; NaN if missing."""
        return self.map_annotation - self.reference_annotation


def parse_car(content: bytes) -> list[CartoPoint]:
    """Points of a ``_car.txt`` of version 4, 5 or 6, in the file's order.

    Raises
    ------
    FormatError
        If the version is another, a row is short, or a number is none.
    """
    lines = [line.strip() for line in content.splitlines() if line.strip()]
    version = _VERSION.match(lines[0]) if lines else None
    if version is None or int(version[1]) not in _VERSIONS:
        raise FormatError("holds points of a version that is none of 4, 5, 6: export it as one")
    return [_car_point(line) for line in lines[1:]]


def _car_point(line: bytes) -> CartoPoint:
    words = line.split(b"\t") if b"\t" in line else line.split()
    if words[0] != b"P" or len(words) < _LEAST_COLUMNS:
        raise damaged("holds a row of points that is cut short")
    where = "its points"
    x, y, z = (number(word, where=where) for word in words[_POSITION : _POSITION + 3])
    values = {
        name: known(number(words[column], where=where)) for name, column in _VALUE_COLUMNS.items()
    }
    return CartoPoint(whole(words[_IDENTIFIER]), (x, y, z), NOWHERE, values)


def study_points(points: Element | None) -> list[CartoPoint]:
    """Points that the study's XML lists for one map, with their projections.

    Raises
    ------
    FormatError
        If it announces another number of them, or a position is not three numbers.
    """
    if points is None:
        return []
    found = points.findall("Point")
    announced = points.get("Count", str(len(found)))
    if announced.strip() != str(len(found)):
        raise damaged(f"announces another number of points than the {len(found):,} it lists")
    return [_study_point(point) for point in found]


def _study_point(point: Element) -> CartoPoint:
    virtual = point.find("VirtualPoint")
    return CartoPoint(
        whole(point.get("Id", "")),
        _triple(point.get("Position3D")),
        NOWHERE if virtual is None else _triple(virtual.get("Position3D")),
    )


def parse_point_export(root: Element) -> PointExport:
    """Annotations and the names of further files of one point.

    Raises
    ------
    FormatError
        If a number is none.
    """
    marks = _attributes(root, "Annotations")
    window = _attributes(root, "WOI")
    voltages = _attributes(root, "Voltages")
    reference = _value(marks, "Reference_Annotation")
    mapped = _value(marks, "Map_Annotation")
    if mapped - reference == MISSING:
        mapped = math.nan
    return PointExport(
        reference,
        mapped,
        (_value(window, "From"), _value(window, "To")),
        {
            "unipolar_voltage": _value(voltages, "Unipolar"),
            "bipolar_voltage": _value(voltages, "Bipolar"),
        },
        _attributes(root, "ECG").get("FileName", ""),
        _attributes(root, "ContactForce").get("FileName", ""),
    )


def parse_force(content: bytes) -> float:
    """Contact force at the moment of acquisition, g: the sample nearest to time 0.

    NaN where the file holds no sample.

    Raises
    ------
    FormatError
        If a number is none.
    """
    lines = content.splitlines()
    starts = [place for place, line in enumerate(lines) if line.startswith(b"Index")]
    rows = [line.split() for line in lines[starts[0] + 1 :]] if starts else []
    samples = [
        (abs(number(row[1], where="a force file")), number(row[3], where="a force file"))
        for row in rows
        if len(row) > 3
    ]
    return known(min(samples)[1]) if samples else math.nan


def known(value: float) -> float:
    """The value, NaN for CARTO's mark of a missing one."""
    return math.nan if value == MISSING or not math.isfinite(value) else value


def whole(word: bytes | str) -> int:
    """A point's number."""
    value = number(word, where="the number of a point")
    if not np.isfinite(value) or value != round(value):
        raise damaged("numbers a point with what is no whole number")
    return round(value)


def _attributes(root: Element, tag: str) -> dict[str, str]:
    found = root.find(tag)
    return {} if found is None else dict(found.attrib)


def _value(attributes: dict[str, str], name: str) -> float:
    if name not in attributes:
        return math.nan
    return known(number(attributes[name], where="a point's export"))


def _triple(text: str | None) -> Triple:
    words = (text or "").split()
    if not words:
        return NOWHERE
    if len(words) != 3:
        raise damaged("holds a position that is not three numbers")
    x, y, z = (number(word, where="a position") for word in words)
    return x, y, z
