"""EnSite X's tables brought together: points with values, waveforms by point and freeze group."""

import math

import numpy as np

from auricle.arrays import Floats, Integers
from auricle.electroanatomy.electrogram import MILLISECONDS, Electrogram
from auricle.electroanatomy.formats.ensite_x import XTable
from auricle.electroanatomy.formats.omissions import Omissions
from auricle.electroanatomy.points import MappingPoints
from auricle.surface.formats.header import damaged


def assembled_points(
    tables: list[XTable], waves: dict[str, XTable], omissions: Omissions, *, signals: bool
) -> tuple[MappingPoints, dict[int, Electrogram], tuple[float, float]]:
    """Points of the first table, values of all, electrograms of the waves, and the window.

    Parameters
    ----------
    tables
        One or more of ``Map_*.csv``.
    waves
        Tables of ``Wave_*.csv`` by role: ``bipolar``, ``unipolar``, ``reference``.
    omissions
        Where points left out are counted.
    signals
        Bring electrograms along.

    Raises
    ------
    FormatError
        If a table numbers two points alike, or waveforms differ in rate or length.
    """
    first = tables[0]
    position = _triples(first, "roving")
    placed = np.flatnonzero(np.isfinite(position).all(axis=1) & np.isfinite(first.point_numbers))
    omissions.add("points without a position left out", len(position) - len(placed))
    numbers = first.point_numbers[placed].astype(np.int64)
    if len(np.unique(numbers)) < len(numbers):
        raise damaged("numbers two points alike in a table of points")
    values = _Values(tables, numbers)
    rates = [table.rate for table in (*waves.values(), *tables) if not math.isnan(table.rate)]
    rate = rates[0] if rates else math.nan
    ticks = values.of("Ref Tick"), values.of("Rov Tick 1")
    used = values.of("utilized")
    points = MappingPoints(
        position[placed],
        _triples(first, "surface")[placed],
        local_activation_time=(ticks[1] - ticks[0]) / rate * MILLISECONDS,
        bipolar_voltage=values.of("pp_Valong", "P-P"),
        unipolar_voltage=values.of("pp_Vmax", "unipoleMaxPP"),
        force=values.of("force (g)"),
        identifiers=numbers,
        included=np.where(np.isnan(used), 1.0, used) != 0.0,
    )
    shift = values.of("adjTime (ms)") / MILLISECONDS * rate
    marks = [tick - np.where(np.isnan(shift), 0.0, np.round(shift)) for tick in ticks]
    windows = np.column_stack([values.of("left curtain (ms)"), values.of("right curtain (ms)")])
    known = windows[np.isfinite(windows).all(axis=1)]
    window = (float(known[0, 0]), float(known[0, 1])) if len(known) else (math.nan, math.nan)
    if not signals:
        return points, {}, window
    if len({(table.rate, table.samples.shape[1]) for table in waves.values()}) > 1:
        raise damaged("holds waveforms of different rates or lengths")
    groups = values.of("Freeze Grp #", "(Freeze Grp #)")
    return points, _waveforms(waves, numbers, groups, marks, windows), window


class _Values:
    """Columns looked up in several tables by the number of the point."""

    def __init__(self, tables: list[XTable], numbers: Integers) -> None:
        self._tables, self._numbers = tables, numbers

    def of(self, *names: str) -> Floats:
        """Values of the first of the columns that any table has, one a point."""
        for name in names:
            for table in self._tables:
                column = table.column(name)
                if np.isfinite(column).any():
                    by_number = dict(zip(table.point_numbers, column, strict=True))
                    return np.array([by_number.get(k, math.nan) for k in self._numbers])
        return np.full(len(self._numbers), np.nan)


def _waveforms(
    waves: dict[str, XTable],
    numbers: Integers,
    groups: Floats,
    marks: list[Floats],
    windows: Floats,
) -> dict[int, Electrogram]:
    rows = {
        role: dict(
            zip(
                table.freeze_groups if role == "reference" else table.point_numbers,
                range(len(table.rows)),
                strict=True,
            )
        )
        for role, table in waves.items()
    }
    found = {}
    for place, number in enumerate(numbers):
        keys = {role: groups[place] if role == "reference" else number for role in waves}
        heard = {
            role: waves[role].samples[rows[role][key]]
            for role, key in keys.items()
            if key in rows[role]
        }
        if heard:
            found[place] = Electrogram(
                np.column_stack(list(heard.values())),
                next(iter(waves.values())).rate,
                tuple(heard),
                **{role: role for role in heard},
                reference_annotation=float(marks[0][place]),
                map_annotation=float(marks[1][place]),
                window_of_interest=(float(windows[place, 0]), float(windows[place, 1])),
            )
    return found


def _triples(table: XTable, name: str) -> Floats:
    return np.column_stack([table.column(f"{name} {axis}") for axis in "xyz"])
