"""Eigenpairs brought to rounding, also where vertices own next to no area."""

import numpy as np
import pytest
from scipy import sparse

from auricle.spectral.harmonics import LARGEST_RESIDUAL, manifold_harmonics
from auricle.spectral.refinement import corrected
from auricle.spectral.separation import Measure
from auricle.spectral.workers import Workers
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere, joined

WORKERS = Workers(2)


def graded() -> sparse.csc_array:
    """A chain's Laplacian, symmetrised by areas that differ a hundred thousand times."""
    n = 300
    areas = np.where(np.arange(n) % 37 < 3, 1e-5, 1.0)
    steps = sparse.diags_array([np.ones(n - 1), -np.ones(n - 1)], offsets=[1, 0], shape=(n - 1, n))
    roots = sparse.diags_array(1 / np.sqrt(areas))
    return sparse.csc_array(roots @ (steps.T @ steps) @ roots)


def test_noise_of_rounding_at_vertices_without_area_is_taken_out(rng) -> None:
    matrix = graded()
    truth, vectors = np.linalg.eigh(matrix.toarray())
    rows = vectors[:, :20].T + 1e-15 * rng.standard_normal((20, 300))
    separated, least = Measure.of(matrix, truth[20], WORKERS), truth[1]
    before = separated(rows, truth[:20])
    assert before.relative_residuals(least).max() > 2e-9
    rows = corrected(matrix, rows, before.values, least=least, workers=WORKERS).rows
    assert separated(rows, truth[:20]).relative_residuals(least).max() < 1e-9
    assert np.abs(rows @ rows.T - np.eye(len(rows))).max() < 1e-11


def test_what_is_good_already_is_returned_as_it_is() -> None:
    matrix = sparse.csc_array(sparse.diags_array(np.arange(1.0, 50.0)))
    given = np.eye(5, 49)
    found = corrected(matrix, given, np.arange(1.0, 6.0), least=1.0, workers=WORKERS)
    assert found.rows is given


def with_specks(mesh: Mesh, share: float) -> Mesh:
    """Every fiftieth face holds a vertex more, in a fan of three: with a tiny fan inside that."""
    vertices, faces = [*mesh.vertices], []
    for i, face in enumerate(mesh.faces):
        if i % 50:
            faces.append(face)
            continue
        centre, corners = mesh.vertices[face].mean(axis=0), mesh.vertices[face]
        a, b, c = face
        d, e, f = len(vertices), len(vertices) + 1, len(vertices) + 2
        vertices += [*(centre + share * (corners - centre))]
        faces += [(d, e, f), (a, b, e), (a, e, d), (b, c, f), (b, f, e), (c, a, d), (c, d, f)]
    return Mesh(np.array(vertices), np.array(faces))


@pytest.mark.parametrize("share", [1e-2, 1e-3])
def test_vertices_of_very_little_area_spoil_no_residual(share) -> None:
    basis = manifold_harmonics(with_specks(icosphere(radius=30.0, subdivisions=4), share), 60)
    assert basis.certificate.largest_residual < LARGEST_RESIDUAL


def test_eight_equal_spheres_have_every_eigenvalue_eight_times() -> None:
    sphere = icosphere(radius=30.0, subdivisions=3)
    spheres = joined([Mesh(sphere.vertices + 100.0 * i, sphere.faces) for i in range(8)])
    one = manifold_harmonics(sphere, 30).eigenvalues
    eight = manifold_harmonics(spheres, 8 * len(one))
    assert eight.certificate.n_zero_modes == 8
    np.testing.assert_allclose(
        eight.eigenvalues[: 8 * len(one)], np.repeat(one, 8), rtol=1e-9, atol=1e-12
    )


@pytest.mark.slow
def test_no_draw_of_mesh_count_and_seed_fails() -> None:
    """A hundred random surfaces: bumps, pieces, specks; solved and certified, every one."""
    rng = np.random.default_rng(7)
    for draw in range(100):
        sphere = icosphere(radius=30.0, subdivisions=int(rng.integers(3, 5)))
        waves = rng.uniform(0, 0.3) * np.sin(sphere.vertices @ rng.normal(0, 0.1, (3, 3)))
        mesh = Mesh(sphere.vertices * (1 + waves.mean(axis=1, keepdims=True)), sphere.faces)
        if draw % 3 == 1:
            mesh = joined([Mesh(mesh.vertices + 200.0 * i, mesh.faces) for i in range(3)])
        if draw % 4 == 2:
            mesh = with_specks(mesh, 10 ** rng.uniform(-3, -1))
        count = int(rng.integers(1, mesh.n_vertices // 4))
        found = manifold_harmonics(mesh, count, seed=int(rng.integers(1000)))
        assert found.certificate.eigenvalues_below_gap == found.n_modes >= count
