"""Solves with block LDLᵀ factors: forward and backward substitution, several columns at a time."""

import numpy as np

from auricle.arrays import Floats
from auricle.compiled import compiled
from auricle.spectral.elimination import EliminationPlan
from auricle.spectral.lanes import (
    Lanes,
    added,
    added_multiple,
    eight,
    four,
    load,
    prefetch,
    store,
    subtracted,
    width,
)

NARROW, WIDE, AT_ONCE = 4, 8, 16
"""Right-hand sides that a register holds, one kind or the other, and that are solved at a time."""
_AGAIN = 5
"""Of eight lines so many at most are gone through again, where fewer than eight are left."""
_AHEAD = 8192
"""By how many numbers panels are asked for before they are used, on the way back."""


def substitute(plan: EliminationPlan, panels: Floats, columns: Floats) -> None:
    """Turn right-hand sides into solutions with the factors, in place.

    Parameters
    ----------
    plan, panels
        Of `auricle.spectral.ldl.eliminate`.
    columns
        Right-hand sides in the order of elimination, shape (n, b), contiguous; b is 4, 8 or 16.
    """
    numbers, n_right = columns.reshape(-1), columns.shape[1]
    if n_right == NARROW:
        _substitute_four(plan, panels, numbers, n_right)
    else:
        _substitute_eight(plan, panels, numbers, n_right)


@compiled
def _substitute_four(plan: EliminationPlan, panels: Floats, columns: Floats, n_right: int) -> None:
    _substitute(plan, panels, columns, n_right, four(0.0))


@compiled
def _substitute_eight(plan: EliminationPlan, panels: Floats, columns: Floats, n_right: int) -> None:
    _substitute(plan, panels, columns, n_right, eight(0.0))


@compiled
def _substitute(
    plan: EliminationPlan, panels: Floats, columns: Floats, n_right: int, zero: Lanes
) -> None:
    room = np.empty(_tallest_panel(plan) * width(zero))
    for s in range(len(plan.parent)):
        for side in range(0, n_right, width(zero)):
            _forward(plan, s, panels, (columns, n_right, side), zero)
    for s in range(len(plan.parent) - 1, -1, -1):
        for side in range(0, n_right, width(zero)):
            _gather(plan, s, (columns, n_right, side), room, zero)
            _backward(plan, s, panels, (columns, n_right, side), room, zero)


@compiled
def _forward(
    plan: EliminationPlan,
    s: int,
    panels: Floats,
    right: tuple[Floats, int, int],
    zero: Lanes,
) -> None:
    """Take a supernode's part out of the rows under it, eight rows at a time."""
    columns, n_right, side = right
    first, n_columns = plan.first_column[s], plan.first_column[s + 1] - plan.first_column[s]
    known = first * n_right + side
    p = _under(plan, s)
    row, end = plan.row_start[s], plan.row_start[s + 1]
    ahead = _under(plan, min(s + 1, len(plan.parent) - 1))
    while row < end:
        again = max(row + 8 - end, 0)
        if again > min(_AGAIN, row - plan.row_start[s]):
            break
        row, p = row - again, p - again * n_columns
        places = (p, n_columns, 1, ahead)
        sums = eight_dots(panels, places, n_columns, (columns, known, n_right), zero)
        for i in range(8):
            if i >= again:
                _take(columns, plan.rows[row + i] * n_right + side, sums[i])
        row, p, ahead = row + 8, p + 8 * n_columns, ahead + 8 * n_columns
    while row < end:
        rest = _dot(panels, p, 1, n_columns, (columns, known, n_right), zero)
        _take(columns, plan.rows[row] * n_right + side, rest)
        row, p = row + 1, p + n_columns


@compiled
def _under(plan: EliminationPlan, s: int) -> int:
    """Where in the panels the rows under a supernode begin."""
    n_columns = plan.first_column[s + 1] - plan.first_column[s]
    return int(plan.panel_start[s] + n_columns * n_columns)


@compiled
def _gather(
    plan: EliminationPlan, s: int, right: tuple[Floats, int, int], room: Floats, zero: Lanes
) -> None:
    """Collect a supernode's own rows, and those under it with their sign changed."""
    columns, n_right, side = right
    place = 0
    for k in range(plan.first_column[s], plan.first_column[s + 1]):
        store(load(zero, columns, k * n_right + side), room, place)
        place += width(zero)
    for r in range(plan.row_start[s], plan.row_start[s + 1]):
        found = load(zero, columns, plan.rows[r] * n_right + side)
        store(subtracted(zero, found), room, place)
        place += width(zero)


