"""Solves with block LDLᵀ factors: forward and backward substitution, several columns at a time."""

import numpy as np

from auricle.arrays import Floats
from auricle.compiled import compiled, compiled_inline
from auricle.spectral.elimination import EliminationPlan
from auricle.spectral.factor_streams import FactorStreams, down_size, up_size
from auricle.spectral.lanes import Lanes, load, store, subtracted, width
from auricle.spectral.tile_sums import TILE, lines_at_once, sum_lines


@compiled
def substitute(plan: EliminationPlan, streams: FactorStreams, columns: Floats, zero: Lanes) -> None:
    """Turn right-hand sides into solutions with the factors, in place.

    Parameters
    ----------
    plan, streams
        Of `auricle.spectral.ldl.eliminate`.
    columns
        Right-hand sides in the order of elimination, shape (n, b), contiguous.
    zero
        Of as many lanes as there are columns, 4 or 8, or half of 16.
    """
    room = np.empty(_room(plan) * width(zero))
    _substitute(plan, streams, (columns.reshape(-1), columns.shape[1]), room, zero)


@compiled_inline
def _substitute(
    plan: EliminationPlan,
    streams: FactorStreams,
    right: tuple[Floats, int],
    room: Floats,
    zero: Lanes,
) -> None:
    columns, n_right = right
    place = 0
    for s in range(len(plan.parent)):
        for side in range(0, n_right, width(zero)):
            _forward(plan, s, (streams.down, place), (columns, n_right, side), room, zero)
        place += down_size(*_shape(plan, s))
    place = 0
    for s in range(len(plan.parent) - 1, -1, -1):
        for side in range(0, n_right, width(zero)):
            _backward(plan, s, (streams.up, place), (columns, n_right, side), room, zero)
        place += up_size(*_shape(plan, s))


@compiled_inline
def _shape(plan: EliminationPlan, s: int) -> tuple[int, int]:
    """Columns of a supernode, and rows under them."""
    n_columns = plan.first_column[s + 1] - plan.first_column[s]
    return n_columns, plan.row_start[s + 1] - plan.row_start[s]


@compiled_inline
def _forward(
    plan: EliminationPlan,
    s: int,
    stream: tuple[Floats, int],
    right: tuple[Floats, int, int],
    sums: Floats,
    zero: Lanes,
) -> None:
    """Take a supernode's part out of the rows under it."""
    numbers, place = stream
    columns, n_right, side = right
    n_columns, _ = _shape(plan, s)
    known = (columns, plan.first_column[s] * n_right + side, n_right)
    row, end = plan.row_start[s], plan.row_start[s + 1]
    while row < end:
        n_lines = lines_at_once(end - row, zero)
        part = (place, n_lines, n_columns)
        sum_lines(numbers, part, known, (sums, 0, width(zero)), zero)
        for i in range(min(n_lines, end - row)):
            target = plan.rows[row + i] * n_right + side
            found = load(zero, sums, i * width(zero))
            store(subtracted(load(zero, columns, target), found), columns, target)
        row, place = row + n_lines, place + n_lines * n_columns


@compiled_inline
def _gather(
    plan: EliminationPlan, s: int, right: tuple[Floats, int, int], room: Floats, zero: Lanes
) -> None:
    """Collect a supernode's own rows, and those under it with their sign changed."""
    columns, n_right, side = right
    place = 2 * TILE * width(zero)
    for k in range(plan.first_column[s], plan.first_column[s + 1]):
        store(load(zero, columns, k * n_right + side), room, place)
        place += width(zero)
    for r in range(plan.row_start[s], plan.row_start[s + 1]):
        found = load(zero, columns, plan.rows[r] * n_right + side)
        store(subtracted(zero, found), room, place)
        place += width(zero)


@compiled_inline
def _backward(
    plan: EliminationPlan,
    s: int,
    stream: tuple[Floats, int],
    right: tuple[Floats, int, int],
    room: Floats,
    zero: Lanes,
) -> None:
    """Solve for a supernode's part, the rows under it being known."""
    numbers, place = stream
    columns, n_right, side = right
    n_columns, n_rows = _shape(plan, s)
    height, known = n_columns + n_rows, (room, 2 * TILE * width(zero), width(zero))
    _gather(plan, s, right, room, zero)
    k, end = plan.first_column[s], plan.first_column[s + 1]
    while k < end:
        n_lines = lines_at_once(end - k, zero)
        target = k * n_right + side
        part = (place, n_lines, height)
        if n_lines <= end - k:
            sum_lines(numbers, part, known, (columns, target, n_right), zero)
        else:
            sum_lines(numbers, part, known, (room, 0, width(zero)), zero)
            for i in range(end - k):
                store(load(zero, room, i * width(zero)), columns, target + i * n_right)
        k, place = k + n_lines, place + n_lines * height


@compiled
def _room(plan: EliminationPlan) -> int:
    """Rows for the sums of two tiles, and for all columns and rows of the tallest panel."""
    tallest = 0
    for s in range(len(plan.parent)):
        n_columns, n_rows = _shape(plan, s)
        tallest = max(tallest, n_columns + n_rows)
    return 2 * TILE + tallest
