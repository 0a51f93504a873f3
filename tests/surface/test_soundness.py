"""Counts and measures of surfaces whose faults and sizes are known."""

import dataclasses
import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from auricle.errors import SurfaceError
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import cube, icosphere, joined, rectangle, torus
from auricle.surface.soundness import (
    nonmanifold_vertices,
    require_sound,
    signed_volume,
    soundness,
    triangle_quality,
    vertex_areas,
)

SPHERE = icosphere(radius=10.0, subdivisions=2)
PLATE = rectangle(width=6.0, height=4.0, n_x=7, n_y=5)


def with_faces(mesh, *extra):
    return Mesh(mesh.vertices, np.concatenate([mesh.faces, extra]))


def test_a_cube_is_what_it_is():
    found = soundness(cube(side=3.0, n=6))
    assert (found.n_vertices, found.n_faces, found.n_pieces) == (218, 432, 1)
    assert (found.n_holes, found.genus) == (0, 0)
    assert found.is_closed
    assert found.is_manifold
    assert found.is_oriented
    assert found.area_mm2 == pytest.approx(54.0, rel=1e-12)
    assert found.volume_mm3 == pytest.approx(27.0, rel=1e-12)
    assert found.edge_length_mm == pytest.approx(0.5, rel=1e-12)
    assert found.smallest_quality == pytest.approx(np.sqrt(3) / 2, rel=1e-12)
    assert found.negative_weight_share == 0.0


def test_a_torus_has_a_handle_and_its_volume():
    found = soundness(torus(major=20.0, minor=5.0, n_major=120, n_minor=80))
    assert found.genus == 1
    assert found.volume_mm3 == pytest.approx(2 * np.pi**2 * 20 * 25, rel=5e-3)


def test_a_plate_has_a_hole_and_no_volume():
    found = soundness(PLATE)
    assert (found.is_closed, found.n_holes, found.genus, found.volume_mm3) == (False, 1, 0, None)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(-3, 3), st.floats(-5, 5))
def test_counts_do_not_move_with_place_size_and_numbering(seed, log_scale, log_shift):
    rng = np.random.default_rng(seed)
    scale = 10.0**log_scale
    turn, shift = Rotation.random(rng=rng).as_matrix(), rng.normal(size=3) * scale * 10**log_shift
    name = rng.permutation(SPHERE.n_vertices)
    vertices = (SPHERE.vertices @ turn.T * scale + shift)[np.argsort(name)]
    moved = soundness(Mesh(vertices, rng.permutation(name[SPHERE.faces])))
    still = soundness(SPHERE)
    for field in dataclasses.fields(still):
        one, other = getattr(still, field.name), getattr(moved, field.name)
        power = {"edge_length_mm": 1, "area_mm2": 2, "volume_mm3": 3}.get(field.name, 0)
        assert other == pytest.approx(one * scale**power, rel=1e-8), field.name


def test_a_surface_inside_out_has_negative_volume():
    inside_out = Mesh(SPHERE.vertices, SPHERE.faces[:, ::-1])
    assert signed_volume(inside_out) == pytest.approx(-signed_volume(SPHERE), rel=1e-12)


def test_the_volume_of_an_open_surface_is_that_with_flat_lids():
    box = cube(side=4.0, n=4)
    lids = (np.abs(box.vertices[box.faces][:, :, 2]) == 2.0).all(axis=1)
    assert signed_volume(Mesh(box.vertices, box.faces[~lids])) == pytest.approx(64.0, rel=1e-12)


def test_the_quality_of_a_triangle_is_that_of_its_closed_form():
    height = np.array([0.1, 1.0, 5.0])
    vertices = np.array([[[-1, 0, 0], [1, 0, 0], [0, h, 0]] for h in height]).reshape(-1, 3)
    quality = triangle_quality(Mesh(vertices, np.arange(9).reshape(-1, 3)))
    np.testing.assert_allclose(quality, 4 * np.sqrt(3) * height / (6 + 2 * height**2), rtol=1e-14)


def test_vertex_areas_add_up_and_leave_isolated_vertices_nothing():
    mesh = Mesh(np.vstack([PLATE.vertices, [[9, 9, 9]]]), PLATE.faces)
    areas = vertex_areas(mesh)
    assert areas.sum() == pytest.approx(24.0, rel=1e-14)
    assert areas[-1] == 0.0


def test_faults_are_counted():
    far = SPHERE.vertices + np.array([50.0, 0.0, 0.0])
    vertices = np.vstack([SPHERE.vertices, far, SPHERE.vertices[:2], [[0, 0, 99]]])
    n = SPHERE.n_vertices
    flat_face = [0, n + 5, 2 * n]
    faces = [*SPHERE.faces, *(SPHERE.faces + n), SPHERE.faces[7, [1, 2, 0]], flat_face]
    found = soundness(Mesh(vertices, faces))
    assert found.n_duplicate_vertices == 2
    assert found.n_duplicate_faces == 1
    assert found.n_nonmanifold_edges == 3
    assert found.n_zero_area_faces == 1
    assert found.n_slivers == 1
    assert found.smallest_quality == 0.0
    assert found.n_isolated_vertices == 2
    assert found.n_pieces == 3
    assert not found.is_manifold
    assert not found.is_oriented
    assert found.genus is None


def test_a_bow_tie_is_found_where_it_is():
    faces = joined([SPHERE, SPHERE]).faces
    glued = np.where(faces == SPHERE.n_vertices + 9, 4, faces)
    assert nonmanifold_vertices(glued).tolist() == [4]


@pytest.mark.parametrize(("across", "share"), [(0.4, 1.0), (0.8, 0.0)])
def test_an_edge_across_two_obtuse_corners_has_negative_weight(across, share):
    # The corners over the edge (-.6, .6) of a kite are obtuse while less high than half of it.
    kite = Mesh(
        [[-0.6, 0, 0], [0.6, 0, 0], [0, across, 0], [0, -across, 0]], [[0, 1, 2], [1, 0, 3]]
    )
    assert soundness(kite).negative_weight_share == share


def test_everything_is_plain_json():
    found = soundness(SPHERE)
    assert json.loads(json.dumps(dataclasses.asdict(found))) == dataclasses.asdict(found)


def test_a_sound_surface_passes():
    for mesh in (SPHERE, PLATE):
        require_sound(soundness(mesh))


def test_the_first_cause_is_named():
    glued = joined([SPHERE, SPHERE]).faces.copy()
    glued[glued == SPHERE.n_vertices] = 0
    pair = joined([SPHERE, SPHERE])
    turned = SPHERE.faces.copy()
    turned[0] = turned[0, ::-1]
    unsound = {
        "3 edges have more than two faces": with_faces(SPHERE, SPHERE.faces[0]),
        "neighbouring faces disagree": Mesh(SPHERE.vertices, turned),
        "1 vertices join sheets in a point": Mesh(pair.vertices, glued),
        "2 pieces: split the file": pair,
        "1 vertices belong to no face": Mesh(np.vstack([PLATE.vertices, [[9, 9, 9]]]), PLATE.faces),
    }
    for cause, mesh in unsound.items():
        with pytest.raises(SurfaceError, match=cause):
            require_sound(soundness(mesh))
