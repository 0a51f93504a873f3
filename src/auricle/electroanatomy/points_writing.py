"""Mapping points written as a table of text, a unit in every column's name."""

import csv
import io
import math
from pathlib import Path

from auricle.atomic import write_text
from auricle.electroanatomy.points import UNITS, MappingPoints


def write_points_csv(path: Path, points: MappingPoints) -> None:
    """Write every point in a row: number, whether the vendor's map uses it, positions, values.

    Numbers have as many digits as they take, a missing one is empty; quantities nobody recorded
    have no column. `auricle.electroanatomy.points_csv.read_points_csv` reads it back.

    Parameters
    ----------
    path
        Where to.
    points
        What to write.

    Raises
    ------
    OutputError
        If it cannot be written.
    """
    columns = {
        "point": [str(number) for number in points.identifiers],
        "included": [str(int(used)) for used in points.included],
        **_axes("", points.positions.T.tolist()),
        **_axes("projected_", points.projected_positions.T.tolist()),
        **{f"{name}_{UNITS[name]}": _words(getattr(points, name)) for name in points.recorded},
    }
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(columns)
    table.writerows(zip(*columns.values(), strict=True))
    write_text(path, text.getvalue())


def _axes(prefix: str, coordinates: list[list[float]]) -> dict[str, list[str]]:
    names = (f"{prefix}{axis}_mm" for axis in "xyz")
    return {name: _words(values) for name, values in zip(names, coordinates, strict=True)}


def _words(values: list[float]) -> list[str]:
    return ["" if math.isnan(value) else repr(float(value)) for value in values]
