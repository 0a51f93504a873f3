"""Half-edges: built right, kept right, and what is no manifold refused."""

from itertools import pairwise

import numpy as np
import pytest

from auricle.errors import SurfaceError
from auricle.surface.halfedges import (
    AFTER,
    BEFORE,
    NONE,
    ORIGIN,
    boundary_corners,
    flip,
    half_edges,
    merge,
    neighbours,
)
from auricle.surface.shapes import cube, icosphere, joined, rectangle, torus
from auricle.surface.topology import boundary_loops, unique_edges

SHAPES = [
    cube(side=2.0, n=3),
    rectangle(width=1, height=1, n_x=4, n_y=5),
    torus(major=3, minor=1, n_major=7, n_minor=5),
]


def faces_of(links):
    """Faces that are still there, each from its smallest vertex, sorted."""
    table = links.half_edges
    sides = np.flatnonzero((table[:, ORIGIN] != NONE) & (table[:, AFTER] != NONE))
    around = np.column_stack([sides, table[sides, AFTER], table[sides, BEFORE]])
    corners = table[around, ORIGIN]
    return np.array(sorted(corners[corners[:, 0] == corners.min(axis=1)].tolist()))


def as_sorted(faces):
    """Faces each from its smallest vertex, sorted."""
    turned = [np.roll(face, -int(np.argmin(face))).tolist() for face in faces]
    return np.array(sorted(turned))


def assert_consistent(links):
    """What must hold of every half-edge, edge and vertex that is still there."""
    origin, after, before, waits = links.half_edges.T
    there = np.flatnonzero(origin != NONE)
    assert np.array_equal(np.unique(there ^ 1), there)
    faced = there[after[there] != NONE]
    assert np.array_equal(after[after[after[faced]]], faced)
    assert np.array_equal(before[after[faced]], faced)
    assert np.array_equal(origin[after[faced]], origin[faced ^ 1])
    assert np.array_equal(there[before[there] != NONE], faced)
    assert (after[there] != NONE).sum() + (after[there ^ 1] == NONE).sum() == len(there)
    assert (waits[faced] == 0).all()
    ring = np.empty(200, dtype=np.int32)
    for vertex in np.unique(origin[there]).tolist():
        start = links.starts[vertex]
        assert origin[start] == vertex
        n_faces = (origin[faced] == vertex).sum()
        assert neighbours(links.half_edges, start, ring) == n_faces
        is_at_boundary = (after[there[origin[there] == vertex]] == NONE).any()
        assert (ring[0] != ring[n_faces]) == is_at_boundary == (after[start ^ 1] == NONE)


@pytest.mark.parametrize("mesh", SHAPES)
def test_every_side_finds_its_other(mesh):
    links = half_edges(mesh.faces, mesh.n_vertices)
    assert_consistent(links)
    assert len(links.half_edges) == 2 * len(unique_edges(mesh.faces)[0])
    assert np.array_equal(faces_of(links), as_sorted(mesh.faces))


@pytest.mark.parametrize("mesh", SHAPES)
def test_neighbours_come_around_counter_clockwise(mesh):
    links = half_edges(mesh.faces, mesh.n_vertices)
    faces = {tuple(np.roll(face, turn)) for face in mesh.faces.tolist() for turn in range(3)}
    ring = np.empty(50, dtype=np.int32)
    for vertex in range(mesh.n_vertices):
        n_faces = neighbours(links.half_edges, links.starts[vertex], ring)
        for second, third in pairwise(ring[: n_faces + 1]):
            assert (vertex, second, third) in faces


def test_the_boundary_is_listed_as_its_faces_run():
    plate = SHAPES[1]
    corners = boundary_corners(half_edges(plate.faces, plate.n_vertices))
    (loop,) = boundary_loops(plate)
    assert {tuple(c) for c in corners[:, :2]} == set(zip(loop, np.roll(loop, -1), strict=True))
    assert all(set(c) in [set(f) for f in plate.faces.tolist()] for c in corners.tolist())


