import numpy as np
import pytest
from scipy.special import elliprg

from auricle.errors import InputError
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import cube, ellipsoid, icosphere, joined, rectangle, torus
from auricle.surface.soundness import soundness


def volume(mesh: Mesh) -> float:
    a, b, c = (mesh.vertices[mesh.faces[:, corner]] for corner in range(3))
    return float(np.einsum("ij,ij->", np.cross(a, b), c) / 6.0)


def assert_second_order(errors):
    """Halving the edge divides the error by four."""
    ratios = np.divide(errors[:-1], errors[1:])
    assert (ratios > 3.7).all()
    assert (ratios < 4.3).all()


def test_sphere_area_and_volume_converge_from_below_at_second_order():
    spheres = [icosphere(radius=30.0, subdivisions=s) for s in range(2, 6)]
    assert_second_order([4 * np.pi * 30**2 - sphere.area for sphere in spheres])
    assert_second_order([4 / 3 * np.pi * 30**3 - volume(sphere) for sphere in spheres])


@pytest.mark.parametrize("subdivisions", [0, 1, 4])
def test_icosphere_has_the_promised_counts_and_lies_on_the_sphere(subdivisions):
    sphere = icosphere(radius=7.0, subdivisions=subdivisions)
    assert sphere.n_vertices == 10 * 4**subdivisions + 2
    assert sphere.n_faces == 20 * 4**subdivisions
    np.testing.assert_allclose(np.linalg.norm(sphere.vertices, axis=1), 7.0, rtol=1e-14)


def test_icosahedron_is_regular():
    solid = icosphere(radius=1.0, subdivisions=0)
    edges = np.linalg.norm(
        solid.vertices[solid.faces] - solid.vertices[np.roll(solid.faces, 1, axis=1)], axis=2
    )
    np.testing.assert_allclose(edges, 1.0 / np.sin(2 * np.pi / 5), rtol=1e-14)


def test_ellipsoid_area_and_volume_converge_to_carlsons_integral():
    a, b, c = 10.0, 15.0, 25.0
    area = 4 * np.pi * elliprg((a * b) ** 2, (b * c) ** 2, (a * c) ** 2)
    shapes = [ellipsoid(semi_axes=(a, b, c), subdivisions=s) for s in range(3, 6)]
    assert_second_order([area - shape.area for shape in shapes])
    assert_second_order([4 / 3 * np.pi * a * b * c - volume(shape) for shape in shapes])


def test_torus_area_and_volume_converge_at_second_order():
    rings = [torus(major=20.0, minor=6.0, n_major=8 * n, n_minor=4 * n) for n in (2, 4, 8, 16)]
    assert_second_order([4 * np.pi**2 * 20 * 6 - ring.area for ring in rings])
    assert_second_order([2 * np.pi**2 * 20 * 6**2 - volume(ring) for ring in rings])


@pytest.mark.parametrize(
    ("mesh", "genus"),
    [
        (icosphere(radius=1.0, subdivisions=2), 0),
        (ellipsoid(semi_axes=(1.0, 2.0, 3.0), subdivisions=2), 0),
        (torus(major=3.0, minor=1.0, n_major=8, n_minor=6), 1),
        (torus(major=3.0, minor=1.0, n_major=7, n_minor=3), 1),
        (cube(side=2.0, n=1), 0),
        (cube(side=2.0, n=4), 0),
    ],
)
def test_closed_shapes_are_sound_outward_and_of_their_genus(mesh, genus):
    report = soundness(mesh)
    assert report.is_closed
    assert report.is_manifold
    assert report.is_oriented
    assert report.n_pieces == 1
    assert report.n_duplicate_vertices == 0
    assert report.genus == genus
    assert volume(mesh) > 0


def test_cube_has_the_area_and_volume_of_a_cube_for_any_grid():
    for n in (1, 2, 5):
        box = cube(side=3.0, n=n)
        assert box.n_vertices == 6 * n**2 + 2
        assert box.area == pytest.approx(54.0, rel=1e-14)
        assert volume(box) == pytest.approx(27.0, rel=1e-14)
        assert np.abs(box.vertices).max(axis=1) == pytest.approx(1.5)


def test_rectangle_is_flat_upward_numbered_along_x_and_of_exact_area():
    sheet = rectangle(width=30.0, height=10.0, n_x=13, n_y=6)
    assert sheet.area == pytest.approx(300.0, rel=1e-14)
    assert (sheet.face_normals[:, 2] > 0).all()
    np.testing.assert_allclose(sheet.vertices[2 * 13 + 5], (5 * 30 / 12, 2 * 10 / 5, 0.0))
    report = soundness(sheet)
    assert (report.n_holes, report.n_pieces, report.is_manifold) == (1, 1, True)


@pytest.mark.parametrize(
    "mesh",
    [
        rectangle(width=1.0, height=1.0, n_x=7, n_y=5),
        torus(major=3.0, minor=1.0, n_major=8, n_minor=6),
    ],
)
def test_diagonals_run_both_ways_equally_often(mesh):
    valence = np.bincount(
        np.unique(np.sort(mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)), axis=0).ravel()
    )
    inner = valence[valence >= 4]
    assert set(inner.tolist()) >= {4, 8}
    assert 6 not in inner


def test_joined_meshes_keep_their_faces_apart():
    ball, box = icosphere(radius=1.0, subdivisions=1), cube(side=1.0, n=2)
    both = joined([ball, box, ball])
    assert both.area == pytest.approx(2 * ball.area + box.area, rel=1e-14)
    assert soundness(both).n_pieces == 3
    np.testing.assert_array_equal(both.faces[20 * 4 : 20 * 4 + 48], box.faces + ball.n_vertices)


@pytest.mark.parametrize(
    "build",
    [
        lambda: icosphere(radius=0.0, subdivisions=1),
        lambda: icosphere(radius=np.nan, subdivisions=1),
        lambda: icosphere(radius=1.0, subdivisions=-1),
        lambda: ellipsoid(semi_axes=(1.0, 1.0, -1.0), subdivisions=1),
        lambda: rectangle(width=1.0, height=0.0, n_x=2, n_y=2),
        lambda: rectangle(width=1.0, height=1.0, n_x=1, n_y=2),
        lambda: torus(major=1.0, minor=1.0, n_major=8, n_minor=8),
        lambda: torus(major=2.0, minor=1.0, n_major=8, n_minor=2),
        lambda: cube(side=1.0, n=0),
        lambda: joined([]),
    ],
)
def test_impossible_shapes_are_refused(build):
    with pytest.raises(InputError, match=": give"):
        build()
