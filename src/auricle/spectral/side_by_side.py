"""Vectors turned so that the same entry of several lies side by side, as registers take them."""

from auricle.arrays import Floats, Integers
from auricle.compiled import compiled


@compiled
def set_side_by_side(rows: Floats, order: Integers, columns: Floats, lanes: int) -> None:
    """Set entries of rows beside each other, in places for `lanes`, and in an order.

    Parameters
    ----------
    rows
        Shape (b, n or more), b not more than `lanes`.
    order
        Which entries come first, shape (n,).
    columns
        Shape (n·lanes,), filled; places beyond the rows are left.
    lanes
        How many entries lie side by side.
    """
    eights, fours = len(rows) - len(rows) % 8, len(rows) - len(rows) % 4
    for j in range(0, eights, 8):
        a, b, c, d = rows[j], rows[j + 1], rows[j + 2], rows[j + 3]
        e, f, g, h = rows[j + 4], rows[j + 5], rows[j + 6], rows[j + 7]
        for i in range(len(order)):
            place, k = i * lanes + j, order[i]
            columns[place], columns[place + 1] = a[k], b[k]
            columns[place + 2], columns[place + 3] = c[k], d[k]
            columns[place + 4], columns[place + 5] = e[k], f[k]
            columns[place + 6], columns[place + 7] = g[k], h[k]
    for j in range(eights, fours, 4):
        a, b, c, d = rows[j], rows[j + 1], rows[j + 2], rows[j + 3]
        for i in range(len(order)):
            place, k = i * lanes + j, order[i]
            columns[place], columns[place + 1] = a[k], b[k]
            columns[place + 2], columns[place + 3] = c[k], d[k]
    for j in range(fours, len(rows)):
        for i in range(len(order)):
            columns[i * lanes + j] = rows[j, order[i]]


@compiled
def set_apart(columns: Floats, lanes: int, order: Integers, rows: Floats) -> None:
    """Undo `set_side_by_side`."""
    eights, fours = len(rows) - len(rows) % 8, len(rows) - len(rows) % 4
    for j in range(0, eights, 8):
        a, b, c, d = rows[j], rows[j + 1], rows[j + 2], rows[j + 3]
        e, f, g, h = rows[j + 4], rows[j + 5], rows[j + 6], rows[j + 7]
        for i in range(len(order)):
            place, k = i * lanes + j, order[i]
            a[k], b[k] = columns[place], columns[place + 1]
            c[k], d[k] = columns[place + 2], columns[place + 3]
            e[k], f[k] = columns[place + 4], columns[place + 5]
            g[k], h[k] = columns[place + 6], columns[place + 7]
    for j in range(eights, fours, 4):
        a, b, c, d = rows[j], rows[j + 1], rows[j + 2], rows[j + 3]
        for i in range(len(order)):
            place, k = i * lanes + j, order[i]
            a[k], b[k] = columns[place], columns[place + 1]
            c[k], d[k] = columns[place + 2], columns[place + 3]
    for j in range(fours, len(rows)):
        for i in range(len(order)):
            rows[j, order[i]] = columns[i * lanes + j]
