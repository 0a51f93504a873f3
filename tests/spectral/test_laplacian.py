"""The Laplacian: row sums, areas, definiteness, agreement of its two forms."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from auricle.spectral.laplacian import (
    Laplacian,
    cotangent_laplacian,
    intrinsic_delaunay_laplacian,
    laplacian,
)
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere, rectangle, torus

FORMS = pytest.mark.parametrize("form", [cotangent_laplacian, intrinsic_delaunay_laplacian])
TORUS = torus(major=30.0, minor=12.0, n_major=40, n_minor=24)


def needle_sphere() -> Mesh:
    """A sphere with one vertex pushed onto its neighbours' line: triangles without area."""
    sphere = icosphere(radius=30.0, subdivisions=3)
    edge = sphere.faces[0]
    vertices = sphere.vertices.copy()
    vertices[edge[0]] = vertices[edge[1]] + 1e-9 * (vertices[edge[0]] - vertices[edge[1]])
    return Mesh(vertices, sphere.faces)


@FORMS
def test_constants_are_in_the_kernel(form) -> None:
    operator: Laplacian = form(TORUS)
    assert np.abs(operator.stiffness @ np.ones(TORUS.n_vertices)).max() < 1e-12


@FORMS
def test_vertex_areas_add_up_to_the_surface(form) -> None:
    assert form(TORUS).areas.sum() == pytest.approx(TORUS.area, rel=1e-12)


@FORMS
def test_the_energy_of_a_linear_function_on_a_flat_patch_is_its_slope_squared_times_area(
    form,
) -> None:
    patch = rectangle(width=30.0, height=20.0, n_x=13, n_y=9)
    slope = np.array([0.3, -0.2, 0.0])
    values = patch.vertices @ slope
    energy = values @ (form(patch).stiffness @ values)
    assert energy == pytest.approx(slope @ slope * 600.0, rel=1e-10)


@FORMS
@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_energy_is_never_negative(form, seed) -> None:
    values = np.random.default_rng(seed).standard_normal(TORUS.n_vertices)
    assert values @ (form(TORUS).stiffness @ values) > 0


def test_triangles_without_area_call_for_the_intrinsic_delaunay_laplacian() -> None:
    operator = laplacian(needle_sphere())
    assert operator.kind == "intrinsic Delaunay"
    assert np.isfinite(operator.stiffness.data).all()
    assert operator.areas.min() > 0


def test_both_forms_agree_where_the_triangulation_is_delaunay() -> None:
    sphere = icosphere(radius=30.0, subdivisions=2)
    plain, robust = cotangent_laplacian(sphere), intrinsic_delaunay_laplacian(sphere)
    assert abs(plain.stiffness - robust.stiffness).max() < 1e-4
    assert np.abs(plain.areas - robust.areas).max() < 1e-3 * plain.areas.max()
