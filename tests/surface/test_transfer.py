"""Fields carried over between meshes: exact where they must be, honest where values lack."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh
from auricle.surface.reading import read_surface
from auricle.surface.shapes import icosphere, rectangle
from auricle.surface.simplification import simplify
from auricle.surface.transfer import barycentric_at, transfer

SPHERE = icosphere(radius=30.0, subdivisions=3)
COARSE = rectangle(width=10.0, height=8.0, n_x=6, n_y=5)
FINE = rectangle(width=10.0, height=8.0, n_x=23, n_y=19)
SEEDS = st.integers(0, 2**32 - 1)


def test_on_its_own_vertices_a_field_does_not_change(rng):
    values = rng.normal(size=(SPHERE.n_vertices, 3)) * 100
    values[::7] = np.nan
    carried = transfer(FieldMap(SPHERE, values, "v", "mV"), SPHERE)
    np.testing.assert_array_equal(np.isnan(carried.values), np.isnan(values))
    np.testing.assert_allclose(carried.values, values, rtol=1e-12, atol=1e-12)
    assert (carried.mesh, carried.name, carried.unit) == (SPHERE, "v", "mV")


def test_on_a_real_map_a_field_does_not_change(real_data):
    soup = read_surface(real_data / "maps/openep-dataset2/openep_ds2_lat_bip.vtk")
    field = FieldMap(Mesh(soup.vertices, soup.faces), soup.point_fields["LAT"], "LAT", "ms")
    carried = transfer(field, field.mesh)
    assert (~field.sampled).any()
    np.testing.assert_allclose(carried.values, field.values, rtol=0, atol=1e-12)


@pytest.mark.parametrize(("source", "target"), [(COARSE, FINE), (FINE, COARSE)])
def test_a_linear_field_on_a_plane_is_carried_exactly(source, target):
    slopes = np.array([3.0, -2.0, 7.0])
    carried = transfer(FieldMap(source, source.vertices @ slopes + 5, "l", "ms"), target)
    np.testing.assert_allclose(carried.values, target.vertices @ slopes + 5, rtol=0, atol=1e-12)


def test_a_smooth_field_is_carried_with_second_order():
    errors = []
    for n in (11, 21, 41):
        source = rectangle(width=10.0, height=10.0, n_x=n, n_y=n)
        target = rectangle(width=10.0, height=10.0, n_x=73, n_y=73)
        wave = FieldMap(source, np.sin(source.vertices[:, 0] + source.vertices[:, 1] / 2), "w")
        x, y, _ = target.vertices.T
        errors.append(np.abs(transfer(wave, target).values - np.sin(x + y / 2)).max())
    rates = np.log2(np.divide(errors[:-1], errors[1:]))
    np.testing.assert_allclose(rates, 2.0, atol=0.25)


def test_a_position_carried_to_a_simpler_mesh_is_as_near_as_the_surface_is():
    simpler = simplify(SPHERE, 200)
    carried = transfer(FieldMap(SPHERE, SPHERE.vertices, "position", "mm"), simpler)
    _, _, distances = barycentric_at(SPHERE, simpler.vertices)
    moved = np.linalg.norm(carried.values - simpler.vertices, axis=1)
    np.testing.assert_allclose(moved, distances, atol=1e-12)


@settings(max_examples=25, deadline=None)
@given(SEEDS, st.floats(-4, 2))
def test_weights_are_shares_that_rebuild_the_nearest_point(seed, log_flatness):
    rng = np.random.default_rng(seed)
    vertices = rng.normal(size=(30, 3)) * [10.0, 10.0**log_flatness, 10.0**log_flatness]
    mesh = Mesh(vertices, np.arange(30).reshape(-1, 3))
    points = rng.normal(size=(40, 3)) * 15
    faces, weights, distances = barycentric_at(mesh, points)
    assert (weights >= 0).all()
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, rtol=1e-14)
    nearest = np.einsum("pc,pci->pi", weights, mesh.vertices[mesh.faces[faces]])
    np.testing.assert_allclose(np.linalg.norm(points - nearest, axis=1), distances, rtol=1e-8)


@settings(max_examples=25, deadline=None)
@given(SEEDS)
def test_no_value_leaves_the_range_of_the_source(seed):
    rng = np.random.default_rng(seed)
    values = rng.normal(size=COARSE.n_vertices)
    values[rng.random(COARSE.n_vertices) < 0.2] = np.nan
    carried = transfer(FieldMap(COARSE, values, "v"), FINE).values
    assert np.nanmin(carried) >= np.nanmin(values) - 1e-12
    assert np.nanmax(carried) <= np.nanmax(values) + 1e-12


@pytest.mark.parametrize(
    ("point", "expected"),
    [
        ((0.2, 0.2, 0.0), (0.6 * 10 + 0.2 * 20) / 0.8),
        ((0.4, 0.1, 3.0), (0.5 * 10 + 0.4 * 20) / 0.9),
        ((0.25, 0.5, 0.0), (0.25 * 10 + 0.25 * 20) / 0.5),
        ((0.2, 0.6, 0.0), np.nan),
        ((0.0, 1.0, 0.0), np.nan),
    ],
)
def test_a_corner_without_value_is_left_out_up_to_half_the_weight(point, expected):
    triangle = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    around = Mesh([point, [0, 0, 0], [1, 0, 0]], [[0, 1, 2]])
    carried = transfer(FieldMap(triangle, [10.0, 20.0, np.nan], "v"), around)
    assert carried.values[0] == pytest.approx(expected, rel=1e-12, nan_ok=True)
    assert carried.values[1:].tolist() == [10.0, 20.0]


def test_each_column_lacks_its_own_values():
    triangle = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    values = np.array([[1.0, np.nan], [2.0, 5.0], [np.nan, 7.0]])
    carried = transfer(FieldMap(triangle, values, "v"), triangle)
    np.testing.assert_array_equal(carried.values, values)


@pytest.mark.parametrize("height", [0.0, 1e-300, 1e-14])
def test_a_face_of_no_area_counts_as_its_longest_edge(height):
    needle = Mesh([[0, 0, 0], [4, 0, 0], [1, height, 0]], [[0, 1, 2]])
    points = np.array([[3.0, 5.0, 0.0], [-2.0, 0.0, 0.0], [9.0, 0.0, 0.0]])
    _, weights, _ = barycentric_at(needle, points)
    np.testing.assert_allclose(weights @ needle.vertices[:, 0], [3.0, 0.0, 4.0], atol=1e-12)


def test_a_face_of_one_place_gives_its_first_corner():
    spot = Mesh([[1, 1, 1], [1, 1, 1], [1, 1, 1]], [[0, 1, 2]])
    assert barycentric_at(spot, np.zeros((1, 3)))[1].tolist() == [[1.0, 0.0, 0.0]]
