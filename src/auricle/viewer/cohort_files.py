"""The folder a study wrote, read back: its cases, Table 1, τ, and the cases that failed."""

import csv
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from auricle.arrays import Floats
from auricle.errors import FormatError
from auricle.study.paper.packing import unpacked
from auricle.surface.soup import TriangleSoup

CASE_FORMAT = "auricle case 1"
_LARGEST_FILE = 64 * 2**20
_MOST_CASES = 20_000
_LARGEST_ARRAY = 27_000_000
"""Letters of base64: 20 MB."""

Row = Mapping[str, str | float | None]
"""A line of a table: numbers as numbers, what is empty or infinite as None."""


@dataclass(frozen=True)
class FailedCase:
    """A case without a result: its name, and why, in one line."""

    name: str
    error: str


def is_cohort(path: Path) -> bool:
    """Whether a folder holds the cases of a study."""
    return path.is_dir() and any((path / "cases").glob("*.json"))


def case_places(folder: Path) -> dict[str, Path]:
    """The files of finished cases by their key.

    Raises
    ------
    FormatError
        If there are more than 20,000.
    """
    places = {place.stem: place for place in sorted((folder / "cases").glob("[!.]*.json"))}
    if len(places) > _MOST_CASES:
        raise FormatError(
            f"holds {len(places):,} cases: open a folder with at most {_MOST_CASES:,}"
        )
    return places


def case_values(place: Path) -> Mapping[str, Any]:
    """What was found in a case.

    Raises
    ------
    FormatError
        If the file is damaged or none of a study's.
    """
    document = _document(place)
    values = document.get("values")
    if document.get("format") != CASE_FORMAT or not isinstance(values, dict):
        raise FormatError(f"{place.name} is no case of a study: run the study again")
    return values


def failed_cases(folder: Path, finished: Sequence[str]) -> tuple[FailedCase, ...]:
    """Cases that have a failure and no result.

    Raises
    ------
    FormatError
        If a file is damaged.
    """
    places = sorted((folder / "failures").glob("[!.]*.json"))
    documents = [_document(place) for place in places if place.stem not in finished]
    return tuple(
        FailedCase(str(each.get("case", "")), str(each.get("error", ""))) for each in documents
    )


def table_rows(place: Path) -> tuple[Row, ...]:
    """The lines of a CSV table of a study; none if it is not there yet.

    Raises
    ------
    FormatError
        If it is too large or no text.
    """
    if not place.is_file():
        return ()
    _require_small(place)
    try:
        lines = place.read_text(encoding="utf-8").splitlines()
    except ValueError as fault:
        raise FormatError(f"{place.name} is no text: run the study again") from fault
    return tuple(
        {name: _cell(text or "") for name, text in line.items() if name is not None}
        for line in csv.DictReader(lines)
    )


def surface_of_case(values: Mapping[str, Any]) -> TriangleSoup:
    """The analysed surface a case kept, about its own middle, with its focal maps.

    Raises
    ------
    FormatError
        If it kept none, or the arrays are torn.
    """
    kept = values.get("surfaces")
    if not isinstance(kept, dict) or "original" not in kept:
        raise FormatError("this case kept no surface: run the study with surfaces_kept = true")
    try:
        vertices = _array(kept["original"]["vertices_mm"])
        faces = _array(kept["original"]["faces"]).astype(np.int64)
        fields = dict(_maps(kept.get("maps", ()), len(vertices)))
    except (KeyError, ValueError, TypeError, AttributeError) as fault:
        raise FormatError("the surface of this case is torn: run the case again") from fault
    return TriangleSoup(vertices, faces, point_fields=fields, space="unknown")


def _maps(maps: Sequence[Mapping[str, Any]], n_vertices: int) -> Iterator[tuple[str, Floats]]:
    for one in maps:
        values = _array(one["values"])
        if values.shape != (n_vertices,):
            raise ValueError("one value a vertex is wanted")
        yield f"{one['n_foci']}_foci_{float(one['sigma_mm']):g}_mm", values


def _array(document: Mapping[str, Any]) -> Floats:
    """What the study packed, if it is of a surface's size."""
    if len(document["base64"]) > _LARGEST_ARRAY:
        raise ValueError("too large")
    return unpacked(document)


def _document(place: Path) -> dict[str, Any]:
    _require_small(place)
    try:
        found = json.loads(place.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as fault:
        raise FormatError(f"{place.name} is damaged: run the study again") from fault
    return found if isinstance(found, dict) else {}


def _require_small(place: Path) -> None:
    if place.stat().st_size > _LARGEST_FILE:
        raise FormatError(f"{place.name} is larger than 64 MB: it is no file of a study")


def _cell(text: str) -> str | float | None:
    if not text:
        return None
    try:
        number = float(text)
    except ValueError:
        return text
    return number if math.isfinite(number) else None
