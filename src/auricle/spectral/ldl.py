"""Block LDLᵀ factors of a sparse symmetric indefinite matrix, by multifrontal elimination."""

import numpy as np

from auricle.arrays import Floats, Truths
from auricle.compiled import compiled
from auricle.spectral.elimination import EliminationPlan
from auricle.spectral.lanes import added_product, eight, load, store

_DOMINANCE = 0.3
"""A diagonal entry this large against the rest of its column is a pivot, else half of a pair."""
_TINY = 1e-11
"""Of the magnitude of the matrix's column: a pivot no larger than this is none."""
_BOLSTER, _MOST_BOLSTERS = 8.0, 16
"""Of the largest entry under a diagonal block: what is added to its diagonal; and how many times
that is done for one supernode."""
_LANES = 8
_STRIP = 64
"""Rows of a strip of a Schur complement, whose lower triangle is stored strip by strip."""
_LARGEST_PRODUCT = 64**3
"""Multiplications in one matrix product.

OpenBLAS shares larger ones out among threads, which on a busy machine is thirty times slower, and
makes the last digits depend on the number of threads.
"""


def eliminate(
    plan: EliminationPlan, data: Floats, shift: float, magnitudes: Floats, *, growth: float
) -> tuple[Floats, int, Floats] | None:
    """Factors of (matrix − shift·I + bolsters), and how many of its eigenvalues are negative.

    A panel of the result holds the inverse of its supernode's diagonal block and, below it, L.
    Pivots are sought within the diagonal block, one or two at a time, and never outside of it.
    Where the block is so near to singular that L would be large, and solves wrong, the row that
    is to blame is bolstered: its diagonal entry is enlarged beyond the size of what is under it.

    Parameters
    ----------
    plan
        Of the matrix's pattern.
    data
        The stored values of the matrix, in the order of the pattern that was planned.
    shift
        Taken from the diagonal.
    magnitudes
        Largest of each column of the matrix, shape (n,), in order of elimination.
    growth
        Largest entry that L may have.

    Returns
    -------
    tuple or None
        Panels, shape (plan.panel_start[-1],), the count, and what was added to the diagonal,
        shape (n,), in order of elimination; None where a last pivot, with nothing under it, is
        none: the matrix is singular to rounding.
    """
    panels = np.empty(int(plan.panel_start[-1]))
    stack = np.empty(_stack_size(plan))
    bolsters = np.zeros(len(magnitudes))
    n_negative = _eliminate(plan, (data, shift, magnitudes, growth), stack, panels, bolsters)
    return None if n_negative < 0 else (panels, int(n_negative), bolsters)


@compiled
def _eliminate(
    plan: EliminationPlan,
    values: tuple[Floats, float, Floats, float],
    stack: Floats,
    panels: Floats,
    bolsters: Floats,
) -> int:
    """Fill `panels` and `bolsters`; returns the number of negative eigenvalues, -1 for None."""
    data, shift, magnitudes, growth = values
    front = np.empty(_largest_panel(plan))
    room = np.empty(_room(plan))
    waiting = np.empty(len(plan.parent) + 1, np.int64)
    begins = np.zeros(len(plan.parent) + 2, np.int64)
    n_waiting, n_negative = 0, 0
    for s in range(len(plan.parent)):
        first, end = plan.first_column[s], plan.first_column[s + 1]
        panel = front[: plan.panel_start[s + 1] - plan.panel_start[s]]
        _assemble(plan, s, data, shift, panel)
        oldest = n_waiting
        while oldest > 0 and plan.parent[waiting[oldest - 1]] == s:
            oldest -= 1
            _subtract_from_columns(plan, waiting[oldest], stack[begins[oldest] :], panel)
        factor = panels[plan.panel_start[s] : plan.panel_start[s + 1]]
        pivots = (magnitudes[first:end], bolsters[first:end])
        n_here = _factor_panel(panel, pivots, growth, room, factor)
        if n_here < 0:
            return -1
        n_negative += n_here
        complement = stack[begins[n_waiting] :]
        _multiply(panel, end - first, factor, complement)
        for child in range(oldest, n_waiting):
            _add_to_complement(plan, waiting[child], stack[begins[child] :], complement)
        size = _complement_size(plan.row_start[s + 1] - plan.row_start[s])
        target = stack[begins[oldest] :]
        for k in range(size):
            target[k] = complement[k]
        waiting[oldest] = s
        begins[oldest + 1] = begins[oldest] + size
        n_waiting = oldest + 1
    return n_negative


