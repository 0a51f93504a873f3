"""Simplification: exact counts, kept topology, and errors that fall as they should."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from auricle.errors import InputError, SurfaceError
from auricle.surface.cleaning import clean
from auricle.surface.distance import geometric_distance
from auricle.surface.mesh import Mesh
from auricle.surface.reading import read_surface
from auricle.surface.shapes import cube, icosphere, joined, rectangle, torus
from auricle.surface.simplification import simplify
from auricle.surface.soundness import soundness

SPHERE = icosphere(radius=30.0, subdivisions=4)
PLATE = rectangle(width=20.0, height=15.0, n_x=21, n_y=16)
RING = torus(major=20.0, minor=8.0, n_major=30, n_minor=14)


def perforated():
    """A sphere with three holes."""
    x, y, z = SPHERE.vertices[SPHERE.faces].mean(axis=1).T
    kept, faces = np.unique(SPHERE.faces[(x < 27) & (y < 25) & (z > -28)], return_inverse=True)
    return Mesh(SPHERE.vertices[kept], faces.reshape(-1, 3))


SIEVE = perforated()


@settings(max_examples=15, deadline=None)
@given(st.sampled_from([SPHERE, PLATE, RING, SIEVE]), st.floats(0.05, 0.999))
def test_any_number_of_vertices_is_met_and_the_topology_kept(mesh, share):
    n_vertices = int(share * mesh.n_vertices)
    before, after = soundness(mesh), soundness(simplify(mesh, n_vertices))
    assert after.n_vertices == n_vertices
    assert after.is_manifold
    assert after.is_oriented
    for name in ("n_pieces", "n_holes", "genus", "is_closed"):
        assert getattr(after, name) == getattr(before, name)


def test_the_sieve_has_its_holes():
    assert soundness(SIEVE).n_holes == 3


@pytest.mark.parametrize("n_vertices", [PLATE.n_vertices, PLATE.n_vertices + 1, 10**6])
def test_nothing_happens_where_there_are_few_enough(n_vertices):
    assert simplify(PLATE, n_vertices) is PLATE


def test_a_sphere_comes_down_to_a_tetrahedron():
    found = soundness(simplify(SPHERE, 4))
    assert (found.n_vertices, found.n_faces, found.is_closed) == (4, 4, True)
    assert found.volume_mm3 > 0


@pytest.mark.parametrize("n_vertices", [300, 60, 4])
def test_a_plane_stays_plane_to_its_border(n_vertices):
    plate = simplify(PLATE, n_vertices)
    assert plate.area == pytest.approx(300.0, rel=1e-6)
    assert np.abs(plate.vertices[:, 2]).max() < 1e-9
    np.testing.assert_allclose(np.ptp(plate.vertices, axis=0), [20, 15, 0], atol=1e-5)


def test_a_cube_keeps_its_corners_to_the_last():
    box = simplify(cube(side=10.0, n=8), 8)
    np.testing.assert_allclose(np.abs(box.vertices), 5.0, rtol=1e-6)


def test_the_distance_falls_with_the_number_of_vertices():
    # Chords of length h lie h²/8R off a sphere, and h² goes as area over vertices.
    distances = [
        geometric_distance(SPHERE, simplify(SPHERE, n), symmetric=True).rms for n in (80, 160, 320)
    ]
    rates = np.log2(np.divide(distances[:-1], distances[1:]))
    np.testing.assert_allclose(rates, 1.0, atol=0.2)


@pytest.mark.parametrize(("scale", "shift"), [(1e6, 0.0), (1e-6, 0.0), (1.0, 1e6)])
def test_size_and_place_do_not_matter(scale, shift):
    moved = Mesh(SPHERE.vertices * scale + shift, SPHERE.faces)
    here = geometric_distance(SPHERE, simplify(SPHERE, 500)).mean
    there = geometric_distance(moved, simplify(moved, 500)).mean / scale
    assert there == pytest.approx(here, rel=0.05)


def test_the_result_is_the_same_every_time():
    one, other = simplify(SIEVE, 700), simplify(SIEVE, 700)
    np.testing.assert_array_equal(one.vertices, other.vertices)
    np.testing.assert_array_equal(one.faces, other.faces)


def test_a_handle_cannot_be_simplified_away():
    with pytest.raises(SurfaceError, match=r"no fewer than \d+ vertices keep"):
        simplify(RING, 6)


def test_fewer_than_four_vertices_are_refused():
    with pytest.raises(InputError, match="give 4 or more"):
        simplify(SPHERE, 3)


def test_unsound_surfaces_are_refused():
    with pytest.raises(SurfaceError, match="2 pieces"):
        simplify(joined([SPHERE, SPHERE]), 100)


def test_a_real_atrium_moves_by_micrometres(real_data):
    soup = read_surface(real_data / "meshes/atlas/LASC2018_06SR5RB_LA_mri_closed.vtk")
    original = clean(soup).mesh
    simpler = simplify(original, 10_000)
    assert simpler.n_vertices == 10_000
    found = geometric_distance(original, simpler, symmetric=True)
    assert found.mean < 0.012
    assert found.hausdorff < 0.1
