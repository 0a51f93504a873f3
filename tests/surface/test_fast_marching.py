import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from auricle.errors import InputError
from auricle.simulation.anatomy import AtriumShape
from auricle.simulation.atrium import atrium
from auricle.surface.fast_marching import FastMarching, VoronoiCells
from auricle.surface.geodesics import exact_geodesic_distances
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import cube, icosphere, joined, rectangle
from auricle.surface.transfer import barycentric_at

RADIUS = 10.0
SPHERE = icosphere(radius=RADIUS, subdivisions=4)
ON_SPHERE = FastMarching(SPHERE)
SHEET = rectangle(width=20.0, height=10.0, n_x=21, n_y=11)
vertices_of_sphere = st.integers(0, SPHERE.n_vertices - 1)


def great_circle(mesh: Mesh, source: int):
    here = mesh.vertices[source]
    across = np.linalg.norm(np.cross(mesh.vertices, here), axis=1)
    return np.linalg.norm(here) * np.arctan2(across, mesh.vertices @ here)


def relative_errors(found, expected):
    away = expected > 0
    return np.abs(found[away] / expected[away] - 1)


def test_distances_on_an_atrium_are_exact_within_half_a_percent_in_the_median():
    mesh = atrium(AtriumShape.random(np.random.default_rng(1)), spacing=3.0)
    marching = FastMarching(mesh)
    errors = np.concatenate(
        [
            relative_errors(marching.from_source([source]), exact_geodesic_distances(mesh, source))
            for source in (0, 700, 1900)
        ]
    )
    assert np.median(errors) < 0.005
    assert np.quantile(errors, 0.95) < 0.01
    assert errors.max() < 0.03


@pytest.mark.parametrize("source", [0, 115, 230])
@pytest.mark.parametrize("shear", [0.0, 1.0, 3.5, 6.0])
def test_distances_on_a_flat_sheet_are_straight_lines_however_obtuse_its_triangles(shear, source):
    sheared = SHEET.vertices + shear * np.outer(SHEET.vertices[:, 1], [1.0, 0.0, 0.0])
    sheet = Mesh(sheared, SHEET.faces)
    marching = FastMarching(sheet)
    straight = np.linalg.norm(sheared - sheared[source], axis=1)
    inside = exact_geodesic_distances(sheet, source)
    np.testing.assert_allclose(inside, straight, atol=1e-9)
    np.testing.assert_allclose(marching.from_source([source]), straight, rtol=1e-8)


def test_a_source_inside_a_triangle_of_a_flat_sheet_sees_straight_lines():
    place = np.array([7.3, 4.6, 0.0])
    straight = np.linalg.norm(SHEET.vertices - place, axis=1)
    faces, _, _ = barycentric_at(SHEET, place[None])
    corners = SHEET.faces[faces[0]]
    found = FastMarching(SHEET).from_source(corners, straight[corners])
    np.testing.assert_allclose(found, straight, rtol=1e-8)


def test_errors_on_a_sphere_halve_with_the_edges():
    medians = []
    for subdivisions in (2, 3, 4):
        mesh = icosphere(radius=RADIUS, subdivisions=subdivisions)
        errors = relative_errors(FastMarching(mesh).from_source([0]), great_circle(mesh, 0))
        medians.append(np.median(errors))
    ratios = np.divide(medians[:-1], medians[1:])
    assert (ratios > 1.8).all()


def test_around_the_edges_of_a_cube_distances_unfold_its_sides():
    box = cube(side=10.0, n=12)
    errors = relative_errors(FastMarching(box).from_source([0]), exact_geodesic_distances(box, 0))
    assert np.median(errors) < 0.001
    assert errors.max() < 0.05


@given(vertices_of_sphere, vertices_of_sphere)
def test_no_distance_is_shorter_than_the_straight_line(a, b):
    straight = np.linalg.norm(SPHERE.vertices[a] - SPHERE.vertices[b])
    assert ON_SPHERE.from_source([a])[b] >= straight - 1e-9


@given(vertices_of_sphere, st.floats(0.1, 40.0))
def test_a_limited_reach_changes_nothing_within_it(source, reach):
    whole = ON_SPHERE.from_source([source])
    limited = ON_SPHERE.from_source([source], reach=reach)
    within = whole <= reach
    np.testing.assert_allclose(limited[within], whole[within], rtol=1e-3)
    assert np.isinf(limited[whole > 1.001 * reach]).all()


def test_a_partition_grown_source_by_source_is_that_of_the_whole_distances(rng):
    differ = []
    for _ in range(4):
        sources = rng.choice(SPHERE.n_vertices, 60, replace=False)
        cells = VoronoiCells(ON_SPHERE)
        for source in sources:
            cells.add([source])
        whole = np.stack([ON_SPHERE.from_source([source]) for source in sources])
        np.testing.assert_allclose(cells.distances, whole.min(axis=0), rtol=0.02, atol=1e-12)
        assert (cells.owners == whole.argmin(axis=0)).mean() > 0.99
        differ.append((cells.distances > whole.min(axis=0) + 1e-9).mean())
    assert np.mean(differ) < 0.004  # at cells' borders only: 0.01 if no distance went beyond


def test_each_source_is_marched_no_farther_than_it_is_the_nearest():
    cells = VoronoiCells(ON_SPHERE)
    source = 0
    for _ in range(200):
        cells.add([source])
        source = int(cells.distances.argmax())
    assert cells.n_visits < 1.5 * SPHERE.n_vertices * (1 + np.log(200))


def test_a_source_added_twice_wins_nothing():
    cells = VoronoiCells(ON_SPHERE)
    assert len(cells.add([5])) == SPHERE.n_vertices
    assert len(cells.add([5])) == 0
    assert cells.n_sources == 2
    assert (cells.owners == 0).all()


def test_another_piece_is_infinitely_far_and_nobodys():
    far = Mesh(SPHERE.vertices + 50.0, SPHERE.faces)
    cells = VoronoiCells(FastMarching(joined([SPHERE, far])))
    cells.add([3])
    assert np.isinf(cells.distances[SPHERE.n_vertices :]).all()
    assert (cells.owners[SPHERE.n_vertices :] == -1).all()
    assert np.isfinite(cells.distances[: SPHERE.n_vertices]).all()


def test_distances_grow_with_the_mesh_and_repeat_to_the_last_bit():
    scaled = FastMarching(Mesh(8.0 * SPHERE.vertices, SPHERE.faces))
    once = ON_SPHERE.from_source([7])
    np.testing.assert_array_equal(scaled.from_source([7]), 8.0 * once)
    np.testing.assert_array_equal(ON_SPHERE.from_source([7]), once)


def test_a_triangle_without_area_does_no_harm():
    a, b, c = SHEET.faces[150]
    middle = (SHEET.vertices[a] + SHEET.vertices[b]) / 2
    n = SHEET.n_vertices
    faces = [*np.delete(SHEET.faces, 150, axis=0), [a, n, c], [n, b, c], [a, b, n]]
    flat = Mesh(np.vstack([SHEET.vertices, middle]), faces)
    straight = np.linalg.norm(flat.vertices - flat.vertices[0], axis=1)
    np.testing.assert_allclose(FastMarching(flat).from_source([0]), straight, rtol=1e-3)


@pytest.mark.parametrize(
    ("vertices", "offsets"),
    [([], None), ([-1], None), ([SPHERE.n_vertices], None), ([1, 2], [0.0]), ([1], [-1.0])],
)
def test_sources_that_are_none_are_refused(vertices, offsets):
    with pytest.raises(InputError, match="source"):
        ON_SPHERE.from_source(vertices, offsets)
