"""Factors laid out in the order in which a solve reads them: two long streams, once a direction.

On the way down the supernodes a solve needs what is under their columns, row by row; on the way
back the same numbers, and the inverse of the square on top, column by column. Either way it wants
eight lines side by side, which fill a register or a line of the cache. What is under the columns
is therefore stored twice. What is read from end to end can be asked for a fixed way ahead.
"""

from dataclasses import dataclass
from typing import NamedTuple
from weakref import finalize

from auricle.arrays import Floats
from auricle.compiled import compiled, compiled_inline
from auricle.spectral.elimination import EliminationPlan
from auricle.spectral.lanes import Lanes, aligned, eight, four, load, store, width
from auricle.spectral.side_by_side import set_side_by_side
from auricle.spectral.tile_sums import TILE, tile_width


class FactorStreams(NamedTuple):
    """Block LDLᵀ factors, as `auricle.spectral.substitution` reads them.

    Attributes
    ----------
    down
        Supernode by supernode, L under its columns: tiles of eight rows, of each tile one column
        after another.
    up
        From the last supernode to the first, the inverse of its square and L under that: tiles of
        eight columns, of each tile one row after another.
    """

    down: Floats
    up: Floats

    @property
    def n_bytes(self) -> int:
        """Memory of both."""
        return self.down.nbytes + self.up.nbytes


@dataclass(frozen=True, eq=False)
class Room:
    """Streams that are used again when no one holds this any more."""

    streams: FactorStreams


class Rooms:
    """Rooms for factors, used again by the next of their plan when the last are let go.

    A system sets new pages to zero, and a virtual machine may have to ask its host for them.
    """

    def __init__(self) -> None:
        self._free: list[FactorStreams] = []

    def take(self, plan: EliminationPlan) -> Room:
        """Room that is free, of whatever content, or else new."""
        sizes = stream_sizes(plan)
        for i, streams in enumerate(self._free):
            if (streams.down.size, streams.up.size) == sizes:
                return self._lent(self._free.pop(i))
        return self._lent(empty_streams(plan))

    def _lent(self, streams: FactorStreams) -> Room:
        room = Room(streams)
        finalize(room, self._free.append, streams)
        return room


def empty_streams(plan: EliminationPlan) -> FactorStreams:
    """Room for the factors of a plan."""
    n_down, n_up = stream_sizes(plan)
    return FactorStreams(aligned(n_down), aligned(n_up))


@compiled
def stream_sizes(plan: EliminationPlan) -> tuple[int, int]:
    """Numbers in both streams."""
    down, up = 0, 0
    for s in range(len(plan.parent)):
        n_columns = plan.first_column[s + 1] - plan.first_column[s]
        n_rows = plan.row_start[s + 1] - plan.row_start[s]
        down += down_size(n_columns, n_rows)
        up += up_size(n_columns, n_rows)
    return down, up


@compiled_inline
def down_size(width: int, height: int) -> int:
    """Numbers that a supernode of so many columns and rows under them takes on the way down."""
    return (height + -height % 4) * width


@compiled_inline
def up_size(width: int, height: int) -> int:
    """Numbers that it takes on the way back."""
    return (width + -width % 4) * (width + height)


@compiled
def pack(factor: Floats, n_rows: int, streams: FactorStreams, places: tuple[int, int]) -> None:
    """Put a supernode's panel, the inverse of its square and L under that, into both streams.

    The panel has `n_rows` rows, and `TILE` more follow it of whatever content: they fill up tiles,
    and what comes of them is left.
    """
    n_columns = factor.shape[1]
    numbers = factor.reshape(-1)
    down, up = places
    for first in range(n_columns, n_rows, TILE):
        lanes = tile_width(n_rows - first)
        tile = streams.down[down : down + n_columns * lanes]
        set_side_by_side(factor[first : first + lanes], tile, lanes)
        down += n_columns * lanes
    for first in range(0, n_columns, TILE):
        if tile_width(n_columns - first) == TILE:
            _copy_tile(numbers, (first, n_columns, n_rows), streams.up, up, eight(0.0))
            up += n_rows * TILE
        else:
            _copy_tile(numbers, (first, n_columns, n_rows), streams.up, up, four(0.0))


@compiled
def _copy_tile(
    numbers: Floats, size: tuple[int, int, int], up: Floats, place: int, zero: Lanes
) -> None:
    source, n_columns, n_rows = size
    for _ in range(n_rows):
        store(load(zero, numbers, source), up, place)
        source, place = source + n_columns, place + width(zero)
