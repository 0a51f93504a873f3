"""Samples read from a table: CSV with a header, as mapping systems and spreadsheets write it."""

import csv
import io
import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from auricle.arrays import Floats, Points
from auricle.errors import FormatError
from auricle.sampling.samples import Samples

LARGEST_FILE = 256 * 2**20
_DELIMITERS = (";", "\t", ",")
_MILLIMETRES = {"": 1.0, "mm": 1.0, "cm": 10.0, "m": 1000.0, "um": 1e-3, "µm": 1e-3}
_UNITS = (*filter(None, _MILLIMETRES), "ms", "s", "mv", "uv", "µv", "v", "ohm", "g")
_MISSING = ("", "nan", "na", "n/a", "null", "none", "-")
_HEADING = re.compile(r"^(.*?)\s*(?:\[([^\]]*)\]|\(([^)]*)\))$")
_AXES = ("x", "y", "z")
_SHOWN = 40


def read_samples(
    path: Path,
    *,
    columns: Mapping[str, str] | None = None,
    value: str = "LAT",
    noise: str | None = None,
) -> Samples:
    """Read samples from a CSV file.

    The delimiter (comma, semicolon or tab) is the one that occurs most in the header; lines that
    begin with ``#`` and empty lines are skipped. A heading may carry a unit: ``x_mm``,
    ``LAT [ms]``, ``noise (ms)``; cases do not matter. Positions in µm, cm or m become mm, values
    stay in their unit. A decimal comma is understood unless the comma is the delimiter. Empty
    cells, ``NaN``, ``NA`` and ``-`` are missing values.

    Parameters
    ----------
    path
        UTF-8 text.
    columns
        Headings of the positions where they are not x, y and z: ``{"x": "Point X"}``.
    value
        Heading of the values, with or without its unit; becomes the samples' name.
    noise
        Heading of their standard deviations, if any.

    Raises
    ------
    FormatError
        If the file cannot be read, has no such column (those it has are listed), or a cell that
        is needed is no number; the message begins with the path and names the line.
    """
    try:
        headings, rows = _table(path)
        asked = {axis: (columns or {}).get(axis, axis) for axis in _AXES}
        places = [_column(headings, asked[axis]) for axis in _AXES]
        cells = [_numbers(rows, at, headings) for at in places]
        scales = [_millimetres(headings[at]) for at in places]
        at_value = _column(headings, value)
        values = _numbers(rows, at_value, headings)
        deviations = None if noise is None else _deviations(rows, headings, noise)
        name, unit = _name_and_unit(headings[at_value])
        positions = np.column_stack(cells) * scales
        return Samples(positions, values, deviations, name, unit)
    except OSError as fault:
        reason = fault.strerror or str(fault)
        raise FormatError(f"{path}: cannot be read ({reason}): check the place") from fault
    except FormatError as fault:
        raise FormatError(f"{path}: {fault}") from fault


def read_positions(path: Path, *, columns: Mapping[str, str] | None = None) -> Points:
    """Read the positions of samples from a CSV file, as `read_samples` does, without values.

    Shape (m, 3), mm; NaN where a cell is empty.

    Raises
    ------
    FormatError
        As `read_samples`.
    """
    try:
        headings, rows = _table(path)
        places = [_column(headings, (columns or {}).get(axis, axis)) for axis in _AXES]
        scales = [_millimetres(headings[at]) for at in places]
        positions: Points = np.column_stack([_numbers(rows, at, headings) for at in places])
        return positions * scales
    except OSError as fault:
        reason = fault.strerror or str(fault)
        raise FormatError(f"{path}: cannot be read ({reason}): check the place") from fault
    except FormatError as fault:
        raise FormatError(f"{path}: {fault}") from fault