@compiled
def _backward(
    plan: EliminationPlan,
    s: int,
    panels: Floats,
    right: tuple[Floats, int, int],
    room: Floats,
    zero: Lanes,
) -> None:
    """Solve for a supernode's part, the rows under it being known, eight columns at a time."""
    columns, n_right, side = right
    first, n_columns = plan.first_column[s], plan.first_column[s + 1] - plan.first_column[s]
    height = n_columns + plan.row_start[s + 1] - plan.row_start[s]
    target, k = first * n_right + side, 0
    ahead = plan.panel_start[s] - _AHEAD
    while k < n_columns:
        again = max(k + 8 - n_columns, 0)
        if again > min(_AGAIN, k):
            break
        k, target = k - again, target - again * n_right
        p = plan.panel_start[s] + k
        places = (p, 1, n_columns, ahead)
        sums = eight_dots(panels, places, height, (room, 0, width(zero)), zero)
        ahead += 8 * height
        for i in range(8):
            store(sums[i], columns, target + i * n_right)
        k, target = k + 8, target + 8 * n_right
    while k < n_columns:
        p = plan.panel_start[s] + k
        store(_dot(panels, p, n_columns, height, (room, 0, width(zero)), zero), columns, target)
        k, target = k + 1, target + n_right


@compiled
def eight_dots(
    panels: Floats,
    places: tuple[int, int, int, int],
    count: int,
    vectors: tuple[Floats, int, int],
    zero: Lanes,
) -> tuple[Lanes, Lanes, Lanes, Lanes, Lanes, Lanes, Lanes, Lanes]:
    """What `_dot` gives for eight lines of a panel at once, whose sums fit into registers.

    `places` are where the first line begins, how far apart lines are, the step along them, and
    what will be wanted next.
    """
    place, line, step, ahead = places
    rows, begin, apart = vectors
    a, b, c, d, e, f, g, h = zero, zero, zero, zero, zero, zero, zero, zero
    for _ in range(count):
        prefetch(panels, ahead)
        x = load(zero, rows, begin)
        a = added_multiple(a, panels, place, x)
        b = added_multiple(b, panels, place + line, x)
        c = added_multiple(c, panels, place + 2 * line, x)
        d = added_multiple(d, panels, place + 3 * line, x)
        e = added_multiple(e, panels, place + 4 * line, x)
        f = added_multiple(f, panels, place + 5 * line, x)
        g = added_multiple(g, panels, place + 6 * line, x)
        h = added_multiple(h, panels, place + 7 * line, x)
        place, begin, ahead = place + step, begin + apart, ahead + 8
    return a, b, c, d, e, f, g, h


@compiled
def _dot(
    panels: Floats,
    place: int,
    step: int,
    count: int,
    vectors: tuple[Floats, int, int],
    zero: Lanes,
) -> Lanes:
    """Sum of `count` numbers of a panel, each times its row of `vectors`; four sums side by side.

    `vectors` are the array, where in it the first row begins, and how far apart rows are.
    """
    rows, begin, apart = vectors
    a, b, c, d = zero, zero, zero, zero
    k = 0
    while k + 4 <= count:
        a = added_multiple(a, panels, place, load(zero, rows, begin))
        b = added_multiple(b, panels, place + step, load(zero, rows, begin + apart))
        c = added_multiple(c, panels, place + 2 * step, load(zero, rows, begin + 2 * apart))
        d = added_multiple(d, panels, place + 3 * step, load(zero, rows, begin + 3 * apart))
        k, place, begin = k + 4, place + 4 * step, begin + 4 * apart
    while k < count:
        a = added_multiple(a, panels, place, load(zero, rows, begin))
        k, place, begin = k + 1, place + step, begin + apart
    return added(added(a, b), added(c, d))


@compiled
def _take(columns: Floats, place: int, sums: Lanes) -> None:
    store(subtracted(load(sums, columns, place), sums), columns, place)


@compiled
def _tallest_panel(plan: EliminationPlan) -> int:
    """Columns of the supernode, and rows under them, of the tallest panel."""
    tallest = 0
    for s in range(len(plan.parent)):
        n_columns = plan.first_column[s + 1] - plan.first_column[s]
        tallest = max(tallest, n_columns + plan.row_start[s + 1] - plan.row_start[s])
    return tallest
