import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from auricle.errors import InputError, SurfaceError
from auricle.surface.geodesics import (
    GeodesicDistances,
    distances_from,
    exact_geodesic_distances,
    geodesic_distances,
)
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import cube, icosphere, joined, rectangle

RADIUS = 30.0
SPHERE = icosphere(radius=RADIUS, subdivisions=4)
SMALL = icosphere(radius=10.0, subdivisions=2)
PAIRWISE = np.stack([exact_geodesic_distances(SMALL, i) for i in range(SMALL.n_vertices)])
EDGE = np.sqrt(SPHERE.area / SPHERE.n_vertices)
vertices_of_small = st.integers(0, SMALL.n_vertices - 1)


def great_circle(mesh: Mesh, source: int):
    here = mesh.vertices[source]
    across = np.linalg.norm(np.cross(mesh.vertices, here), axis=1)
    return np.linalg.norm(here) * np.arctan2(across, mesh.vertices @ here)


def test_exact_distances_on_a_sphere_are_great_circles_within_three_thousandths_of_the_radius():
    for source in (0, 77, 1500):
        error = exact_geodesic_distances(SPHERE, source) - great_circle(SPHERE, source)
        assert np.abs(error).max() < 0.003 * RADIUS


def test_exact_distances_on_a_sphere_converge_at_second_order():
    errors = [
        np.abs(exact_geodesic_distances(mesh, 0) - great_circle(mesh, 0)).max()
        for mesh in (icosphere(radius=RADIUS, subdivisions=s) for s in (2, 3, 4))
    ]
    ratios = np.divide(errors[:-1], errors[1:])
    assert (ratios > 3.5).all()
    assert (ratios < 4.5).all()


def test_heat_distances_on_a_sphere_are_great_circles_within_half_an_edge():
    distances = GeodesicDistances(SPHERE)
    for source in (0, 77, 1500):
        error = distances.from_vertices([source]) - great_circle(SPHERE, source)
        assert np.abs(error).max() < 0.5 * EDGE


def test_exact_distances_on_a_flat_sheet_are_straight_lines():
    sheet = rectangle(width=20.0, height=10.0, n_x=15, n_y=9)
    for source in (0, 40, 134):
        straight = np.linalg.norm(sheet.vertices - sheet.vertices[source], axis=1)
        np.testing.assert_allclose(exact_geodesic_distances(sheet, source), straight, atol=1e-12)


@pytest.mark.parametrize("reach", [1.5, 4.0, 9.0, 18.0])
def test_a_limited_reach_on_a_flat_sheet_of_long_triangles_finds_the_straight_lines(reach):
    sheet = rectangle(width=20.0, height=10.0, n_x=41, n_y=4)
    straight = np.linalg.norm(sheet.vertices - sheet.vertices[60], axis=1)
    found = exact_geodesic_distances(sheet, 60, reach=reach)
    clear = np.abs(straight - reach) > 1e-9
    expected = np.where(straight < reach, straight, np.inf)
    np.testing.assert_allclose(found[clear], expected[clear], atol=1e-12)


def test_exact_distances_on_a_cube_unfold_its_sides():
    box = cube(side=1.0, n=6)
    corner = int(np.flatnonzero((box.vertices == -0.5).all(axis=1))[0])
    opposite = int(np.flatnonzero((box.vertices == 0.5).all(axis=1))[0])
    distance = exact_geodesic_distances(box, corner)
    assert distance[opposite] == pytest.approx(np.sqrt(5.0), rel=1e-12)


@given(vertices_of_small, vertices_of_small, vertices_of_small)
def test_exact_distances_are_a_metric(a, b, c):
    assert PAIRWISE[a, b] == pytest.approx(PAIRWISE[b, a], abs=1e-9)
    assert PAIRWISE[a, c] <= PAIRWISE[a, b] + PAIRWISE[b, c] + 1e-9
    assert (PAIRWISE[a, b] == 0) == (a == b)


@given(vertices_of_small, vertices_of_small)
def test_no_path_is_shorter_than_the_straight_line(a, b):
    straight = np.linalg.norm(SMALL.vertices[a] - SMALL.vertices[b])
    assert PAIRWISE[a, b] >= straight - 1e-9


@given(vertices_of_small, st.floats(0.5, 40.0))
def test_a_limited_reach_changes_nothing_within_it(source, reach):
    limited = exact_geodesic_distances(SMALL, source, reach=reach)
    whole = PAIRWISE[source]
    np.testing.assert_array_equal(limited, np.where(whole <= reach, whole, np.inf))


