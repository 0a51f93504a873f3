"""Manifold harmonics: closed forms, rates, invariances, the transform."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import eigvals

from auricle.errors import InputError
from auricle.spectral.harmonics import Harmonics, manifold_harmonics
from auricle.spectral.laplacian import laplacian
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere, joined, rectangle, torus

RADIUS = 30.0


def sphere_eigenvalues(n_modes: int) -> np.ndarray:
    """l(l+1)/R², each 2l+1 times."""
    degrees = np.repeat(np.arange(40), 2 * np.arange(40) + 1)[:n_modes]
    return degrees * (degrees + 1) / RADIUS**2


def rectangle_eigenvalues(width: float, height: float, n_modes: int) -> np.ndarray:
    """π²(m²/a² + n²/b²): free boundaries."""
    m, n = np.meshgrid(np.arange(60), np.arange(60))
    values = np.pi**2 * (m**2 / width**2 + n**2 / height**2)
    return np.sort(values.ravel())[:n_modes]


def torus_eigenvalues(major: float, minor: float, n_modes: int) -> np.ndarray:
    """Separation of variables: a periodic Sturm-Liouville problem for each winding number.

    −((R + r cos v) f')' / (r² (R + r cos v)) + m² f / (R + r cos v)² = λ f, by Fourier collocation,
    whose error falls faster than any power.
    """
    n = 65
    angles = 2 * np.pi * np.arange(n) / n
    gaps = angles[:, None] - angles[None, :]
    signs = (-1.0) ** (np.arange(n)[:, None] - np.arange(n)[None, :])
    with np.errstate(divide="ignore"):
        derivative = np.where(np.eye(n), 0.0, 0.5 * signs / np.sin(gaps / 2 + np.eye(n)))
    width = major + minor * np.cos(angles)
    radial = -(derivative @ (width[:, None] * derivative)) / (minor**2 * width[:, None])
    found = []
    for winding in range(30):
        values = np.sort(eigvals(radial + np.diag(winding**2 / width**2)).real)
        found += [*values] if winding == 0 else [*values, *values]
    return np.sort(found)[:n_modes]


def observed_order(sizes: list[float], errors: list[float]) -> float:
    """Slope of log error against log edge length."""
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


def order_of(meshes: list[Mesh], truth: np.ndarray) -> float:
    sizes, errors = [], []
    for mesh in meshes:
        values = manifold_harmonics(mesh, len(truth)).eigenvalues[: len(truth)]
        sizes.append((mesh.area / mesh.n_faces) ** 0.5)
        errors.append(np.abs(values[1:] / truth[1:] - 1).mean())
    assert errors[-1] < 0.01
    return observed_order(sizes, errors)


def test_a_sphere_has_its_eigenvalues_with_their_multiplicity_at_second_order() -> None:
    meshes = [icosphere(radius=RADIUS, subdivisions=s) for s in (2, 3, 4)]
    assert order_of(meshes, sphere_eigenvalues(25)) == pytest.approx(2.0, abs=0.15)


def test_a_rectangle_has_free_boundaries_at_second_order() -> None:
    meshes = [rectangle(width=50.0, height=30.0, n_x=5 * m + 1, n_y=3 * m + 1) for m in (3, 6, 12)]
    assert order_of(meshes, rectangle_eigenvalues(50.0, 30.0, 20)) == pytest.approx(2.0, abs=0.15)


def test_a_torus_has_its_eigenvalues_at_second_order() -> None:
    meshes = [torus(major=30.0, minor=10.0, n_major=3 * m, n_minor=m) for m in (12, 20, 32)]
    assert order_of(meshes, torus_eigenvalues(30.0, 10.0, 21)) == pytest.approx(2.0, abs=0.15)


@pytest.fixture(scope="module")
def bumpy() -> Mesh:
    """A sphere without symmetry, large enough for the sliced solver."""
    sphere = icosphere(radius=RADIUS, subdivisions=4)
    x, y, z = sphere.vertices.T / RADIUS
    radii = 1 + 0.15 * x * y + 0.1 * np.sin(3 * z + x) + 0.08 * y**3
    return Mesh(sphere.vertices * radii[:, None], sphere.faces)


@pytest.fixture(scope="module")
def basis(bumpy: Mesh) -> Harmonics:
    return manifold_harmonics(bumpy, 60)


def rotation(seed: int) -> np.ndarray:
    q, r = np.linalg.qr(np.random.default_rng(seed).standard_normal((3, 3)))
    return q * np.sign(np.diag(r))


def renumbered(mesh: Mesh, seed: int) -> Mesh:
    order = np.random.default_rng(seed).permutation(mesh.n_vertices)
    return Mesh(mesh.vertices[order], np.argsort(order)[mesh.faces])


VARIANTS = {
    "moved 1e6 mm": lambda mesh: Mesh(mesh.vertices + 1e6, mesh.faces),
    "rotated": lambda mesh: Mesh(mesh.vertices @ rotation(3), mesh.faces),
    "renumbered": lambda mesh: renumbered(mesh, 4),
    "faces flipped": lambda mesh: Mesh(mesh.vertices, mesh.faces[:, ::-1]),
    "half of the faces flipped": lambda mesh: Mesh(
        mesh.vertices,
        np.where(np.arange(mesh.n_faces)[:, None] % 2, mesh.faces, mesh.faces[:, ::-1]),
    ),
}


@pytest.mark.parametrize("name", VARIANTS)
def test_eigenvalues_do_not_depend_on_place_or_numbering(name, bumpy, basis) -> None:
    moved = manifold_harmonics(VARIANTS[name](bumpy), 60)
    np.testing.assert_allclose(moved.eigenvalues[1:], basis.eigenvalues[1:], rtol=1e-6)


@pytest.mark.parametrize("scale", [1e-6, 0.1, 1e6])
def test_eigenvalues_fall_with_the_square_of_the_size(scale, bumpy, basis) -> None:
    scaled = manifold_harmonics(Mesh(scale * bumpy.vertices, bumpy.faces), 60)
    np.testing.assert_allclose(scaled.eigenvalues[1:] * scale**2, basis.eigenvalues[1:], rtol=1e-6)


def test_the_dense_and_the_sliced_solver_agree() -> None:
    sphere = icosphere(radius=RADIUS, subdivisions=4)
    few = manifold_harmonics(sphere, 100)
    many = manifold_harmonics(sphere, 700)
    assert {few.certificate.method, many.certificate.method} == {
        "dense LAPACK",
        "block Lanczos with spectrum slicing",
    }
    np.testing.assert_allclose(few.eigenvalues[1:], many.eigenvalues[1 : few.n_modes], rtol=1e-9)


def test_modes_are_orthonormal_under_the_vertex_areas(basis) -> None:
    gram = basis.modes.T @ (basis.areas[:, None] * basis.modes)
    assert np.abs(gram - np.eye(basis.n_modes)).max() < 1e-10


def test_the_certificate_tells_no_less_than_what_can_be_measured(bumpy) -> None:
    """Of so many modes most products are bounded by residuals and not measured."""
    found = manifold_harmonics(bumpy, 500)
    images = laplacian(bumpy).stiffness @ found.modes
    images -= found.eigenvalues * (found.areas[:, None] * found.modes)
    residuals = np.sqrt((images**2 / found.areas[:, None]).sum(axis=0))
    relative = residuals / np.maximum(found.eigenvalues, found.eigenvalues[1])
    gram = found.modes.T @ (found.areas[:, None] * found.modes)
    departure = np.abs(gram - np.eye(found.n_modes)).max()
    # To the rounding of measuring it twice.
    assert departure <= found.certificate.largest_orthogonality_error + 1e-14
    assert relative.max() <= 1.01 * found.certificate.largest_residual + 1e-13
    assert relative.max() > 0.5 * found.certificate.largest_residual


def test_transform_and_inverse_undo_each_other_in_the_band(basis, rng) -> None:
    coefficients = rng.standard_normal((basis.n_modes, 2))
    again = basis.transform(basis.inverse(coefficients))
    np.testing.assert_allclose(again, coefficients, atol=1e-10)


def test_parseval_the_total_power_is_the_area_integral_of_the_square(basis, rng) -> None:
    values = rng.standard_normal(len(basis.areas))
    spectrum = basis.power_spectrum(values)
    assert spectrum.total == pytest.approx((basis.areas * values**2).sum(), rel=1e-12)
    assert spectrum.cumulative()[-1] < 0.1  # white noise: sixty of 2562 modes hold little


def test_the_share_of_power_is_an_error_in_disguise(basis) -> None:
    """P(k) = 1 − nRMSE², exactly."""
    values = np.exp(-basis.modes[:, 3] * 50)
    spectrum = basis.power_spectrum(values)
    mean = np.average(values, weights=basis.areas)
    for count in (5, 20, 50):
        rebuilt = basis.inverse(basis.transform(values)[:count])
        squared = np.average((values - rebuilt) ** 2, weights=basis.areas)
        share = 1 - squared / np.average((values - mean) ** 2, weights=basis.areas)
        assert spectrum.cumulative()[count - 1] == pytest.approx(share, abs=1e-12)


@settings(max_examples=20, deadline=None)
@given(offset=st.floats(-1e6, 1e6), factor=st.floats(0.01, 100.0))
def test_an_offset_or_factor_does_not_change_how_many_modes_a_map_needs(
    basis, offset, factor
) -> None:
    values = np.exp(-basis.modes[:, 3] * 50)
    plain = basis.power_spectrum(values)
    changed = basis.power_spectrum(factor * values + offset)
    for share in (0.5, 0.9, 0.99):
        assert changed.modes_for_power(share) == plain.modes_for_power(share)


def test_a_cluster_of_equal_eigenvalues_is_returned_whole() -> None:
    spheres = joined(
        [Mesh(icosphere(radius=RADIUS, subdivisions=4).vertices + 100 * i, FACES) for i in range(2)]
    )
    found = manifold_harmonics(spheres, 3)
    assert found.n_modes == 8  # two constants, and three dipoles on each
    assert found.certificate.n_asked == 3
    assert found.certificate.eigenvalues_below_gap == 8
    assert found.certificate.n_zero_modes == 2


FACES = icosphere(radius=RADIUS, subdivisions=4).faces


def test_the_same_seed_gives_the_same_digits(bumpy, basis) -> None:
    again = manifold_harmonics(bumpy, 60)
    assert np.array_equal(again.modes, basis.modes)
    assert np.array_equal(again.eigenvalues, basis.eigenvalues)


@pytest.mark.parametrize("count", [0, -3, 162, 500])
def test_more_modes_than_the_mesh_has_or_none_are_refused(count) -> None:
    with pytest.raises(InputError, match="ask for 1 to 161"):
        manifold_harmonics(icosphere(radius=RADIUS, subdivisions=2), count)


def test_all_modes_but_one_are_certified() -> None:
    found = manifold_harmonics(icosphere(radius=RADIUS, subdivisions=2), 161)
    assert found.n_modes in (161, 162)
    assert found.certificate.eigenvalues_below_gap == found.n_modes


@pytest.mark.parametrize("n_modes", range(299, 306))
def test_a_cluster_at_the_very_end_of_what_was_found_is_certified(n_modes) -> None:
    """Three equal pieces have every eigenvalue three times; the last search ends within one."""
    ball = icosphere(radius=30.0, subdivisions=3)
    bumpy = Mesh(ball.vertices * (1 + 0.1 * np.sin(ball.vertices / 9.0)), ball.faces)
    three = joined([Mesh(bumpy.vertices + 200.0 * i, bumpy.faces) for i in range(3)])
    found = manifold_harmonics(three, n_modes)
    assert found.certificate.eigenvalues_below_gap == found.n_modes >= n_modes
    assert found.n_modes % 3 == 0
