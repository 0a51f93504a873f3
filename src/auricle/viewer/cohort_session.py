"""The study open in the page: a line a case, Table 1, τ."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from auricle.errors import InputError
from auricle.progress import Progress, silent
from auricle.surface.soup import TriangleSoup
from auricle.viewer.cohort_files import (
    FailedCase,
    Row,
    case_places,
    case_values,
    failed_cases,
    surface_of_case,
    table_rows,
)

_HEADLINES = {"gd": "gd_from_original_mm", "mse": "mse_mm2"}
"""Which reading of the paper's two errors is shown; fitted to even counts, without a floor."""
_METHODS = ("mha", "qslim")


@dataclass(frozen=True)
class Column:
    """A number of each case: its name in the data, its words, its unit."""

    key: str
    words: str
    unit: str
    value: Callable[[Mapping[str, Any]], object]


def _at(*path: str, over: float = 1.0) -> Callable[[Mapping[str, Any]], object]:
    def value(values: Mapping[str, Any]) -> object:
        found: Any = values
        for name in path:
            found = found.get(name) if isinstance(found, dict) else None
        number = _number(found)
        return None if number is None else number / over

    return value


def _tau(method: str, error: str) -> Callable[[Mapping[str, Any]], object]:
    wanted = {
        "method": method,
        "error": _HEADLINES[error],
        "range": "even",
        "with_floor": False,
    }

    def value(values: Mapping[str, Any]) -> object:
        records = values.get("decay")
        for record in records if isinstance(records, list) else []:
            if isinstance(record, dict) and wanted.items() <= record.items():
                return record.get("tau")
        return None

    return value


def _focal(size: str, share: str) -> Callable[[Mapping[str, Any]], object]:
    """Median over the placements of one focus."""

    def value(values: Mapping[str, Any]) -> object:
        records = values.get("features")
        for record in records if isinstance(records, list) else []:
            if isinstance(record, dict) and (record.get("size"), record.get("n_foci")) == (size, 1):
                counts = record.get("counts", {}).get(share, [])
                known = [math.inf if count is None else float(count) for count in counts]
                return float(np.median(known)) if known else None
        return None

    return value


COLUMNS = (
    Column("vertices", "Vertices", "", _at("surface_analyzed", "n_vertices")),
    Column("area", "Area", "cm²", _at("surface_analyzed", "area_mm2", over=100.0)),
    Column("volume", "Volume", "ml", _at("surface_analyzed", "volume_mm3", over=1000.0)),
    Column("geometry_85", "Geometry, 85 %", "harmonics", _at("geometry", "counts", "0.85")),
    Column("geometry_90", "Geometry, 90 %", "harmonics", _at("geometry", "counts", "0.9")),
    Column("small_85", "Small focus, 85 %", "harmonics", _focal("small", "0.85")),
    Column("small_90", "Small focus, 90 %", "harmonics", _focal("small", "0.9")),
    Column("wide_90", "Wide focus, 90 %", "harmonics", _focal("wide", "0.9")),
    Column("tau_mha_gd", "τ GD, MHA", "harmonics", _tau("mha", "gd")),
    Column("tau_qslim_gd", "τ GD, Qslim", "points", _tau("qslim", "gd")),
    Column("tau_mha_mse", "τ MSE, MHA", "harmonics", _tau("mha", "mse")),
    Column("tau_qslim_mse", "τ MSE, Qslim", "points", _tau("qslim", "mse")),
)


@dataclass(frozen=True, eq=False)
class CohortSession:
    """A study in the page.

    Attributes
    ----------
    name
        Of its folder.
    places
        Files of the finished cases, by key.
    cases
        What is shown of each: key, name, kind, whether it kept a surface, and its numbers.
    failed
        Cases without a result.
    table1, decay
        Lines of the study's tables.
    """

    name: str
    places: Mapping[str, Path]
    cases: tuple[Mapping[str, Any], ...]
    failed: tuple[FailedCase, ...]
    table1: tuple[Row, ...]
    decay: tuple[Row, ...]

    @property
    def views(self) -> tuple[str, ...]:
        """It can be looked through."""
        return ("cohort",)

    def described(self) -> Mapping[str, Any]:
        """How many cases there are."""
        return {
            "cohort": {
                "name": self.name,
                "n_cases": len(self.cases),
                "n_failed": len(self.failed),
            }
        }

    def document(self) -> Mapping[str, Any]:
        """Everything the page shows of the study, numbers with their units."""
        return {
            "name": self.name,
            "columns": [
                {"key": column.key, "words": column.words, "unit": column.unit}
                for column in COLUMNS
            ],
            "cases": list(self.cases),
            "medians": _medians(self.cases),
            "failed": [{"name": each.name, "error": each.error} for each in self.failed],
            "table1": list(self.table1),
            "decay": [row for row in self.decay if _is_headline(row)],
        }

    def surface(self, key: str) -> tuple[str, TriangleSoup]:
        """Name and surface of a case.

        Raises
        ------
        InputError
            If there is no such case, or it kept no surface.
        """
        place = self.places.get(key)
        if place is None:
            raise InputError("this study has no such case: open it again")
        values = case_values(place)
        return str(values.get("name", key)), surface_of_case(values)


def cohort_session(folder: Path, *, progress: Progress = silent) -> CohortSession:
    """Read the folder of a study.

    Raises
    ------
    FormatError
        If a file is damaged.
    """
    places = case_places(folder)
    cases = []
    for done, (key, place) in enumerate(places.items()):
        progress("read cases", done, len(places))
        cases.append(_case(key, case_values(place)))
    progress("read cases", len(places), len(places))
    return CohortSession(
        folder.name,
        places,
        tuple(cases),
        failed_cases(folder, list(places)),
        table_rows(folder / "table1.csv"),
        table_rows(folder / "decay.csv"),
    )


def _case(key: str, values: Mapping[str, Any]) -> Mapping[str, Any]:
    surfaces = values.get("surfaces")
    return {
        "key": key,
        "name": str(values.get("name", key)),
        "kind": str(values.get("kind", "")),
        "opens": isinstance(surfaces, dict) and "original" in surfaces,
        "numbers": {column.key: _number(column.value(values)) for column in COLUMNS},
    }


def _is_headline(row: Row) -> bool:
    return (
        row.get("reading") in _HEADLINES.values()
        and row.get("counts") == "even"
        and row.get("with_floor") == "False"
    )


def _number(value: object) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        return None
    return float(value)


def _medians(cases: Sequence[Mapping[str, Any]]) -> Mapping[str, float | None]:
    """Median of each column over the cases that have it."""
    found: dict[str, float | None] = {}
    for column in COLUMNS:
        known = [each["numbers"][column.key] for each in cases]
        known = [number for number in known if number is not None]
        found[column.key] = float(np.median(known)) if known else None
    return found