def test_a_limited_reach_sees_no_further_wall_across_a_gap():
    """Two sheets 2 mm apart, joined at one end: across the gap is near, along the wall far."""
    sheet = rectangle(width=30.0, height=20.0, n_x=31, n_y=21)
    x, y, _ = sheet.vertices.T
    folded = np.column_stack([np.abs(x - 15.0), y, np.clip(x - 15.0, -1.0, 1.0)])
    mesh = Mesh(folded, sheet.faces)
    source, across = 10 * 31 + 0, 10 * 31 + 30
    assert np.linalg.norm(folded[source] - folded[across]) == pytest.approx(2.0)
    assert exact_geodesic_distances(mesh, source, reach=10.0)[across] == np.inf
    assert exact_geodesic_distances(mesh, source)[across] > 28.0


@pytest.mark.parametrize("measure", [exact_geodesic_distances, geodesic_distances])
def test_another_piece_is_infinitely_far(measure):
    far = Mesh(SMALL.vertices + np.array([50.0, 0.0, 0.0]), SMALL.faces)
    both = joined([SMALL, far])
    source = 3 + SMALL.n_vertices
    distance = measure(both, source if measure is exact_geodesic_distances else [source])
    assert np.isinf(distance[: SMALL.n_vertices]).all()
    np.testing.assert_allclose(distance[SMALL.n_vertices :].max(), 10 * np.pi, rtol=0.06)


def test_a_vertex_of_no_face_is_infinitely_far():
    mesh = Mesh(np.vstack([SMALL.vertices, [(0.0, 0.0, 0.0)]]), SMALL.faces)
    assert geodesic_distances(mesh, [0])[-1] == np.inf
    assert exact_geodesic_distances(mesh, 0)[-1] == np.inf
    assert np.isinf(exact_geodesic_distances(mesh, SMALL.n_vertices)[:-1]).all()


@pytest.mark.parametrize("shift", [1e4, 1e6])
def test_distances_do_not_depend_on_the_scanners_origin(shift):
    moved = Mesh(SMALL.vertices + shift, SMALL.faces)
    np.testing.assert_allclose(
        geodesic_distances(moved, [5]), geodesic_distances(SMALL, [5]), atol=1e-7
    )
    np.testing.assert_allclose(exact_geodesic_distances(moved, 5), PAIRWISE[5], atol=1e-7)


def test_distances_grow_with_the_mesh():
    scaled = Mesh(1e3 * SMALL.vertices, SMALL.faces)
    np.testing.assert_allclose(
        geodesic_distances(scaled, [5]), 1e3 * geodesic_distances(SMALL, [5]), rtol=1e-9
    )


def test_the_distance_to_several_sources_is_that_to_the_nearest():
    distances = GeodesicDistances(SPHERE)
    sources = [3, 500, 1700, 2000]
    singly = np.min([distances.from_vertices([source]) for source in sources], axis=0)
    together = distances.from_vertices(sources)
    np.testing.assert_array_equal(together, singly)
    np.testing.assert_array_equal(together[sources], 0.0)
    assert (together >= 0).all()


@pytest.mark.parametrize("sources", [[], [-1], [SMALL.n_vertices], [[0, 1]]])
def test_sources_that_are_no_vertices_are_refused(sources):
    with pytest.raises(InputError, match="source"):
        geodesic_distances(SMALL, sources)


def test_a_reach_of_nothing_is_refused():
    with pytest.raises(InputError, match="reach"):
        exact_geodesic_distances(SMALL, 0, reach=0.0)
    with pytest.raises(InputError, match="source"):
        exact_geodesic_distances(SMALL, SMALL.n_vertices)


def test_a_degenerate_triangle_is_refused_by_the_exact_search_and_left_to_the_heat_method():
    a, b, c = SMALL.faces[0]
    n = SMALL.n_vertices
    middle = (SMALL.vertices[a] + SMALL.vertices[b]) / 2
    faces = [*SMALL.faces[1:], [a, n, c], [n, b, c], [a, b, n]]
    flat = Mesh(np.vstack([SMALL.vertices, middle]), faces)
    with pytest.raises(SurfaceError, match="degenerate"):
        exact_geodesic_distances(flat, 0)
    expected = exact_geodesic_distances(SMALL, 0)
    np.testing.assert_allclose(distances_from(flat, 0)[:n], expected, atol=0.2 * expected.max())
    assert np.array_equal(distances_from(SMALL, 0), expected)
