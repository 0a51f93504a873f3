"""Pictures of surfaces, against what geometry says must be seen."""

import numpy as np
import pytest

from auricle.report.palettes import UNKNOWN, ColourScale
from auricle.report.rasterizer import coarser, paint, rasterize, render
from auricle.report.views import STANDARD_VIEWS, Camera, cameras
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere, joined, rectangle

AP = STANDARD_VIEWS["AP"]
TWO = [[0, 1, 2], [0, 2, 3]]
SCALE = ColourScale("perceptual", (0.0, 1.0, 2.0, 3.0), "height (mm)")


def camera_at(view, *, side=100, mm_per_pixel=1.0):
    return Camera(view, (0.0, 0.0, 0.0), mm_per_pixel, side, side)


def plate(*, y, size=40.0, facing_front=True):
    """A square at depth y behind the picture's plane, centred, seen from the front."""
    flat = rectangle(width=size, height=size, n_x=5, n_y=4)
    x, z = flat.vertices[:, 0] - size / 2, flat.vertices[:, 1] - size / 2
    faces = flat.faces if facing_front else flat.faces[:, ::-1]
    return Mesh(np.column_stack([x, np.full(len(x), y), z]), faces)


@pytest.mark.parametrize("view", STANDARD_VIEWS.values(), ids=STANDARD_VIEWS)
def test_a_spheres_silhouette_is_a_disc_from_everywhere(view):
    sphere = icosphere(radius=25.0, subdivisions=4)
    image = render(sphere, camera_at(view, side=120, mm_per_pixel=0.5))
    area = (image[..., 3] / 255).sum() * 0.5**2
    assert area == pytest.approx(np.pi * 25**2, rel=0.01)


def test_a_plates_area_counts_its_pixels_exactly_and_no_seam_shows():
    raster = rasterize(plate(y=0.0), camera_at(AP))
    assert (raster.faces >= 0).sum() == 40 * 40
    rows, columns = np.nonzero(raster.faces >= 0)
    assert (np.ptp(rows), np.ptp(columns)) == (39, 39)


def test_neighbouring_faces_leave_no_gap_and_no_pixel_twice(rng):
    vertices = np.column_stack([rng.uniform(-40, 40, 3), np.zeros(3), rng.uniform(-40, 40, 3)])
    middle = vertices.mean(axis=0) + np.array([1.234, 0.0, -0.567])
    whole = Mesh(vertices, [[0, 1, 2]])
    parts = Mesh(np.vstack([vertices, middle]), [[0, 1, 3], [1, 2, 3], [2, 0, 3]])
    seen = [rasterize(mesh, camera_at(AP)).faces >= 0 for mesh in (whole, parts)]
    assert np.array_equal(*seen)
    single = [rasterize(Mesh(parts.vertices, [face]), camera_at(AP)).faces for face in parts.faces]
    assert sum((faces >= 0).sum() for faces in single) == seen[0].sum()


def test_a_centre_on_an_edge_belongs_to_one_of_the_two_faces():
    # Corners, sides and the diagonal all run through centres of pixels.
    square = Mesh([[-20.5, 0, -20.5], [20.5, 0, -20.5], [20.5, 0, 20.5], [-20.5, 0, 20.5]], TWO)
    counts = [
        (rasterize(Mesh(square.vertices, [face]), camera_at(AP)).faces >= 0).sum() for face in TWO
    ]
    assert sum(counts) == (rasterize(square, camera_at(AP)).faces >= 0).sum() == 41 * 41


@pytest.mark.parametrize("near_first", [True, False])
def test_the_nearer_surface_hides_the_farther(near_first):
    near, far = plate(y=-5.0, size=20.0), plate(y=5.0)
    first, second = (near, far) if near_first else (far, near)
    both = joined([first, second])
    values = np.where(both.vertices[:, 1] < 0, 0.5, 2.5)
    image = paint(rasterize(both, camera_at(AP)), both, values, scale=SCALE, shading=0.0)
    assert (image[50, 50, :3] == SCALE.bands[0]).all()
    assert (image[50, 35, :3] == SCALE.bands[2]).all()
    assert image[50, 5, 3] == 0


def test_values_are_interpolated_linearly_over_a_face():
    mesh = plate(y=0.0)
    raster = rasterize(mesh, camera_at(AP))
    seen = raster.faces >= 0
    places = np.einsum(
        "pc,pcd->pd", raster.weights[seen], mesh.vertices[mesh.faces[raster.faces[seen]]]
    )
    rows, columns = np.nonzero(seen)
    np.testing.assert_allclose(places[:, 0], columns + 0.5 - 50, atol=1e-9)
    np.testing.assert_allclose(places[:, 2], 50 - rows - 0.5, atol=1e-9)


