"""Mapping points from a table of text whose columns the user names."""

import csv
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from auricle.arrays import Floats
from auricle.electroanatomy.formats.number_tables import LARGEST
from auricle.electroanatomy.formats.omissions import Omissions
from auricle.electroanatomy.points import UNITS, MappingPoints
from auricle.electroanatomy.study import ElectroanatomicMap
from auricle.errors import FormatError, InputError
from auricle.surface.formats.header import damaged, within_limits

MILLIMETRES = MappingProxyType({"mm": 1.0, "cm": 10.0, "m": 1000.0, "um": 0.001})
FACTORS: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        "ms": MappingProxyType({"ms": 1.0, "s": 1000.0}),
        "mV": MappingProxyType({"mV": 1.0, "V": 1000.0, "uV": 0.001}),
        "ohm": MappingProxyType({"ohm": 1.0}),
        "g": MappingProxyType({"g": 1.0}),
    }
)
"""What a value in each known unit is multiplied by, per unit of `UNITS`."""
_MISSING_WORDS = ("", "nan", "na", "n/a", "-")
_MOST_BYTES = 1024**3


@dataclass(frozen=True)
class PointTable:
    """How a table of mapping points is written.

    Parameters
    ----------
    position
        Names of the columns of x, y and z.
    values
        Name of the column of each quantity of `auricle.electroanatomy.points.UNITS`.
    units
        Unit of each quantity in `values`, and of ``position``: no unit is guessed.
    projected_position
        Columns of x, y and z on the surface; empty if there are none.
    delimiter
        Between columns.
    decimal
        ``.`` or ``,``.
    encoding
        Of the text.
    missing
        A number that stands for a missing value (``-10000`` in CARTO's tables); NaN for none.

    Raises
    ------
    InputError
        If a quantity or a unit is unknown, or the unit of one is not stated.
    """

    position: tuple[str, str, str]
    units: Mapping[str, str]
    values: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    projected_position: tuple[str, ...] = ()
    delimiter: str = ","
    decimal: str = "."
    encoding: str = "utf-8"
    missing: float = math.nan

    def __post_init__(self) -> None:
        known = {"position": MILLIMETRES, **{name: FACTORS[UNITS[name]] for name in UNITS}}
        for name in ("position", *self.values):
            if name not in known:
                raise InputError(f"quantity {name!r} is unknown: choose of {', '.join(UNITS)}")
            if self.units.get(name) not in known[name]:
                raise InputError(
                    f"the unit of {name} is {self.units.get(name)!r}: state one of "
                    f"{', '.join(known[name])}"
                )
        if self.decimal not in (".", ",") or self.decimal == self.delimiter:
            raise InputError("the decimal mark is . or , and not the delimiter: state both")

    def factor(self, name: str) -> float:
        """What the file's numbers of a quantity, or of ``position``, are multiplied by."""
        factors = MILLIMETRES if name == "position" else FACTORS[UNITS[name]]
        return factors[self.units[name]]


def read_points_csv(path: Path, table: PointTable) -> ElectroanatomicMap:
    """Read mapping points from a text table with a row of column names.

    Columns nobody named are not read. Rows without a position are left out and counted.

    Parameters
    ----------
    path
        The file.
    table
        How it is written.

    Raises
    ------
    FormatError
        If it cannot be decoded, lacks a column, has a short row, or a word is not a number; the
        message begins with the path.
    """
    try:
        within_limits(path)
        return _map(path.read_bytes(), table)
    except OSError as fault:
        raise FormatError(f"{path}: cannot be read: check the place") from fault
    except FormatError as fault:
        raise FormatError(f"{path}: {fault}") from fault


def _map(content: bytes, table: PointTable) -> ElectroanatomicMap:
    names, rows = _rows(content, table)
    columns = _Columns(names, rows, table)
    position = columns.triple(table.position)
    placed = np.isfinite(position).all(axis=1)
    projected = (
        columns.triple(table.projected_position)
        if table.projected_position
        else (np.full_like(position, np.nan))
    )
    omissions = Omissions()
    omissions.add("points without a position left out", int((~placed).sum()))
    values: dict[str, Any] = {
        name: columns.one(column)[placed] * table.factor(name)
        for name, column in table.values.items()
    }
    points = MappingPoints(
        position[placed] * table.factor("position"),
        projected[placed] * table.factor("position"),
        identifiers=np.flatnonzero(placed) + 1,
        **values,
    )
    return ElectroanatomicMap("map 1", points=points, remarks=omissions.remarks)


def _rows(content: bytes, table: PointTable) -> tuple[list[str], list[list[str]]]:
    if len(content) > _MOST_BYTES:
        raise FormatError(f"has {len(content):,} bytes, the limit is {_MOST_BYTES:,}: split it")
    try:
        text = content.decode(table.encoding).removeprefix("\ufeff")
    except (UnicodeDecodeError, LookupError) as fault:
        raise FormatError(f"is not text in {table.encoding!r}: state its encoding") from fault
    try:
        lines = [row for row in csv.reader(text.splitlines(), delimiter=table.delimiter) if row]
    except csv.Error as fault:
        raise damaged("is not a table of text") from fault
    if not lines:
        raise damaged("holds no row of column names")
    names = [name.strip() for name in lines[0]]
    if any(len(row) != len(names) for row in lines[1:]):
        raise FormatError(
            f"holds rows of another length than the {len(names)} column names: "
            "check the delimiter and the decimal mark"
        )
    return names, lines[1:]


@dataclass(frozen=True)
class _Columns:
    names: list[str]
    rows: list[list[str]]
    table: PointTable

    def one(self, name: str) -> Floats:
        if self.names.count(name) != 1:
            raise FormatError(
                f"holds {self.names.count(name)} columns of the name {name!r}: name one there is"
            )
        place = self.names.index(name)
        values = np.array([self._number(row[place].strip(), name) for row in self.rows])
        values = values.astype(np.float64)
        values[values == self.table.missing] = np.nan
        return values

    def triple(self, names: tuple[str, ...]) -> Floats:
        return np.column_stack([self.one(name) for name in names])

    def _number(self, word: str, name: str) -> float:
        if word.lower() in _MISSING_WORDS:
            return math.nan
        if self.table.decimal == ",":
            word = word.replace(".", "?").replace(",", ".")
        try:
            value = float(word)
        except ValueError as fault:
            raise FormatError(
                f"holds a word in column {name!r} that is not a number: check the decimal mark"
            ) from fault
        if abs(value) > LARGEST:
            raise FormatError(f"holds an infinite number in column {name!r}: leave it empty")
        return value
