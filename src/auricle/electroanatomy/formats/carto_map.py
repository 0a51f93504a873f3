"""One map of a CARTO 3 export: its surface, points, forces and electrograms, found by its name."""

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import PurePosixPath
from typing import TypeVar
from xml.etree.ElementTree import Element

import numpy as np

from auricle.electroanatomy.electrogram import Electrogram
from auricle.electroanatomy.formats.carto_mesh import parse_carto_mesh
from auricle.electroanatomy.formats.carto_points import (
    CartoPoint,
    PointExport,
    parse_car,
    parse_force,
    parse_point_export,
    study_points,
)
from auricle.electroanatomy.formats.carto_signals import SAMPLING_RATE, parse_carto_signals
from auricle.electroanatomy.formats.export_files import ExportFiles
from auricle.electroanatomy.formats.omissions import Omissions
from auricle.electroanatomy.formats.plain_xml import parse_xml
from auricle.electroanatomy.naming import channel_names, map_name
from auricle.electroanatomy.points import UNITS, MappingPoints
from auricle.electroanatomy.study import ElectroanatomicMap
from auricle.errors import FormatError
from auricle.surface.soup import TriangleSoup

MOST_SIGNAL_BYTES = 4 * 1024**3
"""Of electrograms, once read."""
_TOLERANCE_MS = 1.0
Parsed = TypeVar("Parsed")


@dataclass
class CartoExport:
    """Files of one study, found by name whatever its case, and which were read.

    Attributes
    ----------
    files
        The export.
    folder
        Where in it the study's XML lies.
    signals, all_channels
        Whether electrograms are read, and whether every channel of them.
    """

    files: ExportFiles
    folder: PurePosixPath
    signals: bool
    all_channels: bool

    def __post_init__(self) -> None:
        self.places = {name.lower(): name for name in self.files.names}
        self.used: set[str] = set()
        self.held = 0

    def content(self, name: str) -> bytes | None:
        """Content of a file beside the study's XML, None if there is none of this name."""
        place = self.places.get((self.folder / name).as_posix().lower())
        if place is None or not name:
            return None
        self.used.add(place)
        return self.files.read(place)


def read_carto_map(export: CartoExport, element: Element, number: int) -> ElectroanatomicMap:
    """Read the map that an element of the study's XML announces.

    Parameters
    ----------
    export
        Files of the study.
    element
        ``Map`` of its XML.
    number
        Which of its maps this is, from 1.

    Raises
    ------
    FormatError
        If a file that is there is damaged, or electrograms are more than memory should hold.
    """
    written = element.get("Name", "")
    name, is_written = map_name(written, number)
    omissions = Omissions()
    omissions.add("names left out, being free text", int(not is_written))
    part = _Part(export, number, omissions)
    surface = part.surface(element)
    rows = part.rows(written, element)
    exports = part.point_exports(written)
    _complete(rows, exports, omissions)
    part.forces(rows, exports)
    return ElectroanatomicMap(
        name,
        None if surface is None else replace(surface, remarks=()),
        _table(rows),
        part.electrograms(rows, exports) if export.signals else {},
        window_of_interest=_common_window(exports, omissions),
        remarks=(() if surface is None else surface.remarks) + omissions.remarks,
    )


