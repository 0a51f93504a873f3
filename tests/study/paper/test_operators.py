"""Readings of Eq. 1: where they agree, and where they cannot."""

import numpy as np
import pytest

from auricle.spectral.harmonics import operator_harmonics
from auricle.spectral.laplacian import laplacian
from auricle.study.paper.operators import DUAL_CELLS, OPERATORS, operator_of, voronoi_areas
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import ellipsoid, icosphere
from auricle.surface.soundness import vertex_areas


def test_on_equal_cells_both_readings_are_the_same_matrix() -> None:
    # The icosahedron's vertices are all alike.
    mesh = icosphere(radius=10.0, subdivisions=0)
    printed, symmetrised = (operator_of(mesh, name, "third").matrix for name in OPERATORS)
    np.testing.assert_allclose(printed.toarray(), symmetrised.toarray(), atol=1e-15)


def test_the_more_uneven_the_mesh_the_further_the_readings_lie_apart() -> None:
    def apart(mesh: Mesh) -> float:
        printed, symmetrised = (
            np.linalg.eigvalsh(operator_of(mesh, name, "third").matrix.toarray())[1:4]
            for name in OPERATORS
        )
        return float(np.abs(printed / symmetrised - 1.0).max())

    # A sphere's three first modes to 0.05 %; an ellipsoid's, with cells that differ, to 25 %.
    assert apart(icosphere(radius=10.0, subdivisions=2)) < 0.001
    assert apart(ellipsoid(semi_axes=(4.0, 8.0, 24.0), subdivisions=2)) > 0.2


@pytest.mark.parametrize("cell", DUAL_CELLS)
def test_the_constant_is_a_mode_only_of_eq_1_as_printed(cell: str) -> None:
    mesh = ellipsoid(semi_axes=(10.0, 20.0, 30.0), subdivisions=3)
    printed, symmetrised = (operator_of(mesh, name, cell) for name in OPERATORS)
    one = np.ones(mesh.n_vertices)
    assert np.abs(printed.matrix @ one).max() < 1e-12
    assert np.abs(symmetrised.matrix @ one).max() > 1e-3
    assert np.abs(symmetrised.matrix @ np.sqrt(symmetrised.areas)).max() < 1e-12


def test_eq_1_as_printed_can_have_negative_eigenvalues_which_other_weights_mend() -> None:
    # A sphere drawn out at its poles: cells that shrink fast, between obtuse angles.
    mesh = icosphere(radius=10.0, subdivisions=2)
    vertices = mesh.vertices.copy()
    vertices[:, 2] = 10.0 * (vertices[:, 2] / 10.0) ** 3
    squeezed = Mesh(vertices, mesh.faces)
    assert laplacian(squeezed).kind == "cotangent"
    weights = laplacian(squeezed)
    scale = 1 / np.sqrt(weights.areas)
    letter = weights.stiffness.toarray() * np.outer(scale, scale)
    np.fill_diagonal(letter, 0.0)
    np.fill_diagonal(letter, -letter.sum(axis=1))
    values = np.linalg.eigvalsh(letter)
    assert values[0] < -0.01
    operator = operator_of(squeezed, "as_printed", "third")
    assert operator.n_negative == (values < -1e-6).sum()
    assert operator.pair.kind == "intrinsic Delaunay"
    mended = np.linalg.eigvalsh(operator.matrix.toarray())
    assert mended[0] == pytest.approx(0.0, abs=1e-10)
    assert mended[1] > 0.01
    assert operator_of(squeezed, "symmetrised", "third").pair.kind == "cotangent"
    assert operator_of(mesh, "as_printed", "third").n_negative == 0


def test_the_solver_takes_eq_1_as_printed_as_a_standard_eigenproblem() -> None:
    mesh = ellipsoid(semi_axes=(10.0, 20.0, 30.0), subdivisions=2)
    operator = operator_of(mesh, "as_printed", "third")
    found = operator_harmonics(operator.pair, 20)
    expected = np.linalg.eigvalsh(operator.matrix.toarray())[:20]
    np.testing.assert_allclose(found.eigenvalues, expected, atol=1e-10)


def test_voronoi_areas_fill_the_surface_and_equal_a_third_only_for_equilateral_triangles() -> None:
    uneven = ellipsoid(semi_axes=(4.0, 8.0, 24.0), subdivisions=3)
    assert voronoi_areas(uneven).sum() == pytest.approx(uneven.area, rel=1e-12)
    assert np.abs(voronoi_areas(uneven) / vertex_areas(uneven) - 1).max() > 0.05
    even = icosphere(radius=10.0, subdivisions=0)
    np.testing.assert_allclose(voronoi_areas(even), vertex_areas(even))


def test_the_voronoi_part_of_a_corner_is_what_lies_nearest_to_it() -> None:
    # All angles are acute; what is nearest is counted by sampling.
    corners = np.array([[0.0, 0, 0], [4, 0, 0], [1.5, 3, 0]])
    weights = np.random.default_rng(1).dirichlet(np.ones(3), size=40_000)
    nearest = np.linalg.norm((weights @ corners)[:, None] - corners, axis=2).argmin(axis=1)
    shares = np.bincount(nearest, minlength=3) / len(nearest)
    areas = voronoi_areas(Mesh(corners, [[0, 1, 2]]))
    np.testing.assert_allclose(areas / areas.sum(), shares, atol=0.01)