def _table(path: Path) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """The headings, and every further row with its line number."""
    if path.is_dir():
        raise FormatError("is a folder: give a CSV file inside it")
    if path.stat().st_size > LARGEST_FILE:
        raise FormatError(f"is larger than {LARGEST_FILE >> 20} MB: give the samples only")
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as fault:
        raise FormatError("is not UTF-8 text: export it as CSV in UTF-8") from fault
    if "\0" in text:
        raise FormatError("is not text: export it as CSV in UTF-8")
    lines = ["" if line.lstrip().startswith("#") else line for line in text.splitlines()]
    first = next((line for line in lines if line.strip()), None)
    if first is None:
        raise FormatError("is empty: give a header and one sample at least")
    delimiter = max(_DELIMITERS, key=first.count)
    reader = csv.reader(io.StringIO("\n".join(lines)), delimiter=delimiter, strict=True)
    try:
        rows = [(reader.line_num, [cell.strip() for cell in row]) for row in reader]
    except csv.Error as fault:
        raise FormatError(f"line {reader.line_num} is damaged ({fault}): mend it") from fault
    filled = [(line, row) for line, row in rows if any(row)]
    return _with_header(filled, delimiter)


def _with_header(
    rows: list[tuple[int, list[str]]], delimiter: str
) -> tuple[list[str], list[tuple[int, list[str]]]]:
    headings = rows[0][1]
    if len(headings) < len(_AXES):
        raise FormatError(
            f"its header has {len(headings)} columns: give x, y, z and a value, separated by "
            "comma, semicolon or tab"
        )
    if all(_number(cell) is not None for cell in headings):
        raise FormatError("has no header, only numbers: name the columns in its first line")
    for line, row in rows[1:]:
        if len(row) != len(headings):
            comma = " (decimal commas need semicolons between columns)" if delimiter == "," else ""
            raise FormatError(
                f"line {line} has {len(row)} cells under {len(headings)} headings{comma}: mend it"
            )
    if len(rows) < 2:
        raise FormatError("has a header but no sample: give one at least")
    return headings, rows[1:]


def _column(headings: list[str], wanted: str) -> int:
    """Which column is meant: by its whole heading, or by the heading without its unit."""
    plain = wanted.strip().casefold()
    whole = [at for at, heading in enumerate(headings) if heading.casefold() == plain]
    named = [at for at, heading in enumerate(headings) if _same_name(heading, plain)]
    found = whole or named
    if len(found) == 1:
        return found[0]
    if found:
        raise FormatError(f"has {len(found)} columns {wanted!r}: name them apart")
    there = ", ".join(heading[:_SHOWN] for heading in headings)
    raise FormatError(f"has no column {wanted!r}: it has {there}; say which one is meant")


def _same_name(heading: str, plain: str) -> bool:
    return _name_and_unit(heading)[0].casefold() == plain


def _name_and_unit(heading: str) -> tuple[str, str]:
    """``LAT [ms]``, ``LAT (ms)`` and ``LAT_ms`` as LAT and ms."""
    bracketed = _HEADING.match(heading)
    if bracketed:
        return bracketed[1].rstrip("_ "), (bracketed[2] or bracketed[3] or "").strip()
    name, separator, unit = heading.replace(" ", "_").rpartition("_")
    if separator and unit.casefold() in _UNITS:
        return heading[: len(name)], unit
    return heading, ""


def _millimetres(heading: str) -> float:
    unit = _name_and_unit(heading)[1]
    if unit.casefold() not in _MILLIMETRES:
        raise FormatError(f"column {heading!r} is in {unit!r}: give mm, cm, m or µm")
    return _MILLIMETRES[unit.casefold()]


def _numbers(rows: list[tuple[int, list[str]]], at: int, headings: list[str]) -> Floats:
    numbers = np.empty(len(rows))
    for index, (line, row) in enumerate(rows):
        number = _number(row[at])
        if number is None:
            raise FormatError(
                f"line {line}, column {headings[at]!r}: {row[at][:_SHOWN]!r} is no number: "
                "correct it, or leave it empty"
            )
        numbers[index] = number
    return numbers


def _deviations(rows: list[tuple[int, list[str]]], headings: list[str], noise: str) -> Floats:
    deviations = _numbers(rows, _column(headings, noise), headings)
    wrong = np.flatnonzero(deviations <= 0)
    if len(wrong):
        raise FormatError(
            f"line {rows[wrong[0]][0]}: the noise {deviations[wrong[0]]:g} is not positive: "
            "correct it, or leave it empty"
        )
    return deviations


def _number(cell: str) -> float | None:
    """The number in a cell, NaN if missing, None if it is no number."""
    if cell.casefold() in _MISSING:
        return float("nan")
    plain = cell.replace(",", ".") if cell.count(",") == 1 and "." not in cell else cell
    try:
        number = float(plain) if "_" not in plain else None
    except ValueError:
        return None
    return number
