"""Distances between surfaces against planes, spheres and brute force."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from auricle.errors import InputError
from auricle.surface.distance import geometric_distance, point_to_surface, vertexwise_rms
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere, rectangle, torus
from auricle.surface.soundness import vertex_areas

SPHERE = icosphere(radius=10.0, subdivisions=3)
PLATE = rectangle(width=8.0, height=6.0, n_x=9, n_y=7)
SEEDS = st.integers(0, 2**32 - 1)


def moved(mesh, shift):
    return Mesh(mesh.vertices + np.asarray(shift, dtype=float), mesh.faces)


def test_a_surface_lies_at_no_distance_from_itself():
    found = geometric_distance(SPHERE, SPHERE, symmetric=True)
    assert max(dataclasses.astuple(found)) < 1e-12


@pytest.mark.parametrize("symmetric", [False, True])
def test_parallel_planes_lie_everywhere_at_their_distance(symmetric):
    found = geometric_distance(PLATE, moved(PLATE, [0, 0, 2.5]), symmetric=symmetric)
    assert dataclasses.astuple(found) == pytest.approx((2.5,) * 4, rel=1e-12)


def test_the_nearest_point_may_be_a_face_an_edge_or_a_corner():
    points = np.array([[4.2, 3.1, 3.0], [4.3, -2.0, 0.0], [11.0, 10.0, 0.0], [-1.0, -2.0, 2.0]])
    np.testing.assert_allclose(point_to_surface(points, PLATE), [3.0, 2.0, 5.0, 3.0], rtol=1e-14)


@settings(max_examples=20, deadline=None)
@given(SEEDS)
def test_no_sample_of_the_surface_is_nearer(seed):
    rng = np.random.default_rng(seed)
    ring = torus(major=9.0, minor=3.0, n_major=12, n_minor=8)
    points = rng.normal(size=(5, 3)) * 8
    weights = rng.dirichlet(np.ones(3), size=(ring.n_faces, 40))
    samples = np.einsum("fsc,fci->fsi", weights, ring.vertices[ring.faces]).reshape(-1, 3)
    sampled = np.linalg.norm(points[:, None] - samples, axis=2).min(axis=1)
    exact = point_to_surface(points, ring)
    assert (exact <= sampled + 1e-12).all()
    assert (sampled - exact < 1.0).all()


@settings(max_examples=20, deadline=None)
@given(SEEDS)
def test_distances_are_ordered_as_their_definitions_are(seed):
    rng = np.random.default_rng(seed)
    rough = Mesh(
        SPHERE.vertices * (1 + 0.1 * rng.normal(size=(SPHERE.n_vertices, 1))), SPHERE.faces
    )
    for found in (geometric_distance(rough, SPHERE), geometric_distance(SPHERE, rough)):
        assert 0 < found.mean <= found.rms <= found.hausdorff
        assert found.percentile_95 <= found.hausdorff
    near = geometric_distance(rough, SPHERE).percentile_95
    distances, areas = point_to_surface(rough.vertices, SPHERE), vertex_areas(rough)
    assert areas[distances < near].sum() < 0.95 * rough.area <= areas[distances <= near].sum()


def test_far_from_the_origin_nothing_changes():
    near = geometric_distance(SPHERE, PLATE)
    far = geometric_distance(moved(SPHERE, [1e5] * 3), moved(PLATE, [1e5] * 3))
    assert dataclasses.astuple(far) == pytest.approx(dataclasses.astuple(near), rel=1e-9)


def test_mean_and_percentile_count_area_not_vertices():
    # Most vertices lie at distance 0, most of the length of the plate at 1.
    x = np.concatenate([np.linspace(0, 4, 81), [7.0, 10.0]])
    plate = rectangle(width=10.0, height=2.0, n_x=83, n_y=3)
    vertices = plate.vertices.copy()
    vertices[:, 0] = np.tile(x, 3)
    vertices[:, 2] = vertices[:, 0] > 4
    found = geometric_distance(Mesh(vertices, plate.faces), plate)
    areas = vertex_areas(Mesh(vertices, plate.faces))
    raised = areas[vertices[:, 2] == 1].sum() / areas.sum()
    assert found.mean == pytest.approx(raised, rel=1e-12)
    assert raised > 0.4
    assert np.mean(vertices[:, 2]) < 0.03
    assert found.percentile_95 == 1.0


def test_one_side_may_not_see_what_the_other_does():
    patch = Mesh(PLATE.vertices * [0.5, 1.0, 1.0], PLATE.faces)
    assert geometric_distance(patch, PLATE).hausdorff < 1e-12
    back = geometric_distance(PLATE, patch)
    assert back.hausdorff == pytest.approx(4.0, rel=1e-12)
    both = geometric_distance(patch, PLATE, symmetric=True)
    assert both.hausdorff == back.hausdorff
    assert both.percentile_95 == back.percentile_95
    assert both.mean == pytest.approx(back.mean / 2, rel=1e-12)
    assert both.rms == pytest.approx(back.rms / np.sqrt(2), rel=1e-12)
    assert geometric_distance(PLATE, patch, symmetric=True) == both


def test_a_shift_is_its_own_vertexwise_rms():
    areas = vertex_areas(SPHERE)
    shifted = SPHERE.vertices + np.array([2.0, 3.0, 6.0])
    assert vertexwise_rms(SPHERE.vertices, shifted, areas) == pytest.approx(7.0, rel=1e-12)


def test_scaling_a_sphere_moves_its_vertices_by_the_change_in_radius():
    areas = vertex_areas(SPHERE)
    larger = vertexwise_rms(SPHERE.vertices, 1.3 * SPHERE.vertices, areas)
    assert larger == pytest.approx(3.0, rel=1e-12)


def test_vertexwise_rms_refuses_what_does_not_belong_together():
    with pytest.raises(InputError, match="do not belong together"):
        vertexwise_rms(SPHERE.vertices, SPHERE.vertices[:-1], vertex_areas(SPHERE))