@pytest.mark.parametrize("mesh", SHAPES)
def test_merging_keeps_everything_consistent(mesh, rng):
    links = half_edges(mesh.faces, mesh.n_vertices)
    n_merged = 0
    for half_edge in rng.permutation(len(links.half_edges)).tolist():
        table = links.half_edges
        if table[half_edge, ORIGIN] == NONE or table[half_edge, AFTER] == NONE:
            continue
        one, other = table[half_edge, ORIGIN], table[half_edge ^ 1, ORIGIN]
        faces = faces_of(links)
        edges, counts = unique_edges(faces)
        around = [set(edges[(edges == v).any(axis=1)].ravel()) - {one, other} for v in (one, other)]
        border = set(edges[counts == 1].ravel())
        is_inside = table[half_edge ^ 1, AFTER] != NONE
        if len(around[0] & around[1]) != 1 + is_inside or len(faces) < 8:
            continue
        if is_inside and {one, other} <= border:
            continue
        merge(links.half_edges, links.starts, half_edge)
        assert_consistent(links)
        united = np.where(faces == other, one, faces)
        whole = [face for face in united.tolist() if len(set(face)) == 3]
        assert np.array_equal(faces_of(links), as_sorted(whole))
        n_merged += 1
    assert n_merged > 5


FLAWS = {
    "an edge of three faces": [[0, 1, 2], [1, 0, 3], [0, 1, 4]],
    "neighbours that disagree": [[0, 1, 2], [0, 1, 3]],
    "sheets joined in a point": [[0, 1, 2], [0, 3, 4]],
    "a face that is there twice": [[0, 1, 2], [0, 1, 2], [2, 1, 3]],
    "a face and its back": [[0, 1, 2], [2, 1, 0]],
    "a vertex of no face": [[0, 1, 2], [2, 1, 4]],
}


@pytest.mark.parametrize("faces", FLAWS.values(), ids=FLAWS.keys())
def test_what_is_no_manifold_is_refused(faces):
    faces = np.array(faces)
    with pytest.raises(SurfaceError, match="manifold"):
        half_edges(faces, int(faces.max()) + 1)


def test_two_pieces_are_refused():
    two = joined([icosphere(radius=1, subdivisions=1)] * 2)
    with pytest.raises(SurfaceError, match="one oriented manifold"):
        half_edges(two.faces, two.n_vertices)


def test_edges_are_numbered_as_they_come_up():
    links = half_edges(np.array([[0, 1, 2], [2, 1, 3]]), 4)
    ends = [[0, 1], [1, 2], [2, 0], [1, 3], [3, 2]]
    assert links.half_edges[:, ORIGIN].reshape(-1, 2).tolist() == ends


def test_a_flipped_edge_joins_the_other_two_corners() -> None:
    """Of two triangles over a square, the other diagonal; of the rest of the surface, nothing."""
    faces = cube(side=2.0, n=3).faces
    links = half_edges(faces, int(faces.max()) + 1)
    table = links.half_edges
    a, b = table[0, ORIGIN], table[1, ORIGIN]
    c, d = table[table[0, BEFORE], ORIGIN], table[table[1, BEFORE], ORIGIN]
    flip(table, 0)
    kept = [face for face in faces.tolist() if not {a, b} <= set(face)]
    assert len(kept) == len(faces) - 2
    expected = half_edges(np.array([*kept, [c, a, d], [d, b, c]]), links.starts.size)
    assert np.array_equal(faces_of(links), faces_of(expected))
    assert [table[0, ORIGIN], table[1, ORIGIN]] == [d, c]


@pytest.mark.parametrize("mesh", SHAPES)
def test_four_flips_of_an_edge_leave_everything_as_it_was(mesh) -> None:
    links = half_edges(mesh.faces, mesh.n_vertices)
    table, before = links.half_edges, links.half_edges.copy()
    inside = np.flatnonzero(
        (table[:, AFTER] != NONE) & (table[np.arange(len(table)) ^ 1, AFTER] != NONE)
    )
    for half_edge in inside[:: max(len(inside) // 20, 1)].tolist():
        flip(table, half_edge)
        assert not np.array_equal(table, before)
        for _ in range(3):
            flip(table, half_edge)
        assert np.array_equal(table, before)
