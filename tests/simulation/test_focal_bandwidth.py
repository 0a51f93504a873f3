"""Focal maps need as many harmonics as the closed form says, wherever the surface lies."""

import numpy as np
import pytest

from auricle.simulation.foci import focal_map, gaussian_modes_for_power, random_foci
from auricle.spectral.harmonics import Harmonics, manifold_harmonics
from auricle.surface.cleaning import clean
from auricle.surface.mesh import Mesh
from auricle.surface.reading import read_surface
from auricle.surface.shapes import icosphere
from auricle.surface.simplification import simplify

SPHERE = icosphere(radius=30.0, subdivisions=4)


@pytest.fixture(scope="module")
def basis() -> Harmonics:
    return manifold_harmonics(SPHERE, 350)


def modes_for(basis: Harmonics, mesh: Mesh, centres, width: float, share: float) -> int:
    values = focal_map(mesh, centres=centres, width=width).values
    return basis.power_spectrum(values).modes_for_power(share)


@pytest.mark.parametrize("width", [4.0, 6.0])
@pytest.mark.parametrize("share", [0.85, 0.90, 0.95])
def test_the_measured_bandwidth_is_the_closed_form_on_a_sphere(basis, width, share) -> None:
    expected = gaussian_modes_for_power(area=SPHERE.area, width=width, share=share)
    assert modes_for(basis, SPHERE, [17], width, share) == pytest.approx(expected, rel=0.10)


def test_the_bandwidth_does_not_depend_on_the_number_of_separate_foci(basis, rng) -> None:
    foci = random_foci(SPHERE, count=3, separation=30.0, rng=rng)
    one = modes_for(basis, SPHERE, foci[:1], 5.0, 0.90)
    three = modes_for(basis, SPHERE, foci, 5.0, 0.90)
    assert three == pytest.approx(one, rel=0.12)


@pytest.mark.parametrize("shift", [250.0, -250.0])
def test_moving_the_surface_moves_no_count_by_more_than_one(shift) -> None:
    """On a shape without symmetry: in a cluster of equal eigenvalues the basis is arbitrary."""
    x, y, z = SPHERE.vertices.T / 30
    still = Mesh(SPHERE.vertices * (1 + 0.15 * x * y + 0.1 * z**3)[:, None], SPHERE.faces)
    moved = Mesh(still.vertices + shift * np.array([1.0, 0.5, -1.0]), still.faces)
    counts = []
    for mesh in (still, moved):
        basis = manifold_harmonics(mesh, 250)
        geometry = basis.power_spectrum(mesh.vertices)
        counts.append(
            [modes_for(basis, mesh, [17], width, 0.90) for width in (5.0, 8.0)]
            + [geometry.modes_for_power(share) for share in (0.9, 0.99, 0.9999)]
        )
    assert np.abs(np.subtract(*counts)).max() <= 1


@pytest.mark.slow
def test_the_measured_bandwidth_is_the_closed_form_on_a_real_atrium(real_data) -> None:
    mesh = clean(read_surface(real_data / "meshes/atlas/LASC2018_06SR5RB_LA_mri_closed.vtk")).mesh
    surface = simplify(mesh, 10_000)
    basis = manifold_harmonics(surface, 900)
    foci = random_foci(surface, count=6, separation=0.0, rng=np.random.default_rng(3))
    for width in (5.0, 8.0):
        counts = [modes_for(basis, surface, [each], width, 0.90) for each in foci]
        expected = gaussian_modes_for_power(area=surface.area, width=width, share=0.90)
        assert np.median(counts) == pytest.approx(expected, rel=0.15)


def test_the_energy_of_a_narrow_focus_is_that_of_a_flat_gaussian(basis) -> None:
    values = focal_map(SPHERE, centres=[17], width=4.0).values
    energy = (basis.areas * values**2).sum()
    assert energy == pytest.approx(np.pi * 4.0**2, rel=0.02)
