"""Quadrics: squared distances to planes in any dimension, about any place."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from auricle.surface.quadric import optimum, unite, vertex_quadrics, workspace

NONE = np.empty((0, 3), dtype=np.int64)
PAIR = np.array([[0, 1, 2], [1, 0, 3], [0, 2, 4], [1, 3, 5], [3, 0, 4], [2, 1, 5]])
"""Six triangles around the edge 0-1."""


def quadrics_of(places, faces=PAIR, boundary=NONE, *, boundary_weight=0.0, evenness=0.0):
    return vertex_quadrics(
        places, faces, boundary, boundary_weight=boundary_weight, evenness=evenness
    )


def around(vertex):
    """Faces at a vertex."""
    return PAIR[(vertex == PAIR).any(axis=1)]


def triangle_area(places, face):
    """Area of a triangle in any dimension."""
    a, b, c = places[face]
    sides = np.column_stack([b - a, c - a])
    return np.sqrt(np.linalg.det(sides.T @ sides)) / 2


def plane_distances(places, faces, x):
    """Area / 3 · squared distance from x to each face's plane, by least squares."""
    total = []
    for a, b, c in places[faces]:
        sides = np.column_stack([b - a, c - a])
        gram = sides.T @ sides
        foot = sides @ np.linalg.solve(gram, sides.T @ (x - a))
        total.append(np.sqrt(np.linalg.det(gram)) / 2 / 3 * ((x - a - foot) ** 2).sum())
    return np.array(total)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(3, 6))
def test_the_optimum_is_the_least_sum_of_squared_plane_distances(seed, dimension):
    rng = np.random.default_rng(seed)
    places = rng.normal(size=(6, dimension))
    places[:2] *= 0.3
    room, quadrics = workspace(dimension), quadrics_of(places, evenness=1e-9)
    cost = optimum(quadrics.places, quadrics.planes, 0, 1, room)

    def direct(x):
        return sum(plane_distances(places, around(vertex), x).sum() for vertex in (0, 1))

    assert cost == pytest.approx(direct(room[-1]), rel=1e-5, abs=1e-8)
    moved = np.linalg.norm(room[-1] - places[:2].mean(axis=0))
    length = np.linalg.norm(places[0] - places[1])
    if 1e-6 < moved < 1.9 * length and cost > 1e-6:
        for _ in range(5):
            nearby = room[-1] + 1e-3 * length * rng.normal(size=dimension)
            assert direct(nearby) > cost * (1 - 1e-6)


@pytest.mark.parametrize("dimension", [3, 4, 6])
def test_uniting_moves_quadrics_without_changing_them(dimension, rng):
    places = rng.normal(size=(6, dimension))
    quadrics, room = quadrics_of(places, evenness=1e-3), workspace(dimension)
    room[-1] = rng.normal(size=dimension)
    unite(*quadrics, 0, 1, room)
    room[-1] = rng.normal(size=dimension)
    unite(*quadrics, 0, 3, room)
    direct = sum(plane_distances(places, around(v), room[-1]).sum() for v in (0, 1, 3))
    assert np.array_equal(quadrics.places[0], room[-1])
    assert quadrics.planes[0, -1] - quadrics.points[0, -1] == pytest.approx(direct, rel=1e-9)
    areas = np.array([triangle_area(places, face) for face in PAIR])
    masses = [areas[(v == PAIR).any(axis=1)].sum() / 3 for v in (0, 1, 3)]
    spread = sum(
        mass * ((places[v] - room[-1]) ** 2).sum()
        for mass, v in zip(masses, (0, 1, 3), strict=True)
    )
    assert quadrics.points[0, -1] == pytest.approx(1e-3 * spread, rel=1e-9)


def test_growth_adds_up_to_the_error(rng):
    quadrics, room, total = quadrics_of(rng.normal(size=(6, 4)), evenness=1e-3), workspace(4), 0.0
    for gone in (1, 2, 5):
        room[-1] = rng.normal(size=4)
        total += unite(*quadrics, 0, gone, room)
    assert total == pytest.approx(quadrics.planes[0, -1] - quadrics.points[0, -1], rel=1e-9)


def test_far_from_the_origin_no_digit_is_lost(rng):
    places = np.round(rng.normal(size=(6, 3)), 6)
    near, far = workspace(3), workspace(3)
    here, there = quadrics_of(places, evenness=1e-7), quadrics_of(places + 4096.0, evenness=1e-7)
    one = optimum(here.places, here.planes, 0, 1, near)
    assert optimum(there.places, there.planes, 0, 1, far) == pytest.approx(one, rel=1e-6)
    assert np.allclose(far[-1] - 4096.0, near[-1], atol=1e-6)


def test_a_feature_that_never_changes_changes_nothing(rng):
    """The way written out for three dimensions agrees with the one for any."""
    places = rng.normal(size=(6, 3))
    more = np.column_stack([places, np.full(6, 5.0)])
    one, other = quadrics_of(places, evenness=1e-6), quadrics_of(more, evenness=1e-6)
    plain, featured = workspace(3), workspace(4)
    cost = optimum(one.places, one.planes, 0, 1, plain)
    assert optimum(other.places, other.planes, 0, 1, featured) == pytest.approx(cost, rel=1e-9)
    assert np.allclose(featured[-1], [*plain[-1], 5.0])


def test_on_a_flat_part_the_middle_of_all_points_is_best():
    places = np.array([[0, 0, 0], [2, 0, 0], [1, 2, 0], [1, -2, 0], [-1, 0, 0], [3, 0, 0]], float)
    room, quadrics = workspace(3), quadrics_of(places, evenness=1e-6)
    assert optimum(quadrics.places, quadrics.planes, 0, 1, room) < 1e-4
    assert np.allclose(room[-1], [1.0, 0.0, 0.0])


def test_where_nothing_is_best_an_end_or_the_middle_is():
    places = np.zeros((6, 3))
    places[:, 0] = [0, 1, 2, 3, 4, 5]
    room, quadrics = workspace(3), quadrics_of(places)
    assert optimum(quadrics.places, quadrics.planes, 0, 1, room) == 0.0
    assert np.allclose(room[-1], [0.5, 0.0, 0.0])


def test_a_boundary_edge_holds_its_ends_back_along_the_face():
    places = np.array([[0, 0, 0], [3, 0, 0], [1, 2, 0]], float)
    face = np.array([[0, 1, 2]])
    quadrics, room = quadrics_of(places, face, face, boundary_weight=2.0), workspace(3)
    room[-1] = [0.5, -0.1, 0.0]
    held = 2 * 2.0 * 3.0**2 * 0.1**2  # both ends, weight, squared length, squared distance
    assert unite(*quadrics, 0, 1, room) == pytest.approx(held, rel=1e-12)
