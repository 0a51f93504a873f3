"""Simplification beyond counts: volume, slivers, renumbering, fields, random soups, real atria."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from auricle.errors import InputError, SurfaceError
from auricle.surface.cleaning import clean
from auricle.surface.distance import geometric_distance
from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh
from auricle.surface.reading import read_surface
from auricle.surface.shapes import icosphere, rectangle, torus
from auricle.surface.simplification import (
    simplification_sequence,
    simplify,
    simplify_with_fields,
)
from auricle.surface.soundness import signed_volume, soundness, triangle_quality, vertex_areas
from auricle.surface.soup import TriangleSoup
from auricle.surface.transfer import transfer


def bumpy_sphere(subdivisions: int = 4) -> Mesh:
    """About the size of an atrium, without symmetry, so that no two edges cost the same."""
    sphere = icosphere(radius=30.0, subdivisions=subdivisions)
    x, y, z = sphere.vertices.T / 30
    noise = 0.01 * np.sin(37 * x + 19 * y * y + 23 * z)
    return Mesh(sphere.vertices * (1 + 0.15 * x * y + 0.1 * z**3 + noise)[:, None], sphere.faces)


BUMPY = bumpy_sphere()


def step(mesh: Mesh) -> FieldMap:
    """A map with a sharp, curved border: 0 on one side, 1 on the other."""
    x, y, z = (mesh.vertices / 30).T
    return FieldMap(mesh, (x + 0.3 * np.sin(3 * y) + 0.2 * z > 0).astype(float), "front", "ms")


def field_error(coarse: FieldMap, fine: FieldMap) -> float:
    """Root mean square difference of a coarse map from a fine one, over the fine one's area."""
    difference = transfer(coarse, fine.mesh).values - fine.values
    return float(np.sqrt(np.average(difference**2, weights=vertex_areas(fine.mesh))))


@pytest.mark.parametrize("n_vertices", [2000, 300, 100])
def test_a_closed_surface_keeps_its_volume_to_rounding(n_vertices):
    ring = torus(major=20.0, minor=8.0, n_major=60, n_minor=31)
    for mesh in (BUMPY, ring):
        volume = signed_volume(mesh)
        assert signed_volume(simplify(mesh, min(n_vertices, 1500))) == pytest.approx(
            volume, rel=1e-12
        )


def test_keeping_the_volume_keeps_the_surface_in_the_middle():
    """Vertices of a coarse sphere stand out as far as its faces cut in."""
    sphere = icosphere(radius=30.0, subdivisions=5)
    coarse = simplify(sphere, 200)
    outward = np.linalg.norm(coarse.vertices, axis=1).mean() - 30.0
    middles = coarse.vertices[coarse.faces].mean(axis=1)
    inward = 30.0 - np.linalg.norm(middles, axis=1).mean()
    assert outward > 0.1
    assert 1.0 < outward / inward < 5.0
    assert geometric_distance(sphere, coarse).mean < 0.5 * (outward + inward)


@pytest.mark.parametrize("n_vertices", [500, 200, 100])
def test_no_needles_come(n_vertices):
    """Not even where the curvature asks for them: along a thin ring, along folds."""
    ring = torus(major=60.0, minor=3.0, n_major=240, n_minor=16)
    plate = rectangle(width=100.0, height=20.0, n_x=101, n_y=41)
    x, y, _ = plate.vertices.T
    folds = Mesh(np.column_stack([x, y, 3.0 * np.sin(y / 2)]), plate.faces)
    for mesh in (ring, folds):
        assert triangle_quality(simplify(mesh, n_vertices)).min() >= 0.1


def test_needles_go():
    """Of a cylinder cut in long strips, few faces were any better than slivers."""
    strips = rectangle(width=40.0, height=2.0, n_x=5, n_y=41)
    x, y, _ = strips.vertices.T
    bent = Mesh(np.column_stack([np.cos(x / 20), np.sin(x / 20), y / 20]) * 20.0, strips.faces)
    assert triangle_quality(bent).max() < 0.05
    assert triangle_quality(simplify(bent, 14)).min() > 0.05


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(30, 2000))
def test_renumbering_changes_nothing_but_the_numbering(seed, n_vertices):
    rng = np.random.default_rng(seed)
    order, face_order = rng.permutation(BUMPY.n_vertices), rng.permutation(BUMPY.n_faces)
    number = np.empty(len(order), dtype=np.int64)
    number[order] = np.arange(len(order))
    faces = np.roll(number[BUMPY.faces[face_order]], int(rng.integers(3)), axis=1)
    plain = simplify(BUMPY, n_vertices)
    other = simplify(Mesh(BUMPY.vertices[order], faces), n_vertices)
    for places in ("vertices", "faces"):
        one, two = (
            mesh.vertices if places == "vertices" else mesh.vertices[mesh.faces].mean(axis=1)
            for mesh in (plain, other)
        )
        one, two = (p[np.lexsort(np.round(p, 5).T)] for p in (one, two))
        assert np.allclose(one, two, atol=1e-8)


def test_a_plane_costs_nothing():
    plate = rectangle(width=20.0, height=15.0, n_x=21, n_y=16)
    sequence = simplification_sequence(plate)
    assert sequence.n_least <= 4
    assert max(sequence.error_at(n) for n in range(4, 336)) < 1e-5
    assert geometric_distance(plate, sequence.mesh_at(4)).hausdorff < 1e-4


def test_a_sharp_border_is_kept_when_the_quadrics_know_of_it():
    field = step(BUMPY)
    plain = simplify(BUMPY, 500)
    informed, (carried,) = simplify_with_fields(BUMPY, [field], 500)
    assert informed.n_vertices == 500
    assert field_error(carried, field) < 0.5 * field_error(transfer(field, plain), field)
    assert geometric_distance(BUMPY, informed).mean < 1.25 * geometric_distance(BUMPY, plain).mean


