"""EnSite X's contact mapping: ``Map_*.csv`` with a row a point, ``Wave_*.csv`` with its samples.

Column names after public importers of exports of revision 10: ``(Point #)``, ``roving x`` …
``surface z``, ``utilized``, ``Ref Tick`` and ``Rov Tick 1`` (samples), ``adjTime (ms)``,
``left curtain (ms)``, ``right curtain (ms)``, ``pp_Valong`` or ``P-P``, ``pp_Vmax`` (mV),
``force (g)``.
"""

import csv
import math
import re
from dataclasses import dataclass, field

import numpy as np

from auricle.arrays import Floats
from auricle.electroanatomy.formats.number_tables import number, number_table
from auricle.surface.formats.header import count_of, damaged

_COUNT = re.compile(r"# (?:mapping pts|freeze groups)\s*:\s*,?\s*(\S+?)\s*,?$", re.MULTILINE)
_RATE = re.compile(r"Sampl\w* (?:rate|freq\w*)[^:\n]*:\s*,?\s*([\d.]+)", re.IGNORECASE)
_POINT = ("(Point #)", "Point #", "(Point#)")
_FREEZE_GROUP = ("Freeze Grp #", "(Freeze Grp #)")
_MISSING_WORDS = ("", "invalid", "nan", "n/a")
_LEAST_SAMPLES = 2
_LIST_END = "EOF"


@dataclass
class XTable:
    """A table of one file: rows of words by column name, and what its header states."""

    rows: list[dict[str, str]]
    rate: float = math.nan
    samples: Floats = field(default_factory=lambda: np.empty((0, 0)))

    def column(self, *names: str) -> Floats:
        """Numbers of the first of these columns that is there; NaN if none is."""
        found = next((name for name in names if self.rows and name in self.rows[0]), None)
        if found is None:
            return np.full(len(self.rows), np.nan)
        return np.array([_number(row[found]) for row in self.rows])

    @property
    def point_numbers(self) -> Floats:
        """Number of each row's point."""
        return self.column(*_POINT)

    @property
    def freeze_groups(self) -> Floats:
        """Number of each row's freeze group, points recorded in one moment."""
        return self.column(*_FREEZE_GROUP)

    @property
    def traces(self) -> list[str]:
        """Name of each row's trace, empty where there is none."""
        names = ("Trace", "trace", "Electrodes", "Electrode")
        found = next((name for name in names if self.rows and name in self.rows[0]), None)
        return ["" if found is None else row[found] for row in self.rows]


def parse_map_table(content: bytes) -> XTable:
    """Table of a ``Map_*.csv``.

    Raises
    ------
    FormatError
        If it has no row of column names, or another number of rows than it announces.
    """
    text = content.decode("latin-1")
    head, names, rows = _split(text, waves=False)
    _require_count(head, len(rows))
    return XTable([dict(zip(names, row, strict=False)) for row in rows], _rate(head))


def parse_wave_table(content: bytes) -> XTable:
    """Table of a ``Wave_*.csv``, samples in the rows of `XTable.samples`, mV.

    Raises
    ------
    FormatError
        If it has no row of column names, states no rate, or its rows differ in length.
    """
    text = content.decode("latin-1")
    head, names, rows = _split(text, waves=True)
    _require_count(head, len(rows))
    rate = _rate(head)
    if math.isnan(rate):
        raise damaged("states no sampling rate of its waveforms")
    numbered = [place for place, name in enumerate(names) if _is_number(name)]
    lines = [",".join(row[place] for place in numbered).encode("latin-1") for row in rows]
    samples = number_table(lines, where="its waveforms", delimiter=",")
    about = [place for place in range(len(names)) if place not in set(numbered)]
    return XTable([{names[k]: row[k] for k in about} for row in rows], rate, samples)


def _split(text: str, *, waves: bool) -> tuple[str, list[str], list[list[str]]]:
    """Header, column names and rows."""
    lines = text.splitlines()
    for place, line in enumerate(lines):
        names = [name.strip() for name in next(csv.reader([line]), [])]
        if _names_columns(names, waves=waves):
            while names and names[-1] in ("", "..."):
                names.pop()
            rows = _rows(lines[place + 1 :], len(names))
            return "\n".join(lines[:place]), names, rows
    raise damaged("names no columns of its points")


def _names_columns(names: list[str], *, waves: bool) -> bool:
    if not any(name in names for name in (*_POINT, *_FREEZE_GROUP)):
        return False
    return sum(map(_is_number, names)) >= _LEAST_SAMPLES if waves else "roving x" in names


def _rows(lines: list[str], columns: int) -> list[list[str]]:
    rows = []
    for line in lines:
        if not line.strip(" ,\t") or line.strip(" ,").upper().startswith(_LIST_END):
            continue
        words = [word.strip() for word in next(csv.reader([line]))]
        if len(words) < columns:
            raise damaged("holds a row of points that is cut short")
        rows.append(words[:columns])
    return rows


def _require_count(head: str, count: int) -> None:
    announced = _COUNT.search(head)
    if announced is not None and count_of(announced[1], "points") != count:
        raise damaged(f"announces {announced[1][:15]} points and holds {count:,}")


def _rate(head: str) -> float:
    found = _RATE.search(head)
    return number(found[1], where="its header") if found else math.nan


def _number(word: str) -> float:
    return math.nan if word.lower() in _MISSING_WORDS else number(word, where="its points")


def _is_number(word: str) -> bool:
    return re.fullmatch(r"-?\d+(?:\.\d+)?", word) is not None
