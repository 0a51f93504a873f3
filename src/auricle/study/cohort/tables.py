"""A cohort as tables: one row a case as CSV and Parquet, one row a number as Parquet."""

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from itertools import chain
from pathlib import Path
from typing import Any

from auricle.atomic import write_text, write_whole
from auricle.study.cohort.case import Case
from auricle.study.cohort.costs import stage_costs
from auricle.study.cohort.gathering import Cohort

Scalar = str | float | int | bool | None

_SAME_FOR_ALL = ("parameters", "versions", "format", "notice")
_BULK = {"surfaces", "coefficients_mm", "share_by_harmonic", "accumulated_share"}
"""Long arrays, which stay in the cases' own files."""
_FORMULA = ("=", "+", "-", "@", "\t", "\r")


def write_tables(cohort: Cohort, folder: Path) -> tuple[Path, ...]:
    """Write the tables of a cohort; returns their places.

    ``cohort.csv`` and ``cohort.parquet``: one row a case, its single numbers and words.
    ``measurements.parquet``: every number of every case, with the path to it in the case's file
    as the quantity (``quality.mha.gd_mm.3``). ``costs.csv``: seconds by stage.
    ``failures.csv``: cases without a result.

    Raises
    ------
    OutputError
        If they cannot be written.
    """
    rows = [case_row(kept.case, kept.values) for kept in cohort.finished]
    columns = list(dict.fromkeys(chain.from_iterable(rows)))
    places = [folder / name for name in ("cohort.csv", "cohort.parquet", "measurements.parquet")]
    write_text(places[0], csv_text(columns, rows))
    write_whole(places[1], lambda place: _write_parquet(place, _columns_of(columns, rows)))
    write_whole(places[2], lambda place: _write_parquet(place, _measurements(cohort)))
    costs = folder / "costs.csv"
    stages = [asdict(cost) for cost in stage_costs(cohort.finished)]
    write_text(costs, csv_text(list(stages[0]) if stages else ["stage"], stages))
    failures = folder / "failures.csv"
    failed = [{"case": case.name, "error": error} for case, error in cohort.missing]
    write_text(failures, csv_text(["case", "error"], failed))
    return (*places, costs, failures)


def case_row(case: Case, values: Mapping[str, Any]) -> dict[str, Scalar]:
    """The single numbers and words of a case, by the path to them.

    Examples
    --------
    >>> values = {"area": {"mm2": 3.5}, "counts": [1, 2], "versions": {"numpy": "2"}}
    >>> case_row(Case("a", "a.vtp", "0f"), values)
    {'case': 'a', 'key': '0f', 'area.mm2': 3.5}
    """
    kept = {
        path: value
        for path, value in _leaves(values, lists=False)
        if path.partition(".")[0] not in _SAME_FOR_ALL
    }
    return {"case": case.name, "key": case.key} | kept


def _leaves(tree: Any, *, lists: bool, path: str = "") -> Iterator[tuple[str, Scalar]]:
    """Single values in a tree and the paths to them; those in lists if asked for."""
    if isinstance(tree, Mapping):
        for name in (each for each in tree if each not in _BULK):
            yield from _leaves(
                tree[name], lists=lists, path=f"{path}.{name}" if path else str(name)
            )
    elif isinstance(tree, list | tuple):
        if lists:
            for index, branch in enumerate(tree):
                yield from _leaves(branch, lists=lists, path=f"{path}.{index}")
    else:
        yield path, tree


def csv_text(columns: Sequence[str], rows: Sequence[Mapping[str, Scalar]]) -> str:
    """Rows as CSV; a text a spreadsheet would compute is kept a text by an apostrophe."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(columns)
    for row in rows:
        table.writerow([_cell(row.get(column)) for column in columns])
    return text.getvalue()


def _cell(value: Scalar) -> Scalar:
    if isinstance(value, str) and value.startswith(_FORMULA):
        return f"'{value}"
    return value


def _columns_of(
    columns: Sequence[str], rows: Sequence[Mapping[str, Scalar]]
) -> dict[str, list[Scalar]]:
    return {column: _of_one_kind([row.get(column) for row in rows]) for column in columns}


def _of_one_kind(values: list[Scalar]) -> list[Scalar]:
    """Values a column can hold: numbers as they are, a mixture as text."""
    kinds = {type(value) for value in values if value is not None}
    if len(kinds) < 2 or kinds == {int, float}:
        return [
            float(value) if kinds == {int, float} and value is not None else value
            for value in values
        ]
    return [None if value is None else str(value) for value in values]


def _measurements(cohort: Cohort) -> dict[str, list[Scalar]]:
    rows = [
        (kept.case.name, path, float(value))
        for kept in cohort.finished
        for path, value in _leaves(kept.values, lists=True)
        if path.partition(".")[0] not in _SAME_FOR_ALL
        and isinstance(value, int | float)
        and not isinstance(value, bool)
    ]
    names, paths, numbers = zip(*rows, strict=True) if rows else ((), (), ())
    return {"case": list(names), "quantity": list(paths), "value": list(numbers)}


def _write_parquet(place: Path, columns: Mapping[str, list[Scalar]]) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    pq.write_table(pa.table(dict(columns)), place, compression="zstd")