@dataclass
class _Part:
    """The files of one map."""

    export: CartoExport
    number: int
    omissions: Omissions

    def parsed(
        self, name: str, parse: Callable[[bytes], Parsed], *, what: str, missing: str
    ) -> Parsed | None:
        """What `parse` makes of a file; None, and a count, if there is none."""
        content = self.export.content(name)
        if content is None:
            self.omissions.add(missing)
            return None
        try:
            return parse(content)
        except FormatError as fault:
            raise FormatError(f"{what} of map {self.number} {fault}") from fault

    def surface(self, element: Element) -> TriangleSoup | None:
        names = element.get("FileNames", "").split(",")
        count = element.get("NumFiles", "1").strip()
        if count.isdecimal() and int(count) > 1:
            self.omissions.add("further surfaces left out", int(count) - 1)
        return self.parsed(
            names[0].strip(), parse_carto_mesh, what="the mesh", missing="surfaces not there"
        )

    def rows(self, written: str, element: Element) -> list[CartoPoint]:
        """Points of the car file, their projections from the study."""
        listed = {point.identifier: point for point in study_points(element.find("CartoPoints"))}
        name = f"{written}_car.txt"
        rows = self.parsed(name, parse_car, what="the car file", missing="car files not there")
        if rows is None:
            return _placed(list(listed.values()), self.omissions)
        alone = len(listed.keys() - {row.identifier for row in rows})
        self.omissions.add("points of the study that its car file lacks left out", alone)
        for row in rows:
            if row.identifier in listed:
                row.projected = listed[row.identifier].projected
        return _placed(rows, self.omissions)

    def point_exports(self, written: str) -> dict[int, PointExport]:
        """Point exports by the number of their point, as the map's index names them."""
        index = self.parsed(
            f"{written}_Points_Export.xml",
            lambda content: parse_xml(content, where="an index of points"),
            what="the index of points",
            missing="indices of points not there",
        )
        exports = {}
        for entry in [] if index is None else index.findall("Point"):
            found = self.parsed(
                entry.get("File_Name", ""),
                lambda content: parse_point_export(parse_xml(content, where="a point's export")),
                what="a point's export",
                missing="point exports not there",
            )
            identifier = entry.get("ID", "")
            if found is not None and identifier.isdecimal():
                exports[int(identifier)] = found
        return exports

    def forces(self, rows: list[CartoPoint], exports: dict[int, PointExport]) -> None:
        """Put the force at acquisition into each row."""
        for row in rows:
            point = exports.get(row.identifier)
            if point is None or not point.force_file:
                continue
            force = self.parsed(
                point.force_file, parse_force, what="a force file", missing="force files not there"
            )
            if force is not None:
                row.values["force"] = force

    def electrograms(
        self, rows: list[CartoPoint], exports: dict[int, PointExport]
    ) -> dict[int, Electrogram]:
        """Electrograms by row."""
        found = {}
        for place, row in enumerate(rows):
            point = exports.get(row.identifier)
            signal = None if point is None else self._electrogram(point)
            if signal is None:
                self.omissions.add("points without an electrogram")
                continue
            found[place] = signal
            self.export.held += signal.samples.nbytes
            if self.export.held > MOST_SIGNAL_BYTES:
                raise FormatError(
                    f"holds more than {MOST_SIGNAL_BYTES:,} bytes of electrograms: "
                    "read it without them, or without all channels"
                )
        return found

    def _electrogram(self, point: PointExport) -> Electrogram | None:
        signals = self.parsed(
            point.signals_file,
            lambda content: parse_carto_signals(content, all_channels=self.export.all_channels),
            what="an electrogram file",
            missing="electrogram files not there",
        )
        if signals is None:
            return None
        names = channel_names(list(signals.channels))
        roles = {
            role: names[signals.channels.index(written)]
            for role, written in signals.roles.items()
            if written in signals.channels
        }
        self.omissions.add("named channels not there", len(signals.roles) - len(roles))
        return Electrogram(
            signals.samples,
            SAMPLING_RATE,
            names,
            bipolar=roles.get("bipolar", ""),
            unipolar=roles.get("unipolar", ""),
            reference=roles.get("reference", ""),
            reference_annotation=point.reference_annotation,
            map_annotation=point.map_annotation,
            window_of_interest=point.window_of_interest,
        )


def _placed(rows: list[CartoPoint], omissions: Omissions) -> list[CartoPoint]:
    """Keep the points that have a position and a number of their own."""
    placed: dict[int, CartoPoint] = {}
    for row in rows:
        if not all(map(math.isfinite, row.position)):
            omissions.add("points without a position left out")
        elif row.identifier in placed:
            omissions.add("points of a number met before left out")
        else:
            placed[row.identifier] = row
    return list(placed.values())


def _complete(
    rows: list[CartoPoint], exports: dict[int, PointExport], omissions: Omissions
) -> None:
    """Let annotations decide activation times, and fill voltages the car file lacks."""
    for row in rows:
        point = exports.get(row.identifier)
        if point is None:
            continue
        annotated = point.local_activation_time
        listed = row.values.get("local_activation_time", math.nan)
        if abs(annotated - listed) > _TOLERANCE_MS:
            omissions.add("activation times taken from the annotations, the car file disagreeing")
        if not math.isnan(annotated):
            row.values["local_activation_time"] = annotated
        for name, value in point.voltages.items():
            if math.isnan(row.values.get(name, math.nan)):
                row.values[name] = value


def _table(rows: list[CartoPoint]) -> MappingPoints:
    columns = {name: np.array([row.values.get(name, math.nan) for row in rows]) for name in UNITS}
    return MappingPoints(
        np.array([row.position for row in rows]).reshape(-1, 3),
        np.array([row.projected for row in rows]).reshape(-1, 3),
        identifiers=np.array([row.identifier for row in rows], np.int64),
        **columns,
    )


def _common_window(exports: dict[int, PointExport], omissions: Omissions) -> tuple[float, float]:
    windows = Counter(
        point.window_of_interest
        for point in exports.values()
        if not any(map(math.isnan, point.window_of_interest))
    )
    if not windows:
        return math.nan, math.nan
    (window, count), *_ = windows.most_common(1)
    omissions.add("points of another window of interest than the map's", windows.total() - count)
    return window
