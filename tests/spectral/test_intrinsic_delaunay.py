"""Edges flipped along a surface: as a library flips them, and as the definition asks."""

import numpy as np
import pytest
import robust_laplacian
from hypothesis import given, settings
from hypothesis import strategies as st

from auricle.spectral.intrinsic_delaunay import intrinsic_delaunay
from auricle.spectral.laplacian import intrinsic_delaunay_laplacian
from auricle.surface.cleaning import clean
from auricle.surface.mesh import Mesh
from auricle.surface.reading import read_surface
from auricle.surface.shapes import cube, icosphere, joined, rectangle, torus

SPHERE = icosphere(radius=30.0, subdivisions=3)


def stretched(mesh: Mesh, *factors: float) -> Mesh:
    return Mesh(mesh.vertices * np.array(factors), mesh.faces)


def shaken(mesh: Mesh) -> Mesh:
    """No four vertices on a circle, where either diagonal would do."""
    noise = np.random.default_rng(0).standard_normal(mesh.vertices.shape)
    return Mesh(mesh.vertices + 0.03 * noise, mesh.faces)


def with_needles() -> Mesh:
    vertices = SPHERE.vertices.copy()
    for face in SPHERE.faces[::90]:
        vertices[face[0]] = vertices[face[1]] + 1e-3 * (vertices[face[0]] - vertices[face[1]])
    return Mesh(vertices, SPHERE.faces)


SHAPES = {
    "flattened": stretched(SPHERE, 1.0, 1.0, 0.1),
    "long": stretched(SPHERE, 1.0, 1.0, 7.0),
    "skewed torus": stretched(torus(major=30.0, minor=10.0, n_major=40, n_minor=9), 1.0, 0.2, 1.0),
    "folded": stretched(cube(side=40.0, n=6), 1.0, 0.1, 3.0),
    "needles": with_needles(),
}


def agree_with_the_library(mesh: Mesh, tolerance: float) -> None:
    own = intrinsic_delaunay_laplacian(mesh)
    stiffness, mass = robust_laplacian.mesh_laplacian(mesh.vertices, mesh.faces)
    difference = abs(own.stiffness - stiffness).max()
    assert difference <= tolerance * abs(stiffness).max()
    np.testing.assert_allclose(own.areas, mass.diagonal(), rtol=1e-6)


@pytest.mark.parametrize("name", SHAPES)
def test_the_laplacian_is_that_of_a_library(name) -> None:
    agree_with_the_library(shaken(SHAPES[name]), 1e-6)


def test_the_laplacian_of_an_atrium_is_that_of_a_library(real_data) -> None:
    whole = clean(read_surface(real_data / "meshes" / "lge" / "LA_A_lge.vtk")).mesh
    agree_with_the_library(stretched(whole, 1.0, 1.0, 0.3), 1e-6)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), roughness=st.floats(0.0, 0.4))
def test_no_weight_is_negative_and_the_area_stays(seed, roughness) -> None:
    noise = np.random.default_rng(seed).standard_normal(SPHERE.vertices.shape)
    mesh = Mesh(SPHERE.vertices + 3.0 * roughness * noise, SPHERE.faces)
    triangles = intrinsic_delaunay(mesh.vertices, mesh.faces)
    assert triangles.areas.sum() / 3 == pytest.approx(mesh.area, rel=1e-4)
    stiffness = intrinsic_delaunay_laplacian(mesh).stiffness.tocoo()
    assert stiffness.data[stiffness.coords[0] != stiffness.coords[1]].max() < 1e-6


def test_what_is_delaunay_stays_as_it_is() -> None:
    triangles = intrinsic_delaunay(SPHERE.vertices, SPHERE.faces)
    found = set(zip(triangles.origins.tolist(), triangles.ends.tolist(), strict=True))
    ends = np.roll(SPHERE.faces, -1, axis=1)
    assert found == set(zip(SPHERE.faces.ravel().tolist(), ends.ravel().tolist(), strict=True))


@pytest.mark.parametrize("thin", [1e-4, 1e-7, 1e-10, 0.0])
def test_flips_come_to_an_end_however_thin_the_triangles(rng, thin) -> None:
    vertices = SPHERE.vertices.copy()
    for face in rng.permutation(SPHERE.faces)[:200]:
        vertices[face[0]] = vertices[face[1]] + thin * (vertices[face[0]] - vertices[face[1]])
    triangles = intrinsic_delaunay(vertices, SPHERE.faces)
    assert triangles.areas.min() > 0
    assert (triangles.doubled_dots / triangles.areas).max() < np.inf


def test_the_order_of_faces_and_of_corners_does_not_matter(rng) -> None:
    mesh = SHAPES["flattened"]
    turned = [np.roll(face, rng.integers(3)) for face in rng.permutation(mesh.faces)]
    one = intrinsic_delaunay_laplacian(mesh).stiffness
    other = intrinsic_delaunay_laplacian(Mesh(mesh.vertices, np.array(turned))).stiffness
    assert abs(one - other).max() < 1e-9


@pytest.mark.parametrize(
    "mesh",
    [
        rectangle(width=30.0, height=20.0, n_x=5, n_y=4),
        Mesh(SPHERE.vertices, np.vstack([SPHERE.faces[:1, ::-1], SPHERE.faces[1:]])),
        Mesh(SPHERE.vertices, np.vstack([SPHERE.faces, SPHERE.faces[:1]])),
        joined([SPHERE, cube(side=200.0, n=4)]),
    ],
    ids=["open", "one face turned over", "one face twice", "in two pieces"],
)
def test_what_is_not_closed_oriented_and_whole_is_left_to_the_library(mesh) -> None:
    assert intrinsic_delaunay(mesh.vertices, mesh.faces) is None
    assert intrinsic_delaunay_laplacian(mesh).areas.min() > 0
