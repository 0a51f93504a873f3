"""EnSite exports: a folder a map, geometry in DIF XML, points and waveforms in CSV."""

import math
from collections.abc import Callable
from pathlib import PurePosixPath
from typing import TypeVar

import numpy as np

from auricle.electroanatomy.electrogram import Electrogram
from auricle.electroanatomy.formats.ensite_dxl import DxlFile, parse_dxl
from auricle.electroanatomy.formats.ensite_geometry import parse_dif
from auricle.electroanatomy.formats.ensite_x import parse_map_table, parse_wave_table
from auricle.electroanatomy.formats.ensite_x_points import assembled_points
from auricle.electroanatomy.formats.export_files import ExportFiles
from auricle.electroanatomy.formats.omissions import Omissions
from auricle.electroanatomy.points import MappingPoints, no_points
from auricle.electroanatomy.study import ElectroanatomicMap, ElectroanatomicStudy
from auricle.errors import FormatError
from auricle.surface.soup import TriangleSoup

PRECISION, X = "EnSite Precision", "EnSite X"
_GEOMETRIES = (
    "dxlandmarkgeo.xml",
    "contact_mapping_model.xml",
    "modelgroups.xml",
    "model_groups.xml",
)
_WAVES = {
    "wave_rov.csv": "bipolar",
    "wave_bi_along.csv": "bipolar",
    "wave_uni_distal.csv": "unipolar",
    "wave_uni_along.csv": "unipolar",
    "wave_refs.csv": "reference",
}
Parsed = TypeVar("Parsed")


def is_ensite(files: ExportFiles) -> bool:
    """Whether the export holds points or a geometry under EnSite's names."""
    return bool(_map_folders(files))


def read_ensite(files: ExportFiles, *, signals: bool = True) -> ElectroanatomicStudy:
    """Read every map of an export of EnSite Precision or EnSite X.

    Parameters
    ----------
    files
        The export.
    signals
        Read electrograms as well.

    Raises
    ------
    FormatError
        If a file that is there is damaged; files that are not are counted in the remarks.
    """
    used: set[str] = set()
    folders = _map_folders(files)
    is_x = any(_named(files, folder, "map_", ".csv") for folder in folders)
    maps = tuple(
        _Folder(files, folder, number, used).read(is_x=is_x, signals=signals)
        for number, folder in enumerate(folders, start=1)
    )
    omissions = Omissions()
    if signals:
        omissions.add("other files not read", len(set(files.names) - used))
    return ElectroanatomicStudy(X if is_x else PRECISION, maps, omissions.remarks)


def _map_folders(files: ExportFiles) -> list[PurePosixPath]:
    """Folders that hold points, or where there are none a geometry."""
    parents = {PurePosixPath(name).parent for name in files.names}
    with_points = [
        folder
        for folder in sorted(parents)
        if _named(files, folder, "dxl_", ".csv") or _named(files, folder, "map_", ".csv")
    ]
    alone = [folder for folder in sorted(parents) if _geometry(files, folder) is not None]
    return with_points or alone


def _named(files: ExportFiles, folder: PurePosixPath, start: str, end: str) -> list[str]:
    return [
        name
        for name in files.names
        if PurePosixPath(name).parent == folder
        and PurePosixPath(name).name.lower().startswith(start)
        and name.lower().endswith(end)
    ]


def _geometry(files: ExportFiles, folder: PurePosixPath) -> str | None:
    for wanted in _GEOMETRIES:
        found = _named(files, folder, wanted, "")
        if found:
            return found[0]
    return None


class _Folder:
    """The files of one map."""

    def __init__(
        self, files: ExportFiles, folder: PurePosixPath, number: int, used: set[str]
    ) -> None:
        self._files, self._folder, self._number, self._used = files, folder, number, used
        self._omissions = Omissions()

    def read(self, *, is_x: bool, signals: bool) -> ElectroanatomicMap:
        surface = self._surface()
        read_points = self._x_points if is_x else self._dxl_points
        points, electrograms, window = read_points(signals=signals)
        self._omissions.add("points without an electrogram", len(points) - len(electrograms))
        remarks = () if surface is None else surface.remarks
        return ElectroanatomicMap(
            f"map {self._number}",
            surface,
            points,
            electrograms,
            window_of_interest=window,
            remarks=remarks + self._omissions.remarks,
        )

    def _parsed(self, name: str, parse: Callable[[bytes], Parsed], what: str) -> Parsed:
        self._used.add(name)
        try:
            return parse(self._files.read(name))
        except FormatError as fault:
            raise FormatError(f"{what} of map {self._number} {fault}") from fault

    def _surface(self) -> TriangleSoup | None:
        for folder in (self._folder, self._folder.parent):
            place = _geometry(self._files, folder)
            if place is not None:
                return self._parsed(place, parse_dif, "the geometry")
        self._omissions.add("surfaces not there")
        return None

    def _dxl_points(
        self, *, signals: bool
    ) -> tuple[MappingPoints, dict[int, Electrogram], tuple[float, float]]:
        parts = [
            self._parsed(
                name,
                lambda content: parse_dxl(content, self._omissions, signals=signals),
                "a file of points",
            )
            for name in _named(self._files, self._folder, "dxl_", ".csv")
        ]
        parts.sort(key=lambda part: part.place)
        announced = max((part.total for part in parts), default=0)
        self._omissions.add("files of points not there", announced - len(parts))
        return *_joined(parts), (math.nan, math.nan)

    def _x_points(
        self, *, signals: bool
    ) -> tuple[MappingPoints, dict[int, Electrogram], tuple[float, float]]:
        tables = [
            self._parsed(name, parse_map_table, "a table of points")
            for name in _named(self._files, self._folder, "map_", ".csv")
        ]
        waves = {
            role: self._parsed(name, parse_wave_table, "a table of waveforms")
            for wanted, role in reversed(_WAVES.items())
            for name in _named(self._files, self._folder, wanted, "")
        }
        return assembled_points(tables, waves, self._omissions, signals=signals)


def _joined(parts: list[DxlFile]) -> tuple[MappingPoints, dict[int, Electrogram]]:
    if not parts:
        return no_points(), {}
    columns = {
        name: np.concatenate([getattr(part.points, name) for part in parts])
        for name in MappingPoints.__dataclass_fields__
    }
    starts = np.cumsum([0, *(len(part.points) for part in parts)]).tolist()
    electrograms = {
        start + row: signal
        for start, part in zip(starts, parts, strict=False)
        for row, signal in part.electrograms.items()
    }
    return MappingPoints(**columns), electrograms
