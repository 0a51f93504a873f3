"""A mesh and its maps are checked at the door and do not change after."""

import numpy as np
import pytest

from auricle.errors import InputError, SurfaceError
from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import cube, icosphere

TRIANGLE = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]])


def test_the_area_of_a_right_triangle_is_half_its_legs_product() -> None:
    assert Mesh(TRIANGLE, [[0, 1, 2]]).area == 6.0


def test_normals_point_along_the_right_hand_with_twice_the_area() -> None:
    assert Mesh(TRIANGLE, [[0, 1, 2]]).face_normals.tolist() == [[0.0, 0.0, 12.0]]


def test_the_faces_of_a_cube_add_up() -> None:
    assert cube(side=7.0, n=4).area == pytest.approx(6 * 49.0, rel=1e-12)


def test_the_caller_s_arrays_are_copied_and_the_mesh_s_are_frozen() -> None:
    vertices = TRIANGLE.copy()
    mesh = Mesh(vertices, [[0, 1, 2]])
    vertices[:] = 0.0
    assert mesh.area == 6.0
    with pytest.raises(ValueError, match="read-only"):
        mesh.vertices[0, 0] = 1.0


@pytest.mark.parametrize(
    ("vertices", "faces", "cause"),
    [
        (TRIANGLE[:, :2], [[0, 1, 2]], "shape"),
        (TRIANGLE, np.empty((0, 3)), "f > 0"),
        (TRIANGLE, [[0, 1]], "shape"),
        (TRIANGLE * np.nan, [[0, 1, 2]], "NaN"),
        (TRIANGLE, [[0, 1, 3]], "indices count from 0"),
        (TRIANGLE, [[0, 1, -1]], "indices count from 0"),
        (TRIANGLE, [[0, 1, 1]], "twice"),
        (TRIANGLE, [[2, 1, 2]], "twice"),
    ],
)
def test_what_is_no_mesh_is_refused(vertices, faces, cause) -> None:
    with pytest.raises(SurfaceError, match=cause):
        Mesh(vertices, faces)


def test_a_field_has_a_value_or_a_row_a_vertex() -> None:
    sphere = icosphere(radius=30.0, subdivisions=1)
    for shape in ((42,), (42, 3)):
        assert FieldMap(sphere, np.ones(shape), "ones").sampled.all()
    for shape in ((41,), (3, 42), (42, 3, 1), ()):
        with pytest.raises(InputError, match="one value, or one row, a vertex"):
            FieldMap(sphere, np.ones(shape), "wrong")


def test_nan_means_not_sampled_and_infinity_is_refused() -> None:
    sphere = icosphere(radius=30.0, subdivisions=1)
    values = np.ones((42, 2))
    values[7, 1] = np.nan
    assert np.flatnonzero(~FieldMap(sphere, values, "gap").sampled).tolist() == [7]
    values[7, 1] = np.inf
    with pytest.raises(InputError, match="infinite"):
        FieldMap(sphere, values, "gap")