@compiled
def _assemble(plan: EliminationPlan, s: int, data: Floats, shift: float, panel: Floats) -> None:
    """Set a panel to the entries of (matrix − shift·I)."""
    panel[:] = 0.0
    for e in range(plan.entry_start[s], plan.entry_start[s + 1]):
        panel[plan.entry_target[e]] += data[plan.entry_source[e]]
    width = plan.first_column[s + 1] - plan.first_column[s]
    for k in range(width):
        panel[k * width + k] -= shift


@compiled
def _subtract_from_columns(
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
def _add_to_complement(
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
def _multiply(panel: Floats, width: int, factor: Floats, complement: Floats) -> None:
    """The Schur complement (to subtract)."""
    height = len(panel) // width - width
    under = panel[width * width :].reshape((height, width))
    multipliers = factor[width * width :].reshape((height, width))
    room = np.empty(_STRIP * _STRIP)
    for first in range(0, height, _STRIP):
        end = min(first + _STRIP, height)
        begin = _row_begin(first, height)
        for left in range(0, end, _STRIP):
            right = min(left + _STRIP, end)
            tile = room[: (end - first) * (right - left)].reshape((end - first, right - left))
            np.dot(multipliers[first:end], under[left:right].T, tile)
            for i in range(end - first):
                for j in range(right - left):
                    complement[begin + i * end + left + j] = tile[i, j]


@compiled
def _multiply_rows(left: Floats, right: Floats, product: Floats) -> None:
    """Matrix product left·right, a few rows at a time."""
    step = max(_LARGEST_PRODUCT // right.size, 1)
    for first in range(0, len(left), step):
        end = min(first + step, len(left))
        np.dot(left[first:end], right, product[first:end])


@compiled
def _factor_panel(
    panel: Floats, pivots: tuple[Floats, Floats], growth: float, room: Floats, factor: Floats
) -> int:
    """Fill a factor's panel: the inverse of the square on top and, under it, L.

    `pivots` are magnitudes and bolsters of its columns. Returns the number of negative eigenvalues
    of the square, bolstered where L would be large; -1 if it is singular with nothing under it.
    """
    width = len(pivots[0])
    inverse = factor[: width * width].reshape((width, width))
    under = panel[width * width :].reshape((-1, width))
    multipliers = factor[width * width :].reshape((-1, width))
    bolster = _BOLSTER * _largest_entry(under)[0]
    for attempt in range(_MOST_BOLSTERS + 1):
        n_negative = _invert(panel, (pivots[0], pivots[1], bolster), room, factor)
        if n_negative < 0:
            break
        _multiply_rows(under, inverse, multipliers)
        largest, k = _largest_entry(multipliers)
        if attempt == _MOST_BOLSTERS or not largest > growth:
            break
        # A vector that the square nearly takes to zero is largest there.
        added = bolster if inverse[k, k] > 0 else -bolster
        panel[k * width + k] += added
        pivots[1][k] += added
    return n_negative


@compiled
def _largest_entry(rows: Floats) -> tuple[float, int]:
    """Largest magnitude, and in which column it is."""
    size, column = 0.0, 0
    for i in range(len(rows)):
        for k in range(rows.shape[1]):
            if abs(rows[i, k]) > size:
                size, column = abs(rows[i, k]), k
    return size, column


@compiled
def _invert(
    panel: Floats, pivots: tuple[Floats, Floats, float], room: Floats, factor: Floats
) -> int:
    """Invert the square on top of a panel, given by its lower triangle, into that of `factor`.

    By symmetric sweeps on the largest diagonal entry left, or, where that is small beside an
    entry next to it, on the two together. A pivot that is none is bolstered: `pivots` are
    magnitudes and bolsters of the columns, and what to add. Returns the number of negative pivots,
    which is that of negative eigenvalues; -1 if one is none and there is nothing to add. Rows are
    worked on in `room`, filled up to whole registers.
    """
    magnitudes, bolsters, bolster = pivots
    size = len(magnitudes)
    stride = size + -size % _LANES
    square = room[: size * stride].reshape((size, stride))
    columns = room[size * stride : (size + 4) * stride].reshape((4, stride))
    columns[:] = 0.0
    _fill_square(panel, square)
    left = np.ones(size, np.bool_)
    n_left, n_negative = size, 0
    while n_left > 0:
        for i in range(size):
            columns[2, i] = square[i, i]
        k = _largest(columns[2], left)
        left[k] = False
        pair = _largest(square[k], left)
        beside = abs(square[k, pair]) if left[pair] else 0.0
        if not max(abs(square[k, k]), beside) > _TINY * magnitudes[k]:
            if bolster == 0:
                return -1
            square[k, k] += bolster
            panel[k * size + k] += bolster
            bolsters[k] += bolster
        if abs(square[k, k]) >= _DOMINANCE * beside:
            n_negative += square[k, k] < 0
            n_left -= 1
            _sweep(square, k, columns)
        else:
            left[pair] = False
            n_negative += 1
            n_left -= 2
            _sweep_pair(square, k, pair, columns)
    for i in range(size):
        for j in range(size):
            factor[i * size + j] = -square[i, j]
    return n_negative


@compiled
def _fill_square(panel: Floats, square: Floats) -> None:
    """Set a square to the top of a panel, given by its lower triangle, and the rest to 0."""
    size = len(square)
    square[:] = 0.0
    for i in range(size):
        for j in range(i + 1):
            square[i, j] = square[j, i] = panel[i * size + j]


@compiled
def _largest(numbers: Floats, candidates: Truths) -> int:
    """Index of the candidate of largest magnitude; 0 where there is none."""
    found, largest = 0, -1.0
    for i in range(len(candidates)):
        if candidates[i] and abs(numbers[i]) > largest:
            found, largest = i, abs(numbers[i])
    return found


@compiled
def _sweep(square: Floats, k: int, columns: Floats) -> None:
    """Exchange variable k of a symmetric system with its right-hand side."""
    size, stride = square.shape
    inverse = 1 / square[k, k]
    for j in range(stride):
        columns[0, j] = square[k, j]
    entries, column = square.reshape(-1), columns[0]
    for i in range(size):
        factor = eight(-column[i] * inverse)
        for j in range(0, stride, _LANES):
            place = i * stride + j
            swept = added_product(load(factor, entries, place), factor, load(factor, column, j))
            store(swept, entries, place)
    for i in range(size):
        square[i, k] = square[k, i] = column[i] * inverse
    square[k, k] = -inverse


@compiled
def _sweep_pair(square: Floats, k: int, pair: int, columns: Floats) -> None:
    """Exchange two variables of a symmetric system with their right-hand sides."""
    size, stride = square.shape
    determinant = square[k, k] * square[pair, pair] - square[k, pair] ** 2
    a, c = square[pair, pair] / determinant, square[k, k] / determinant
    b = -square[k, pair] / determinant
    for j in range(stride):
        columns[0, j] = square[k, j]
        columns[1, j] = square[pair, j]
        columns[2, j] = columns[0, j] * a + columns[1, j] * b
        columns[3, j] = columns[0, j] * b + columns[1, j] * c
    entries = square.reshape(-1)
    for i in range(size):
        one, other = eight(-columns[2, i]), eight(-columns[3, i])
        for j in range(0, stride, _LANES):
            place = i * stride + j
            swept = added_product(load(one, entries, place), one, load(one, columns[0], j))
            store(added_product(swept, other, load(one, columns[1], j)), entries, place)
    for i in range(size):
        square[i, k] = square[k, i] = columns[2, i]
        square[i, pair] = square[pair, i] = columns[3, i]
    square[k, k], square[pair, pair] = -a, -c
    square[k, pair] = square[pair, k] = -b


@compiled
def _row_begin(row: int, n_rows: int) -> int:
    """Where a row of a stored Schur complement begins."""
    strip = row // _STRIP
    end = min((strip + 1) * _STRIP, n_rows)
    return _STRIP * _STRIP * strip * (strip + 1) // 2 + (row - strip * _STRIP) * end


@compiled
def _complement_size(n_rows: int) -> int:
    """Count the entries of a stored Schur complement."""
    return _row_begin(n_rows - 1, n_rows) + n_rows if n_rows > 0 else 0


def working_size(plan: EliminationPlan) -> int:
    """Numbers that an elimination holds besides its panels."""
    return int(_stack_size(plan)) + int(_largest_panel(plan))


@compiled
def _stack_size(plan: EliminationPlan) -> int:
    """Most entries that waiting Schur complements and the newest take at one time."""
    from_children = np.zeros(len(plan.parent) + 1, np.int64)
    height, highest = 0, 0
    for s in range(len(plan.parent)):
        own = _complement_size(plan.row_start[s + 1] - plan.row_start[s])
        highest = max(highest, height + own)
        height += own - from_children[s]
        from_children[plan.parent[s]] += own
    return highest


@compiled
def _largest_panel(plan: EliminationPlan) -> int:
    """Entries of the largest panel."""
    largest = 0
    for s in range(len(plan.parent)):
        largest = max(largest, plan.panel_start[s + 1] - plan.panel_start[s])
    return largest


@compiled
def _room(plan: EliminationPlan) -> int:
    """Numbers that the widest supernode's square takes, its rows filled up, with four rows more."""
    widest = 0
    for s in range(len(plan.parent)):
        widest = max(widest, plan.first_column[s + 1] - plan.first_column[s])
    stride = widest + -widest % _LANES
    return (widest + 4) * stride
