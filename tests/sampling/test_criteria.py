"""From counts to points: wavelengths, densities, what is beyond the band or the mesh."""

import math

import numpy as np
import pytest

from auricle.sampling.criteria import SHARES, Shell, criteria, lattice_spacing, need
from auricle.spectral.power import Spectrum
from auricle.spectral.weyl import nyquist_spacing, weyl_eigenvalue, weyl_wavelength

SHELL = Shell(area=12_500.0, accessible_area=10_000.0, n_vertices=1_200)


def test_weyl_counts_the_harmonics_of_a_flat_torus() -> None:
    """On a square of side L the modes with |κ| ≤ 2π/λ number about πL²/λ²."""
    side, wavelength = 100.0, 5.0
    m, n = np.meshgrid(np.arange(-60, 61), np.arange(-60, 61))
    count = int((np.hypot(m, n) / side <= 1 / wavelength).sum())
    assert weyl_wavelength(count, area=side**2) == pytest.approx(wavelength, rel=0.01)
    assert weyl_eigenvalue(count, area=side**2) == pytest.approx(
        (2 * math.pi / wavelength) ** 2, rel=0.02
    )


def test_spacing_is_half_the_wavelength() -> None:
    assert nyquist_spacing(77, area=9_000.0) == weyl_wavelength(77, area=9_000.0) / 2


def test_a_triangular_lattice_at_its_spacing_has_its_density() -> None:
    spacing = lattice_spacing(400, area=9_000.0)
    assert 400 * math.sqrt(3) / 2 * spacing**2 == pytest.approx(9_000.0)


def test_points_are_for_the_accessible_part_at_the_density_of_the_whole() -> None:
    found = need(50, SHELL)
    assert found.density_per_cm2 == pytest.approx(50 / 125)
    assert (found.n_least, found.n_planned, found.n_unplanned) == (40, 80, 140)


def test_counts_beyond_a_twelfth_of_the_vertices_are_not_trusted() -> None:
    assert need(100, SHELL).trusted
    assert not need(101, SHELL).trusted


def test_every_share_is_read_without_and_with_the_constant() -> None:
    power = np.r_[50.0, 0.5 ** np.arange(20)]
    spectrum = Spectrum(np.arange(21.0), power, power[1:].sum())
    found = criteria(spectrum, SHELL)
    assert [(c.share, c.with_constant) for c in found] == [
        *[(share, False) for share in SHARES],
        *[(share, True) for share in SHARES],
    ]
    assert [c.nrmse for c in found[:4]] == pytest.approx([0.387, 0.316, 0.224, 0.1], abs=1e-3)
    assert [c.need.n_modes for c in found[:4]] == [4, 5, 6, 8]


def test_a_share_beyond_the_band_needs_an_unknown_number() -> None:
    spectrum = Spectrum([0.0, 1.0, 2.0], [1.0, 5.0, 1.0], varying_total=9.0)
    assert all(c.need is None for c in criteria(spectrum, SHELL))
