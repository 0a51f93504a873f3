"""Schur complements of a multifrontal elimination: made, stored, and handed on to the parent.

Of a complement the lower triangle is stored, strip by strip of rows, each row as long as the last
of its strip and filled up to whole registers; what is above the diagonal there means nothing.
"""

from auricle.arrays import Floats
from auricle.compiled import compiled
from auricle.spectral.elimination import EliminationPlan
from auricle.spectral.lanes import eight
from auricle.spectral.side_by_side import set_side_by_side
from auricle.spectral.tile_sums import TILE, sum_lines, tile_width

_STRIP = 64
"""Rows of a strip."""


@compiled
def multiply(stream: Floats, place: int, under: Floats, complement: Floats, room: Floats) -> None:
    """The Schur complement (to subtract) of a supernode with so many rows under its columns.

    Parameters
    ----------
    stream, place
        Where L is, as `auricle.spectral.factor_streams.pack` puts it.
    under
        What was under the columns before, shape (m, w).
    complement
        Filled, at least `complement_size` numbers.
    room
        For eight of those rows.
    """
    height, n_columns = under.shape
    for left in range(0, height, TILE):
        set_side_by_side(under[left : left + TILE], room, TILE)
        p = place + left * n_columns
        for row in range(left, height, TILE):
            begin, step = _row_begin(row, height), _row_length(row, height)
            part = (p, tile_width(height - row), n_columns)
            target = (complement, begin + left, step)
            sum_lines(stream, part, (room, 0, TILE), target, eight(0.0))
            p += TILE * n_columns


@compiled
def subtract_from_columns(
    plan: EliminationPlan, child: int, complement: Floats, panel: Floats
) -> None:
    """Take from a panel what a child's Schur complement holds of its columns."""
    mother = plan.parent[child]
    width = plan.first_column[mother + 1] - plan.first_column[mother]
    places = plan.places[plan.row_start[child] : plan.row_start[child + 1]]
    inside = 0
    for i in range(len(places)):
        begin, row = _row_begin(i, len(places)), places[i] * width
        inside += places[i] < width
        for j in range(inside):
            panel[row + places[j]] -= complement[begin + j]


@compiled
def add_to_complement(
    plan: EliminationPlan, child: int, complement: Floats, mothers: Floats
) -> None:
    """Hand on to the parent's Schur complement what a child's holds beyond the parent's columns."""
    mother = plan.parent[child]
    width = plan.first_column[mother + 1] - plan.first_column[mother]
    height = plan.row_start[mother + 1] - plan.row_start[mother]
    places = plan.places[plan.row_start[child] : plan.row_start[child + 1]]
    inside = 0
    while inside < len(places) and places[inside] < width:
        inside += 1
    for i in range(inside, len(places)):
        begin = _row_begin(i, len(places))
        row = _row_begin(places[i] - width, height) - width
        if places[i] - places[inside] == i - inside:
            for j in range(i - inside + 1):
                mothers[row + places[inside] + j] += complement[begin + inside + j]
        else:
            for j in range(inside, i + 1):
                mothers[row + places[j]] += complement[begin + j]


@compiled
def complement_size(n_rows: int) -> int:
    """Numbers that a stored Schur complement takes."""
    filled_up = n_rows + -n_rows % TILE
    return _row_begin(filled_up - 1, n_rows) + filled_up if n_rows > 0 else 0


@compiled
def _row_begin(row: int, n_rows: int) -> int:
    """Where a row of a stored Schur complement begins."""
    strip = row // _STRIP
    before = _STRIP * _STRIP * strip * (strip + 1) // 2
    return before + (row - strip * _STRIP) * _row_length(row, n_rows)


@compiled
def _row_length(row: int, n_rows: int) -> int:
    return min((row // _STRIP + 1) * _STRIP, n_rows + -n_rows % TILE)
