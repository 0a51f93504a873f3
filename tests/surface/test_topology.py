"""Edges, pieces, holes, orientation and genus against what topology says they are."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from auricle.errors import SurfaceError
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import cube, icosphere, joined, rectangle, torus
from auricle.surface.topology import (
    boundary_loops,
    corner_fans,
    edge_table,
    euler_number,
    face_flips,
    genus,
    hole_count,
    is_oriented,
    pieces,
    unique_edges,
)

SPHERE = icosphere(radius=10.0, subdivisions=2)
RING = torus(major=20.0, minor=6.0, n_major=18, n_minor=10)
PLATE = rectangle(width=7.0, height=5.0, n_x=8, n_y=6)
MOEBIUS = np.array([[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5], [4, 5, 1], [1, 5, 0]])
HOURGLASS = np.array([[0, 1, 2], [0, 3, 4]])
SEEDS = st.integers(0, 2**32 - 1)


def without_stars(mesh, vertices):
    """The mesh without the faces around some vertices, which leaves a hole at each."""
    faces = mesh.faces[~np.isin(mesh.faces, vertices).any(axis=1)]
    kept, renumbered = np.unique(faces, return_inverse=True)
    return Mesh(mesh.vertices[kept], renumbered.reshape(-1, 3))


def with_two_holes_at_a_vertex(mesh):
    """Faces of the mesh but two of those at vertex 0, which only touch there."""
    at_vertex = np.flatnonzero((mesh.faces == 0).any(axis=1))
    first = mesh.faces[at_vertex[0]]
    shared = np.isin(mesh.faces[at_vertex], first).sum(axis=1)
    return np.delete(mesh.faces, [at_vertex[0], at_vertex[np.flatnonzero(shared == 1)[0]]], axis=0)


@pytest.mark.parametrize(
    ("mesh", "number"), [(SPHERE, 2), (RING, 0), (PLATE, 1), (joined([SPHERE, RING, PLATE]), 3)]
)
def test_the_euler_number_is_that_of_the_shape(mesh, number):
    assert euler_number(mesh.faces) == number


def test_the_euler_number_does_not_count_vertices_without_faces():
    assert euler_number(SPHERE.faces + 5) == 2


@pytest.mark.parametrize("mesh", [SPHERE, RING, cube(side=1.0, n=3)])
def test_every_edge_of_a_closed_surface_has_two_faces(mesh):
    edges, faces_per_edge = unique_edges(mesh.faces)
    assert (faces_per_edge == 2).all()
    assert 2 * len(edges) == 3 * mesh.n_faces
    assert len(np.unique(edges, axis=0)) == len(edges)
    assert (edges[:, 0] < edges[:, 1]).all()


def test_the_two_sides_of_a_pair_lie_on_one_edge():
    table = edge_table(PLATE.faces)
    one, other = table.side_pairs.T
    np.testing.assert_array_equal(table.edge_of_side[one], table.edge_of_side[other])
    np.testing.assert_array_equal(table.sides[one], table.sides[other][:, ::-1])
    assert 2 * len(table.side_pairs) + len(table.boundary_sides) == PLATE.faces.size


@pytest.mark.parametrize(("n_holes", "handles"), [(0, 0), (1, 0), (3, 0), (0, 1), (2, 1)])
def test_holes_and_handles_are_told_apart(n_holes, handles):
    mesh = without_stars(RING if handles else SPHERE, [0, 50, 100][:n_holes])
    assert hole_count(mesh.faces) == len(boundary_loops(mesh)) == n_holes
    assert genus(mesh.faces) == handles


def test_handles_add_up_over_pieces():
    assert genus(joined([RING, SPHERE, PLATE, RING]).faces) == 2


@settings(max_examples=20, deadline=None)
@given(SEEDS)
def test_loops_run_as_their_faces_do_however_the_surface_is_numbered(seed):
    rng = np.random.default_rng(seed)
    mesh = without_stars(SPHERE, [3, 77])
    name, order = rng.permutation(mesh.n_vertices), rng.permutation(mesh.n_faces)
    shuffled = Mesh(mesh.vertices[np.argsort(name)], name[mesh.faces][order])
    loops = boundary_loops(shuffled)
    assert sorted(map(len, loops)) == sorted(map(len, boundary_loops(mesh)))
    steps = np.concatenate([np.column_stack([loop, np.roll(loop, -1)]) for loop in loops])
    expected = edge_table(shuffled.faces).boundary_sides
    assert sorted(steps.tolist()) == sorted(expected.tolist())


def test_a_loop_around_a_plate_has_the_plate_on_its_left():
    (loop,) = boundary_loops(PLATE)
    x, y, _ = PLATE.vertices[loop].T
    enclosed = 0.5 * (x * np.roll(y, -1) - y * np.roll(x, -1)).sum()
    assert enclosed == pytest.approx(35.0, rel=1e-12)


def test_holes_that_meet_in_a_vertex_are_refused():
    pinched = Mesh(RING.vertices, with_two_holes_at_a_vertex(RING))
    with pytest.raises(SurfaceError, match="1 vertices lie on a hole's edge twice"):
        boundary_loops(pinched)


def test_a_hole_between_disagreeing_faces_is_refused():
    bent = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 3, 2]])
    with pytest.raises(SurfaceError, match="do not run the same way"):
        boundary_loops(bent)


def test_pieces_are_numbered_by_their_first_face():
    order = np.random.default_rng(5).permutation(SPHERE.n_faces + PLATE.n_faces)
    labels = pieces(joined([SPHERE, PLATE]).faces[order])
    expected = (order >= SPHERE.n_faces) ^ (order[0] >= SPHERE.n_faces)
    np.testing.assert_array_equal(labels, expected)


def test_a_shared_vertex_does_not_make_one_piece():
    assert pieces(HOURGLASS).tolist() == [0, 1]


def test_on_a_manifold_every_vertex_has_one_fan():
    for mesh in (SPHERE, RING, PLATE):
        fans = corner_fans(mesh.faces)
        pairs = np.unique(np.column_stack([fans.ravel(), mesh.faces.ravel()]), axis=0)
        assert len(pairs) == fans.max() + 1 == mesh.n_vertices


def test_two_spheres_glued_at_a_vertex_have_one_fan_too_many():
    faces = joined([SPHERE, SPHERE]).faces
    glued = np.where(faces == SPHERE.n_vertices, 0, faces)
    assert corner_fans(glued).max() + 1 == len(np.unique(glued)) + 1


@settings(max_examples=20, deadline=None)
@given(SEEDS, st.floats(0.0, 1.0))
def test_turned_faces_are_found_and_the_fewer_are_turned_back(seed, share):
    turned = np.random.default_rng(seed).random(SPHERE.n_faces) < share
    faces = np.where(turned[:, None], SPHERE.faces[:, ::-1], SPHERE.faces)
    flips = face_flips(faces)
    assert flips.sum() == min(turned.sum(), (~turned).sum())
    assert is_oriented(np.where(flips[:, None], faces[:, ::-1], faces))
    assert is_oriented(faces) == (turned.all() or not turned.any())


def test_each_piece_is_turned_by_itself():
    faces = joined([SPHERE, RING]).faces.copy()
    faces[3] = faces[3, ::-1]
    faces[-1] = faces[-1, ::-1]
    assert np.flatnonzero(face_flips(faces)).tolist() == [3, len(faces) - 1]


def test_a_moebius_strip_cannot_be_oriented():
    with pytest.raises(SurfaceError, match="one-sided"):
        face_flips(MOEBIUS)
