"""Rows of a CSV file, and tables of Markdown made of them."""

from collections.abc import Iterable, Sequence

import numpy as np

Row = dict[str, str]


def number(row: Row, name: str) -> float:
    """A cell as a number."""
    return float(row[name])


def median(rows: Iterable[Row], name: str) -> str:
    """Median of a column, to three digits."""
    values = [number(row, name) for row in rows if row[name]]
    return f"{np.median(values):.3g}" if values else "–"


def values_of(rows: Sequence[Row], name: str) -> list[str]:
    """Values a column takes, numbers in order."""
    found = {row[name] for row in rows}
    try:
        return sorted(found, key=float)
    except ValueError:
        return sorted(found)


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def where(rows: Sequence[Row], **kept: str) -> list[Row]:
    """Rows with these values."""
    return [row for row in rows if all(row[name] == value for name, value in kept.items())]