def test_more_weight_means_less_error_in_the_field():
    field = step(BUMPY)
    errors = [
        field_error(simplify_with_fields(BUMPY, [field], 300, weight=weight)[1][0], field)
        for weight in (0.01, 1.0, 30.0)
    ]
    assert errors[0] > 1.3 * errors[1] > 1.3 * 1.05 * errors[2]


def test_a_linear_field_on_a_plane_comes_through_exactly():
    """Position and value lie on one plane in four dimensions, and collapses stay on it."""
    plate = rectangle(width=20.0, height=15.0, n_x=21, n_y=16)
    values = 7.0 - 2.0 * plate.vertices[:, 0] + 0.5 * plate.vertices[:, 1]
    mesh, (field,) = simplify_with_fields(plate, [FieldMap(plate, values, "LAT", "ms")], 30)
    expected = 7.0 - 2.0 * mesh.vertices[:, 0] + 0.5 * mesh.vertices[:, 1]
    assert np.allclose(field.values, expected, atol=1e-9)
    assert (field.name, field.unit) == ("LAT", "ms")


def test_fields_of_several_components_and_without_samples_come_through():
    x = BUMPY.vertices[:, 0]
    circle = FieldMap(BUMPY, np.column_stack([np.cos(x / 9), np.sin(x / 9)]), "phase")
    holed = FieldMap(BUMPY, np.where(x > 10, np.nan, x), "voltage", "mV")
    nothing = FieldMap(BUMPY, np.full(len(x), np.nan), "nothing")
    constant = FieldMap(BUMPY, np.full(len(x), 3.0), "constant")
    mesh, carried = simplify_with_fields(BUMPY, [circle, holed, nothing, constant], 400)
    assert [field.values.shape for field in carried] == [(400, 2), (400,), (400,), (400,)]
    assert all(field.mesh is mesh for field in carried)
    assert np.abs(np.hypot(*carried[0].values.T) - 1).max() < 0.15
    far = np.abs(mesh.vertices[:, 0] - 10) > 4
    assert np.array_equal(np.isnan(carried[1].values)[far], (mesh.vertices[:, 0] > 10)[far])
    assert np.isnan(carried[2].values).all()
    assert np.allclose(carried[3].values, 3.0)


@pytest.mark.parametrize("weight", [0.0, -1.0, np.nan, np.inf])
def test_a_weight_that_is_none_is_refused(weight):
    with pytest.raises(InputError, match="feature weight"):
        simplify_with_fields(BUMPY, [step(BUMPY)], 500, weight=weight)


def test_a_field_of_another_mesh_is_refused():
    with pytest.raises(InputError, match="another mesh"):
        simplify_with_fields(BUMPY, [step(bumpy_sphere(2))], 100)


@settings(max_examples=30, deadline=None)
@given(
    st.sampled_from(
        [
            icosphere(radius=1.0, subdivisions=1),
            rectangle(width=1.0, height=1.0, n_x=6, n_y=5),
            torus(major=3.0, minor=1.0, n_major=6, n_minor=5),
        ]
    ),
    st.integers(0, 2**32 - 1),
)
def test_random_soups_that_are_sound_survive(shape, seed):
    """Tattered, folded, flat and tangled, with vertices in one place, large or small."""
    rng = np.random.default_rng(seed)
    faces = shape.faces[rng.random(shape.n_faces) > rng.choice([0.0, 0.1, 0.3])]
    vertices = [
        shape.vertices,
        rng.normal(size=shape.vertices.shape),
        np.round(2 * shape.vertices),
        np.zeros_like(shape.vertices),
    ][rng.integers(4)]
    soup = TriangleSoup(vertices, faces)
    try:
        mesh = clean(soup, check_scale=False).mesh
    except SurfaceError:
        mesh = Mesh(rng.normal(size=(4, 3)), [[0, 1, 2], [0, 2, 3]])
    mesh = Mesh(mesh.vertices * 10.0 ** rng.integers(-9, 10), mesh.faces)
    before = soundness(mesh)
    sequence = simplification_sequence(mesh)
    assert np.isfinite(sequence.errors).all()
    for n_vertices in range(max(sequence.n_least, 4), mesh.n_vertices):
        after = soundness(sequence.mesh_at(n_vertices))
        assert after.n_vertices == n_vertices
        assert after.is_manifold
        assert after.is_oriented
        assert not after.n_duplicate_faces
        for name in ("n_pieces", "n_holes", "genus"):
            assert getattr(after, name) == getattr(before, name)


def test_real_atria_reach_the_counts_of_the_paper(real_data):
    """Closed and clipped, with needles and without: count, topology, needles, errors that fall."""
    for name in ("lasc2013-b002/gt_std_mesh.vtp", "lausm/test.vtk", "lge/LA_A_clipped_5holes.vtk"):
        mesh = clean(read_surface(real_data / "meshes" / name)).mesh
        before = soundness(mesh)
        sequence = simplification_sequence(mesh)
        distances = []
        for n_vertices in (10_000, 1_000, 50):
            after = soundness(sequence.mesh_at(n_vertices))
            assert (after.n_vertices, after.n_holes, after.genus, after.is_manifold) == (
                n_vertices,
                before.n_holes,
                before.genus,
                True,
            )
            assert after.smallest_quality >= min(0.1, before.smallest_quality)
            distances.append(sequence.distance_at(n_vertices).mean)
        assert (np.diff(distances) > 0).all()
        assert distances[1] < 0.04
