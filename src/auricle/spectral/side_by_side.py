"""Vectors turned so that the same entry of several lies side by side, as registers take them."""

from auricle.arrays import Floats
from auricle.compiled import compiled


@compiled
def set_side_by_side(rows: Floats, columns: Floats, lanes: int) -> None:
    """Set entries of rows beside each other, in places for `lanes`.

    Parameters
    ----------
    rows
        Shape (b, n), b not more than `lanes`.
    columns
        Shape (n·lanes,), filled; places beyond the rows are left.
    lanes
        How many entries lie side by side.
    """
    eights, fours = len(rows) - len(rows) % 8, len(rows) - len(rows) % 4
    for j in range(0, eights, 8):
        a, b, c, d = rows[j], rows[j + 1], rows[j + 2], rows[j + 3]
        e, f, g, h = rows[j + 4], rows[j + 5], rows[j + 6], rows[j + 7]
        for i in range(rows.shape[1]):
            place = i * lanes + j
            columns[place], columns[place + 1] = a[i], b[i]
            columns[place + 2], columns[place + 3] = c[i], d[i]
            columns[place + 4], columns[place + 5] = e[i], f[i]
            columns[place + 6], columns[place + 7] = g[i], h[i]
    for j in range(eights, fours, 4):
        a, b, c, d = rows[j], rows[j + 1], rows[j + 2], rows[j + 3]
        for i in range(rows.shape[1]):
            place = i * lanes + j
            columns[place], columns[place + 1] = a[i], b[i]
            columns[place + 2], columns[place + 3] = c[i], d[i]
    for j in range(fours, len(rows)):
        for i in range(rows.shape[1]):
            columns[i * lanes + j] = rows[j, i]
