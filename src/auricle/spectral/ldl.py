"""Block LDLᵀ factors of a sparse symmetric indefinite matrix, by multifrontal elimination."""

import numpy as np

from auricle.arrays import Floats
from auricle.compiled import compiled, compiled_inline
from auricle.spectral.elimination import EliminationPlan
from auricle.spectral.factor_streams import (
    FactorStreams,
    down_size,
    pack,
    stream_sizes,
    up_size,
)
from auricle.spectral.lanes import added_product, eight, load, store
from auricle.spectral.schur_complements import (
    add_to_complement,
    complement_size,
    multiply,
    subtract_from_columns,
)
from auricle.spectral.tile_sums import TILE

_DOMINANCE = 0.3
"""A diagonal entry this large against the rest of its column is a pivot, else half of a pair."""
_TINY = 1e-11
"""Of the magnitude of the matrix's column: a pivot no larger than this is none."""
_BOLSTER, _MOST_BOLSTERS = 8.0, 16
"""Of the largest entry under a diagonal block: what is added to its diagonal; and how many times
that is done for one supernode."""
_LANES = 8
_LARGEST_PRODUCT = 64**3
"""Multiplications in one matrix product.

OpenBLAS shares larger ones out among threads, which on a busy machine is thirty times slower, and
makes the last digits depend on the number of threads.
"""


def eliminate(
    plan: EliminationPlan,
    data: Floats,
    shift: float,
    magnitudes: Floats,
    streams: FactorStreams,
    *,
    growth: float,
) -> tuple[int, Floats] | None:
    """Factor (matrix − shift·I + bolsters) and count how many of its eigenvalues are negative.

    Of each supernode the factors are the inverse of its diagonal block and, below that, L. Pivots
    are sought within the diagonal block, one or two at a time, and never outside of it. Where the
    block is so near to singular that L would be large, and solves wrong, the row that is to blame
    is bolstered: its diagonal entry is enlarged beyond the size of what is under it.

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
    streams
        Filled with the factors.
    growth
        Largest entry that L may have.

    Returns
    -------
    tuple or None
        The count, and what was added to the diagonal, shape (n,), in order of elimination; None
        where a last pivot, with nothing under it, is none: the matrix is singular to rounding.
    """
    stack = np.empty(_stack_size(plan))
    bolsters = np.zeros(len(magnitudes))
    n_negative = _eliminate(plan, (data, shift, magnitudes, growth), stack, streams, bolsters)
    return None if n_negative < 0 else (int(n_negative), bolsters)


@compiled
def _eliminate(
    plan: EliminationPlan,
    values: tuple[Floats, float, Floats, float],
    stack: Floats,
    streams: FactorStreams,
    bolsters: Floats,
) -> int:
    """Fill `streams` and `bolsters`; returns the number of negative eigenvalues, -1 for None."""
    data, shift, magnitudes, growth = values
    widest = int(np.diff(plan.first_column).max())
    fronts = np.zeros((2, _largest_panel(plan) + TILE * widest))
    room = np.empty(_room(plan))
    waiting = np.empty(len(plan.parent) + 1, np.int64)
    begins = np.zeros(len(plan.parent) + 2, np.int64)
    n_waiting, n_negative, down, up = 0, 0, 0, len(streams.up)
    for s in range(len(plan.parent)):
        first, end = plan.first_column[s], plan.first_column[s + 1]
        size = plan.panel_start[s + 1] - plan.panel_start[s]
        panel, factor = fronts[0, :size], fronts[1, :size]
        _assemble(plan, s, data, shift, panel)
        oldest = n_waiting
        while oldest > 0 and plan.parent[waiting[oldest - 1]] == s:
            oldest -= 1
            subtract_from_columns(plan, waiting[oldest], stack[begins[oldest] :], panel)
        pivots = (magnitudes[first:end], bolsters[first:end])
        n_here = _factor_panel(panel, pivots, growth, room, factor)
        if n_here < 0:
            return -1
        n_negative += n_here
        shape = (end - first, plan.row_start[s + 1] - plan.row_start[s])
        up -= up_size(*shape)
        filled = fronts[1, : size + TILE * (end - first)].reshape((-1, end - first))
        pack(filled, end - first + shape[1], streams, (down, up))
        complement = stack[begins[n_waiting] :]
        under = panel[(end - first) ** 2 :].reshape((-1, end - first))
        multiply(streams.down, down, under, complement, room)
        down += down_size(*shape)
        for child in range(oldest, n_waiting):
            add_to_complement(plan, waiting[child], stack[begins[child] :], complement)
        size = complement_size(shape[1])
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
    for attempt in range(_MOST_BOLSTERS + 1):
        n_negative = _invert(panel, (pivots[0], pivots[1], under), room, factor)
        if n_negative < 0:
            break
        _multiply_rows(under, inverse, multipliers)
        if attempt == _MOST_BOLSTERS or not _exceeds(factor[width * width :], growth):
            break
        # A vector that the square nearly takes to zero is largest there.
        _, k = _largest_entry(multipliers)
        bolster = _BOLSTER * _largest_entry(under)[0]
        added = bolster if inverse[k, k] > 0 else -bolster
        panel[k * width + k] += added
        pivots[1][k] += added
    return n_negative


