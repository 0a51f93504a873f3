"""Decay exponents: the slopes that theory gives for known singularities."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from auricle.errors import BandError, InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.decay_exponent import DecayExponent, decay_exponent
from auricle.sampling.tails import truncation_tail
from auricle.simulation.foci import focal_map

AXES = [(0.0, 0.0, 1.0), (1.0, 0.3, 0.2), (-0.5, 0.7, 0.4)]


def exponent_of(chamber: Chamber, values: np.ndarray) -> DecayExponent:
    return decay_exponent(truncation_tail(chamber, values), chamber.mesh.n_vertices)


def heights(chamber: Chamber, axis: tuple[float, float, float]) -> np.ndarray:
    """Cosine of the angle to an axis."""
    return chamber.mesh.vertices @ np.array(axis) / np.linalg.norm(axis) / 30.0


@pytest.mark.parametrize("axis", AXES)
def test_a_jump_falls_with_one_half(fine_chamber, axis):
    found = exponent_of(fine_chamber, (heights(fine_chamber, axis) > 0).astype(float))
    assert found.slope == pytest.approx(0.5, abs=0.1)
    assert found.singularity == "jump"
    assert found.points_to_halve_the_error == pytest.approx(16, rel=0.5)


@pytest.mark.parametrize("axis", AXES)
def test_the_cone_of_a_focal_wave_falls_with_two(fine_chamber, axis):
    angle = np.arccos(np.clip(heights(fine_chamber, axis), -1, 1))
    found = exponent_of(fine_chamber, angle)
    assert found.slope == pytest.approx(2.0, abs=0.3)
    assert found.singularity == "cone"


@pytest.mark.parametrize("axis", AXES)
def test_a_phase_singularity_falls_with_one(fine_chamber, axis):
    across = np.linalg.svd(np.array([axis]))[2][1:]
    phase = np.arctan2(*(fine_chamber.mesh.vertices @ across.T).T)
    found = exponent_of(fine_chamber, np.column_stack([np.cos(phase), np.sin(phase)]))
    assert found.slope == pytest.approx(1.0, abs=0.2)
    assert found.singularity == "phase singularity"


def test_a_crease_falls_with_three_halves(fine_chamber):
    """|z| on a sphere has a crease along the equator."""
    slopes = [exponent_of(fine_chamber, np.abs(heights(fine_chamber, axis))).slope for axis in AXES]
    assert np.mean(slopes) == pytest.approx(1.5, abs=0.2)


@pytest.mark.parametrize("width", [5.0, 8.0])
def test_a_gaussian_focus_is_told_from_all_powers(fine_chamber, width):
    values = focal_map(fine_chamber.mesh, centres=[17], width=width).values
    assert exponent_of(fine_chamber, values).singularity == "smooth"


@given(slope=st.floats(0.5, 2.5), factor=st.floats(0.01, 1.0))
def test_a_power_law_has_its_own_exponent(slope, factor):
    tail = factor * np.arange(1.0, 600.0) ** -slope
    found = decay_exponent(tail, 100_000)
    assert found.slope == pytest.approx(slope, rel=1e-6)
    assert found.standard_error < 1e-6
    assert tail[found.first - 1] <= 0.1


def test_the_standard_error_is_at_least_the_scatter_and_not_many_times_it(rng):
    """Maps with independent random coefficients of power k^-5/2."""
    k = np.arange(1.0, 1000.0)
    slopes, errors = [], []
    for _ in range(100):
        power = k**-2.5 * rng.chisquare(1, size=len(k))
        power[-1] = k[-1] ** -1.5 / 1.5
        tail = np.cumsum(power[::-1])[::-1]
        found = decay_exponent(tail / tail[0], 100_000)
        slopes.append(found.slope)
        errors.append(found.standard_error)
    assert np.mean(slopes) == pytest.approx(1.5, abs=0.03)
    assert 1.0 < np.median(errors) / np.std(slopes) < 3.5


def test_harmonics_the_mesh_does_not_resolve_are_not_used():
    k = np.arange(1.0, 1000.0)
    bent = np.where(k <= 200, k**-1.0, 200.0 * k**-2.0)
    found = decay_exponent(bent, 2400)
    assert found.last == 200
    assert found.slope == pytest.approx(1.0, abs=1e-9)


def test_too_short_a_range_is_refused_with_the_reason():
    with pytest.raises(BandError, match="twice as many"):
        decay_exponent(np.full(500, 0.5), 100_000)
    with pytest.raises(InputError, match="tail"):
        decay_exponent(np.array([1.0, np.nan]), 100)