def test_the_picture_shows_the_patients_left_on_the_right_and_the_head_on_top():
    mesh = plate(y=0.0)
    values = np.where(mesh.vertices[:, 0] > 0, 2.5, 0.5)
    image = render(mesh, camera_at(AP), values, scale=SCALE, shading=0.0)
    assert (image[50, 65, :3] == SCALE.bands[2]).all()
    values = np.where(mesh.vertices[:, 2] > 0, 2.5, 0.5)
    image = render(mesh, camera_at(AP), values, scale=SCALE, shading=0.0)
    assert (image[35, 50, :3] == SCALE.bands[2]).all()


def test_only_the_colours_of_the_bands_are_used():
    mesh = plate(y=0.0)
    values = np.linspace(0.0, 3.0, mesh.n_vertices)
    image = paint(rasterize(mesh, camera_at(AP)), mesh, values, scale=SCALE, shading=0.0)
    used = np.unique(image[image[..., 3] > 0][:, :3], axis=0)
    assert {tuple(colour) for colour in used} == {tuple(colour) for colour in SCALE.bands}


def test_what_is_not_sampled_is_grey_and_no_more():
    mesh = plate(y=0.0)
    values = np.where(mesh.vertices[:, 0] > 0, np.nan, 0.5)
    image = paint(rasterize(mesh, camera_at(AP)), mesh, values, scale=SCALE, shading=0.0)
    grey = (image[..., :3] == UNKNOWN).all(axis=2) & (image[..., 3] > 0)
    known = (image[..., :3] == SCALE.bands[0]).all(axis=2)
    assert grey[50, 65]
    assert known[50, 35]
    # Columns of vertices stand 10 mm apart: half a face past x = 0 still counts as known.
    assert grey.sum() == pytest.approx(40 * 15, abs=40)
    assert grey.sum() + known.sum() == 40 * 40


def test_the_inside_has_a_dark_tone_whatever_its_values():
    behind = plate(y=0.0, facing_front=False)
    values = np.full(behind.n_vertices, 2.5)
    inside = render(behind, camera_at(AP), values, scale=SCALE, shading=0.0)[50, 50, :3]
    outside = render(plate(y=0.0), camera_at(AP), shading=0.0)[50, 50, :3]
    assert not (inside == SCALE.bands).all(axis=1).any()
    assert inside.sum() < 0.6 * outside.sum()


def test_the_inside_shows_through_a_hole():
    sphere = icosphere(radius=40.0, subdivisions=3)
    heights = sphere.vertices[sphere.faces][:, :, 1].min(axis=1)
    opened = Mesh(sphere.vertices, sphere.faces[heights > -35])
    raster = rasterize(opened, camera_at(AP))
    assert not raster.outside[50, 50]
    assert raster.outside[50, 50 + 35]


def test_a_part_turned_to_the_light_is_brighter():
    sphere = icosphere(radius=40.0, subdivisions=4)
    image = render(sphere, camera_at(AP)).astype(int)
    lit, shaded = image[50 - 15, 50 - 12, 0], image[50 + 25, 50 + 25, 0]
    assert lit > 1.2 * shaded


def test_memory_bounded_batches_do_not_change_the_picture(monkeypatch):
    sphere = icosphere(radius=30.0, subdivisions=3)
    whole = rasterize(sphere, camera_at(AP))
    monkeypatch.setattr("auricle.report.rasterizer.CANDIDATES", 500)
    parts = rasterize(sphere, camera_at(AP))
    assert np.array_equal(whole.faces, parts.faces)
    assert np.array_equal(whole.weights, parts.weights)


def test_what_lies_beyond_the_picture_is_cut_off():
    raster = rasterize(plate(y=0.0, size=400.0), camera_at(AP))
    assert (raster.faces >= 0).all()


def test_averaging_keeps_colour_and_turns_cover_into_opacity():
    fine = np.zeros((2, 2, 4), dtype=np.uint8)
    fine[0, 0] = (200, 100, 50, 255)
    assert coarser(fine, 2).tolist() == [[[200, 100, 50, 64]]]


def test_every_camera_shows_the_whole_surface():
    sphere = icosphere(radius=25.0, subdivisions=3)
    mesh = Mesh(sphere.vertices * [1.0, 2.0, 0.5] + [300.0, -80.0, 7.0], sphere.faces)
    found = cameras(mesh.vertices, tuple(STANDARD_VIEWS.values()), width=90, height=60)
    assert len({camera.mm_per_pixel for camera in found}) == 1
    for camera in found:
        placed = camera.project(mesh.vertices)
        assert placed[:, :2].min() >= 0
        assert placed[:, 0].max() <= 90
        assert placed[:, 1].max() <= 60
