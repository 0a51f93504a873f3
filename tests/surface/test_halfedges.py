"""Half-edges: built right, kept right, and what is no manifold refused."""

from itertools import pairwise

import numpy as np
import pytest

from auricle.errors import SurfaceError
from auricle.surface.halfedges import (
    EDGE,
    NONE,
    OPPOSITE,
    ORIGIN,
    SIDE,
    START,
    boundary_corners,
    following,
    half_edges,
    merge,
    neighbours,
    remaining_faces,
)
from auricle.surface.shapes import cube, icosphere, joined, rectangle, torus
from auricle.surface.topology import boundary_loops, unique_edges

SHAPES = [
    cube(side=2.0, n=3),
    rectangle(width=1, height=1, n_x=4, n_y=5),
    torus(major=3, minor=1, n_major=7, n_minor=5),
]


def assert_consistent(links):
    """What must hold of every half-edge, edge and vertex that is still there."""
    origin, opposite, edge = links.half_edges.T
    there = np.flatnonzero(origin != NONE)
    tip = origin[[following(int(h)) for h in there]]
    inside = there[opposite[there] != NONE]
    assert np.array_equal(opposite[opposite[inside]], inside)
    assert np.array_equal(edge[opposite[inside]], edge[inside])
    ends = {int(h): (int(origin[h]), int(t)) for h, t in zip(there, tip, strict=True)}
    assert all(ends[h] == ends[int(opposite[h])][::-1] for h in inside.tolist())
    left = np.unique(edge[there])
    sides = links.edges[:, SIDE]
    assert np.array_equal(np.flatnonzero(sides != NONE), left)
    assert np.array_equal(edge[sides[left]], left)
    ring = np.empty(200, dtype=np.int32)
    for vertex in np.unique(origin[there]).tolist():
        start = links.vertices[vertex, START]
        assert origin[start] == vertex
        assert neighbours(links.half_edges, start, ring) == (origin[there] == vertex).sum()


@pytest.mark.parametrize("mesh", SHAPES)
def test_every_side_finds_its_other(mesh):
    links = half_edges(mesh.faces, mesh.n_vertices)
    assert_consistent(links)
    assert len(links.edges) == len(unique_edges(mesh.faces)[0])
    assert np.array_equal(remaining_faces(links), mesh.faces)


@pytest.mark.parametrize("mesh", SHAPES)
def test_neighbours_come_around_counter_clockwise(mesh):
    links = half_edges(mesh.faces, mesh.n_vertices)
    faces = {tuple(np.roll(face, turn)) for face in mesh.faces.tolist() for turn in range(3)}
    ring = np.empty(50, dtype=np.int32)
    for vertex in range(mesh.n_vertices):
        n_faces = neighbours(links.half_edges, links.vertices[vertex, START], ring)
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
    for half_edge in rng.permutation(3 * mesh.n_faces):
        table = links.half_edges
        if table[half_edge, ORIGIN] == NONE:
            continue
        one, other = table[half_edge, ORIGIN], table[following(int(half_edge)), ORIGIN]
        faces = remaining_faces(links)
        edges, counts = unique_edges(faces)
        around = [set(edges[(edges == v).any(axis=1)].ravel()) - {one, other} for v in (one, other)]
        border = set(edges[counts == 1].ravel())
        is_inside = table[half_edge, OPPOSITE] != NONE
        if len(around[0] & around[1]) != 1 + is_inside or len(faces) < 8:
            continue
        if is_inside and {one, other} <= border:
            continue
        merge(links.half_edges, links.edges, links.vertices, int(half_edge))
        assert_consistent(links)
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


def test_edges_are_numbered_through():
    links = half_edges(SHAPES[0].faces, SHAPES[0].n_vertices)
    assert np.array_equal(np.unique(links.half_edges[:, EDGE]), np.arange(len(links.edges)))