@compiled
def _exceeds(numbers: Floats, limit: float) -> bool:
    """Whether any magnitude is larger; all are looked at, which takes whole registers."""
    count = 0
    for number in numbers:
        count += abs(number) > limit
    return count > 0


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
    panel: Floats, pivots: tuple[Floats, Floats, Floats], room: Floats, factor: Floats
) -> int:
    """Invert the square on top of a panel, given by its lower triangle, into that of `factor`.

    By symmetric sweeps on the next diagonal entry that no other in its row exceeds. Where it does
    not stand out like that the largest diagonal entry left is taken, or, where that is small beside
    an entry next to it, the two together. A pivot that is none is bolstered: `pivots` are
    magnitudes and bolsters of the columns, and what is under them. Returns the number of negative
    pivots, which is that of negative eigenvalues; -1 if one is none and nothing is under them.
    Rows are worked on in `room`, filled up to whole registers.
    """
    magnitudes, bolsters, under = pivots
    size = len(magnitudes)
    stride = size + -size % _LANES
    square = room[: size * stride].reshape((size, stride))
    columns = room[size * stride : (size + 5) * stride].reshape((5, stride))
    columns[:] = 0.0
    _fill_square(panel, square)
    left = columns[4]
    left[:size] = 1.0
    n_left, n_negative = size, 0
    while n_left > 0:
        k, pair = _next_pivot(square, magnitudes, left, columns[2])
        beside = abs(square[k, pair]) if k != pair else 0.0
        if not max(abs(square[k, k]), beside) > _TINY * magnitudes[k]:
            bolster = _BOLSTER * _largest_entry(under)[0]
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
            left[pair] = 0.0
            n_negative += 1
            n_left -= 2
            _sweep_pair(square, k, pair, columns)
    for i in range(size):
        for j in range(size):
            factor[i * size + j] = -square[i, j]
    return n_negative


@compiled_inline
def _next_pivot(
    square: Floats, magnitudes: Floats, left: Floats, diagonal: Floats
) -> tuple[int, int]:
    """The row to pivot on, taken off those left, which are 1; and its largest neighbour among them.

    The first that no neighbour exceeds, named twice, or else the one of largest diagonal entry.
    `diagonal` is room for these.
    """
    first = 0
    while left[first] == 0.0:
        first += 1
    size = abs(square[first, first])
    left[first] = 0.0
    if size > _TINY * magnitudes[first] and not _any_exceeds(square[first], left, size):
        return first, first
    left[first] = 1.0
    for i in range(len(square)):
        diagonal[i] = square[i, i]
    k = _largest(diagonal, left, first)
    left[k] = 0.0
    return k, _largest(square[k], left, k)


@compiled
def _fill_square(panel: Floats, square: Floats) -> None:
    """Set a square to the top of a panel, given by its lower triangle, and the rest to 0."""
    size = len(square)
    square[:] = 0.0
    for i in range(size):
        for j in range(i + 1):
            square[i, j] = square[j, i] = panel[i * size + j]


@compiled_inline
def _any_exceeds(numbers: Floats, candidates: Floats, limit: float) -> bool:
    """Whether the magnitude of any candidate is larger; candidates are 1, others 0."""
    count = 0
    for i in range(len(candidates)):
        count += abs(numbers[i] * candidates[i]) > limit
    return count > 0


@compiled_inline
def _largest(numbers: Floats, candidates: Floats, found: int) -> int:
    """Index of the candidate of largest magnitude; `found` where there is none."""
    largest = -1.0
    for i in range(len(candidates)):
        if candidates[i] > 0 and abs(numbers[i]) > largest:
            found, largest = i, abs(numbers[i])
    return found


@compiled_inline
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


def working_size(plan: EliminationPlan) -> int:
    """Numbers that an elimination holds, its result among them."""
    return sum(stream_sizes(plan)) + int(_stack_size(plan)) + 2 * int(_largest_panel(plan))


@compiled
def _stack_size(plan: EliminationPlan) -> int:
    """Most entries that waiting Schur complements and the newest take at one time."""
    from_children = np.zeros(len(plan.parent) + 1, np.int64)
    height, highest = 0, 0
    for s in range(len(plan.parent)):
        own = complement_size(plan.row_start[s + 1] - plan.row_start[s])
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
    """Numbers that the widest supernode's square takes, its rows filled up, with five rows more."""
    widest = 0
    for s in range(len(plan.parent)):
        widest = max(widest, plan.first_column[s + 1] - plan.first_column[s])
    stride = widest + -widest % _LANES
    return (widest + 5) * stride
