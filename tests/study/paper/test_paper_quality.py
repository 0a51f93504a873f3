"""Errors of surfaces rebuilt from harmonics or thinned out, and how they decay."""

import numpy as np
import pytest

from auricle.study.paper.quality import (
    RANGES,
    decays,
    power_laws,
    quality_of_harmonics,
    quality_of_points,
)
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere
from auricle.surface.simplification import simplification_sequence


@pytest.fixture(scope="module")
def sphere():
    return icosphere(radius=30.0, subdivisions=4)


def curves_of(counts, errors):
    names = (
        "gd_from_original_mm",
        "gd_to_original_mm",
        "mse_mm2",
        "mse_nearest_from_original_mm2",
        "mse_nearest_to_original_mm2",
    )
    return {"counts": list(counts)} | {name: list(errors) for name in names}


def test_a_sphere_grown_by_a_millimetre_is_a_millimetre_off(sphere):
    grown = Mesh(sphere.vertices * 31 / 30, sphere.faces)
    found = quality_of_harmonics(sphere, {10: grown})
    assert found["counts"] == [10]
    assert found["gd_from_original_mm"][0] == pytest.approx(1.0, abs=0.06)
    assert found["gd_to_original_mm"][0] == pytest.approx(1.0, abs=0.06)
    assert found["mse_mm2"][0] == pytest.approx(1.0, abs=1e-9)
    assert found["hausdorff_mm"][0] == pytest.approx(1.0, abs=0.06)


def test_points_slid_along_the_surface_are_no_distance_but_an_error(sphere):
    angle = 0.05
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    found = quality_of_harmonics(sphere, {10: Mesh(sphere.vertices @ turn.T, sphere.faces)})
    assert found["gd_from_original_mm"][0] < 0.06
    assert found["mse_mm2"][0] == pytest.approx((30 * angle) ** 2 * 2 / 3, rel=0.01)


def test_the_error_of_fewer_points_is_their_spacing_and_not_the_surfaces(sphere):
    sequence = simplification_sequence(sphere)
    found = quality_of_points(sequence, (2, 50, 200, 800, 100_000))
    assert found["counts"] == [50, 200, 800]
    squares = np.array(found["mse_mm2"])
    # A lattice of N points on an area A leaves a mean squared distance of about 5/(18√3)·A/N.
    expected = 5 / (18 * np.sqrt(3)) * sphere.area / np.array([50, 200, 800])
    assert squares / expected == pytest.approx(1.0, abs=0.35)
    assert (np.array(found["gd_from_original_mm"]) < np.sqrt(squares)).all()


def test_an_exponential_has_the_same_tau_whatever_is_fitted():
    counts = (10, 15, 20, 30, 40, *range(50, 1001, 50))
    errors = 5.0 * np.exp(-np.array(counts) / 200.0)
    quality = {"mha": curves_of(counts, errors)}
    found = decays(quality, (10, *range(50, 1001, 50)))
    assert {each["range"] for each in found} == set(RANGES)
    assert [each["tau"] for each in found] == pytest.approx([200.0] * len(found), rel=1e-4)


def test_the_tau_of_a_power_follows_the_counts_it_is_fitted_to():
    counts = (10, 15, 20, 30, 40, *range(50, 1001, 50))
    quality = {"qslim": curves_of(counts, 100.0 / np.array(counts))}
    found = {
        each["range"]: each["tau"]
        for each in decays(quality, (10, *range(50, 1001, 50)))
        if each["error"] == "mse_mm2" and not each["with_floor"]
    }
    assert found["even"] < 0.5 * found["even from 50"] < 0.5 * found["even from 100"]
    (law,) = (each for each in power_laws(quality) if each["error"] == "mse_mm2")
    assert law["exponent"] == pytest.approx(-1.0)
    assert law["power_misfit"] < 1e-9 < 0.1 < law["exponential_misfit"]


def test_an_error_that_does_not_fall_has_no_tau_and_says_why():
    quality = {"mha": curves_of(range(10, 100, 10), np.linspace(1.0, 2.0, 9))}
    found = decays(quality, tuple(range(10, 100, 10)))
    assert all(each["tau"] is None and each["reason"] for each in found if not each["with_floor"])
