"""Factors in two streams: every number once a direction, tile by tile."""

import numpy as np
import pytest
from scipy import sparse

from auricle.errors import SolverError
from auricle.spectral.factor_streams import (
    FactorStreams,
    Rooms,
    down_size,
    empty_streams,
    pack,
    stream_sizes,
    up_size,
)
from auricle.spectral.factorization import analyze, factorize
from auricle.spectral.tile_sums import TILE


def tiles_of(stream, n_lines: int, count: int):
    """Lines that lie in tiles, shape (n_lines, count)."""
    lines, place = [], 0
    while len(lines) < n_lines:
        lanes = 8 if n_lines - len(lines) > 4 else 4
        lines.extend(stream[place : place + count * lanes].reshape(count, lanes).T)
        place += count * lanes
    assert place == len(stream)
    return np.array(lines[:n_lines]).reshape(n_lines, count)


@pytest.mark.parametrize("n_columns", [1, 4, 7, 8, 19])
@pytest.mark.parametrize("n_rows", [0, 1, 4, 6, 8, 26])
def test_a_panel_is_found_again_row_by_row_and_column_by_column(rng, n_rows, n_columns) -> None:
    height = n_columns + n_rows
    factor = rng.standard_normal((height + TILE, n_columns))
    down, up = (
        np.full(down_size(n_columns, n_rows) + 5, np.pi),
        np.full(up_size(n_columns, n_rows) + 5, np.pi),
    )
    pack(factor, height, FactorStreams(down, up), (2, 3))
    np.testing.assert_array_equal(tiles_of(down[2:-3], n_rows, n_columns), factor[n_columns:height])
    np.testing.assert_array_equal(tiles_of(up[3:-2], n_columns, height), factor[:height].T)
    for beyond in (down[:2], down[-3:], up[:3], up[-2:]):
        assert (beyond == np.pi).all()


def test_streams_have_room_for_a_plans_panels_and_begin_with_a_line_of_the_cache(rng) -> None:
    matrix = sparse.random_array((200, 200), density=0.02, rng=rng)
    plan = analyze(sparse.csc_array(matrix + matrix.T)).plan
    widths, heights = np.diff(plan.first_column), np.diff(plan.row_start)
    shapes = [(int(width), int(height)) for width, height in zip(widths, heights, strict=True)]
    sizes = sum(down_size(*shape) for shape in shapes), sum(up_size(*shape) for shape in shapes)
    assert stream_sizes(plan) == sizes
    streams = empty_streams(plan)
    assert (len(streams.down), len(streams.up)) == sizes
    assert streams.down.ctypes.data % 64 == streams.up.ctypes.data % 64 == 0
    assert streams.n_bytes == 8 * sum(sizes)


def test_factors_that_are_let_go_leave_their_room_to_the_next(rng) -> None:
    matrix = sparse.csc_array(sparse.diags_array(np.arange(1.0, 41.0)))
    rooms = Rooms()
    first = factorize(matrix, 0.5, rooms=rooms)
    place, right = first._room.streams.up.ctypes.data, rng.standard_normal(40)
    second = factorize(matrix, 7.5, rooms=rooms)
    kept = second.solve(right)
    assert second._room.streams.up.ctypes.data != place
    del first
    third = factorize(matrix, 9.5, rooms=rooms)
    assert third._room.streams.up.ctypes.data == place
    assert (second.n_below, third.n_below) == (7, 9)
    np.testing.assert_array_equal(second.solve(right), kept)
    np.testing.assert_allclose(third.solve(right), right / (np.arange(1.0, 41.0) - 9.5))


def test_factors_let_go_keep_their_count_and_solve_no_more(rng) -> None:
    matrix = sparse.csc_array(sparse.diags_array(np.arange(1.0, 41.0)))
    rooms = Rooms()
    factors = factorize(matrix, 0.5, rooms=rooms)
    place = factors._room.streams.up.ctypes.data
    factors.let_go()
    assert (factors.shift, factors.n_below) == (0.5, 0)
    assert factorize(matrix, 7.5, rooms=rooms)._room.streams.up.ctypes.data == place
    with pytest.raises(SolverError, match="let go"):
        factors.solve(rng.standard_normal(40))


def test_room_of_another_plan_is_not_used() -> None:
    rooms = Rooms()
    small, large = (sparse.csc_array(sparse.diags_array(np.arange(1.0, n))) for n in (9.0, 99.0))
    factorize(small, 0.5, rooms=rooms)
    factors = factorize(large, 7.5, rooms=rooms)
    assert factors.n_below == 7
    assert len(rooms._free) == 1


def test_a_shift_that_cannot_be_factored_gives_its_room_back() -> None:
    rooms = Rooms()
    with pytest.raises(SolverError):
        factorize(sparse.csc_array((3, 3)), 0.0, rooms=rooms)
    assert len(rooms._free) == 1
