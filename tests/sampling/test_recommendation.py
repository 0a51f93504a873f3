"""Recommended numbers of samples: enough, no more than asked for, or a reason why not."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from auricle.errors import InputError
from auricle.sampling.bandwidth import class_tails
from auricle.sampling.baselines import BASELINES
from auricle.sampling.chamber import Chamber
from auricle.sampling.criteria import POINTS_PER_HARMONIC
from auricle.sampling.recommendation import (
    ACQUISITIONS,
    DENSEST_PER_CM2,
    Recommendation,
    recommendation,
)
from auricle.sampling.sites import Sites
from auricle.sampling.tails import Tails
from auricle.simulation.map_classes import MAP_CLASSES
from auricle.spectral.harmonics import Harmonics
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere


@pytest.fixture(scope="module")
def wide() -> Chamber:
    """A sphere of 10,242 vertices and 600 modes that are none: here only their number matters."""
    mesh = icosphere(radius=30.0, subdivisions=5)
    areas = np.full(mesh.n_vertices, mesh.area / mesh.n_vertices)
    modes = np.zeros((mesh.n_vertices, 600))
    basis = Harmonics(np.zeros(600), modes, areas, "none", None)
    return Chamber(mesh, basis, np.ones(mesh.n_vertices, dtype=bool))


def power_law(slope: float, n_modes: int = 600) -> Tails:
    return Tails(np.arange(1.0, n_modes + 1)[None] ** -slope, "a power law")


def asked(chamber: Chamber, slope: float = 2.0, **options) -> Recommendation:
    return recommendation(power_law(slope), chamber, **{"target_nrmse": 0.1, **options})


def test_without_noise_it_is_the_samples_of_the_harmonics_that_leave_the_error(wide):
    """Tail k^-2: (1 + α)·k^-2 ≤ ε² at k = √(1 + α)/ε."""
    for name, way in ACQUISITIONS.items():
        found = asked(wide, acquisition=name, target_nrmse=0.05)
        n_modes = math.ceil(math.sqrt(1 + way.aliasing) / 0.05)
        assert found.n_modes == n_modes
        assert found.n_samples == math.ceil(way.per_harmonic * n_modes)
        assert found.limited_by == "bandwidth"
        assert found.unreachable is None


def test_it_is_the_least_number_for_which_the_prediction_meets_the_target(wide):
    """By trying every number of samples and of harmonics."""
    way, tail = ACQUISITIONS["planned"], power_law(2.0).at(0.5)
    for noise in (0.05, 0.2, 0.5):
        found = asked(wide, noise_ratio=noise)
        k = np.arange(1, 601)

        def meets(n_samples: int, noise: float = noise, k: np.ndarray = k) -> bool:
            error = (1 + way.aliasing) * tail + noise**2 * way.noise_gain * k / n_samples
            return bool(((error <= 0.1**2) & (way.per_harmonic * k <= n_samples)).any())

        assert meets(found.n_samples)
        assert not meets(found.n_samples - 1)
        assert 0.09 < found.predicted_nrmse <= 0.1


@given(
    errors=st.tuples(st.floats(0.04, 0.9), st.floats(0.04, 0.9)),
    noises=st.tuples(st.floats(0.0, 0.3), st.floats(0.0, 0.3)),
    name=st.sampled_from(list(ACQUISITIONS)),
)
def test_a_smaller_error_or_more_noise_never_takes_fewer_samples(wide, errors, noises, name):
    def number(error: float, noise: float) -> float:
        found = asked(wide, target_nrmse=error, noise_ratio=noise, acquisition=name)
        return math.inf if found.n_samples is None else found.n_samples

    assert number(min(errors), noises[0]) >= number(max(errors), noises[0])
    assert number(errors[0], max(noises)) >= number(errors[0], min(noises))


@pytest.mark.parametrize("error", [0.05, 0.1, 0.3])
def test_it_is_never_less_than_the_factor_times_the_harmonics_of_the_share(wide, error):
    for name, factor in POINTS_PER_HARMONIC.items():
        found = asked(wide, target_nrmse=error, acquisition=name)
        n_modes = power_law(2.0).modes_for_power(1 - error**2)
        assert found.n_samples >= factor * n_modes


def test_unplanned_sampling_takes_more(wide):
    planned, unplanned = (asked(wide, acquisition=name) for name in ("planned", "unplanned"))
    assert unplanned.n_samples > 1.5 * planned.n_samples


def test_a_higher_quantile_of_maps_takes_more(wide):
    tails = Tails(np.stack([power_law(s).at(0.5) for s in (2.0, 1.7, 1.4)]), "three")
    median, most = (
        recommendation(tails, wide, target_nrmse=0.1, quantile=q).n_samples for q in (0.5, 0.9)
    )
    assert most > 1.3 * median


def test_noise_takes_over_when_there_is_much_of_it(wide):
    assert asked(wide, noise_ratio=0.5).limited_by == "noise"
    assert asked(wide, noise_ratio=0.01).limited_by == "bandwidth"


def test_scaling_the_chamber_leaves_the_number_and_scales_the_lengths(wide):
    basis = dataclasses.replace(wide.basis, areas=9 * wide.basis.areas)
    large = Chamber(Mesh(3 * wide.mesh.vertices, wide.mesh.faces), basis, wide.accessible)
    one, other = asked(wide), asked(large)
    assert one.n_samples == other.n_samples
    assert other.spacing_mm == pytest.approx(3 * one.spacing_mm)
    assert other.wavelength_mm == pytest.approx(3 * one.wavelength_mm)
    assert one.density_per_cm2 == pytest.approx(9 * other.density_per_cm2)


def test_only_the_accessible_part_takes_samples(wide):
    half = Chamber(wide.mesh, wide.basis, wide.mesh.vertices[:, 2] > 0)
    share = half.accessible_area / wide.accessible_area
    whole, part = asked(wide, noise_ratio=0.1), asked(half, noise_ratio=0.1)
    assert part.n_samples == pytest.approx(whole.n_samples * share, abs=1)
    assert part.density_per_cm2 == pytest.approx(whole.density_per_cm2, rel=0.02)


def test_a_jump_is_said_to_be_out_of_reach(wide):
    found = asked(wide, slope=0.5)
    assert found.n_samples is None
    assert "jumps (decay exponent 0.50" in found.unreachable
    assert "16.0 times the samples" in found.unreachable
    assert found.predicted_nrmse > 0.1


def test_noise_that_cannot_be_averaged_is_said_to_be(wide):
    found = asked(wide, noise_ratio=3.0)
    assert found.n_samples is None
    assert found.limited_by == "noise"
    assert "noise (300% of the map's deviation)" in found.unreachable


def test_what_more_harmonics_or_a_finer_mesh_would_reach_is_said(wide):
    few = dataclasses.replace(wide.basis, modes=wide.basis.modes[:, :60], eigenvalues=np.zeros(60))
    tails = power_law(1.5, 60)
    short = recommendation(tails, Chamber(wide.mesh, few, wide.accessible), target_nrmse=0.035)
    needed = ((1 + ACQUISITIONS["planned"].aliasing) / 0.035**2) ** (1 / 1.5)
    assert short.unreachable.startswith("60 harmonics leave 5% of error: solve for ")
    assert int(short.unreachable.split()[-1]) == pytest.approx(needed, rel=0.02)
    coarse = icosphere(radius=30.0, subdivisions=3)
    areas = np.full(coarse.n_vertices, coarse.area / coarse.n_vertices)
    basis = Harmonics(np.zeros(60), np.zeros((642, 60)), areas, "none", None)
    on_coarse = Chamber(coarse, basis, np.ones(642, dtype=bool))
    found = recommendation(tails, on_coarse, target_nrmse=0.035)
    assert "the mesh resolves no more: use one of 2000 vertices" in found.unreachable


def test_no_number_beyond_the_densest_mapping_is_recommended(wide):
    densities = [
        asked(wide, noise_ratio=noise).density_per_cm2 for noise in np.linspace(0, 1.5, 30)
    ]
    given = [density for density in densities if density is not None]
    assert max(given) <= DENSEST_PER_CM2 + 0.01
    assert len(given) < len(densities)


def test_existing_samples_count_once_for_each_place(wide):
    found = asked(wide, noise_ratio=0.1)
    n_samples = found.n_samples
    apart = wide.mesh.vertices[:3]
    assert found.points_for(np.empty((0, 3))) == n_samples
    assert found.points_for(apart) == n_samples - 3
    assert found.points_for(np.repeat(apart, 50, axis=0)) == n_samples - 3
    assert found.points_for(wide.mesh.vertices) == 0
    assert asked(wide, slope=0.5).points_for(apart) is None


def test_questions_without_sense_are_refused(wide):
    with pytest.raises(InputError, match="target error"):
        asked(wide, target_nrmse=1.0)
    with pytest.raises(InputError, match="noise ratio"):
        asked(wide, noise_ratio=-0.1)
    with pytest.raises(InputError, match="choose planned or unplanned"):
        asked(wide, acquisition="lucky")
    with pytest.raises(InputError, match="tails of 50 harmonics"):
        recommendation(power_law(2.0, 50), wide, target_nrmse=0.1)


MECHANISMS = ("activation", "macro_reentry", "rotor_pair")


def test_focal_maps_take_less_than_macro_and_these_less_than_localized_reentry(atrium_chamber):
    """The order of Williams et al. 2018."""
    rng = np.random.default_rng(1)
    densities = [
        recommendation(
            class_tails(atrium_chamber, MAP_CLASSES[name], n_draws=6, rng=rng),
            atrium_chamber,
            target_nrmse=0.2,
            acquisition="unplanned",
            quantile=0.5,
        ).density_per_cm2
        for name in MECHANISMS
    ]
    assert densities == sorted(densities)
    assert densities[2] > 2 * densities[0]


def test_random_samples_and_linear_interpolation_have_the_densities_of_the_literature(
    atrium_chamber,
):
    """Where the error falls to a quarter: 0.67, 1.05 and 1.23 per cm² in Williams et al. 2018."""
    rng = np.random.default_rng(1)
    counts = np.array([25, 50, 100, 200, 400])
    densities = []
    for name in MECHANISMS:
        errors = np.zeros(len(counts))
        for _ in range(3):
            kind = MAP_CLASSES[name]
            columns = kind.columns(kind.draw(atrium_chamber.mesh, rng))
            truth = columns.reshape(atrium_chamber.mesh.n_vertices, -1)
            order = rng.permutation(atrium_chamber.mesh.n_vertices)
            errors += [interpolation_error(atrium_chamber, truth, order[:n]) for n in counts]
        logarithm = np.interp(-np.log(0.25), -np.log(errors / 3), np.log(counts))
        densities.append(100 * np.exp(logarithm) / atrium_chamber.accessible_area)
    assert densities == sorted(densities)
    assert np.all(np.array(densities) / [0.67, 1.05, 1.23] < 2)
    assert np.all(np.array(densities) / [0.67, 1.05, 1.23] > 0.5)


def interpolation_error(chamber: Chamber, truth: np.ndarray, indices: np.ndarray) -> float:
    found = BASELINES["harmonic"](chamber, Sites.at_vertices(indices), truth[indices])
    squares = [
        [chamber.rms(column) ** 2 for column in each.T]
        for each in (found - truth, truth - chamber.accessible_areas @ truth / chamber.basis.area)
    ]
    return math.sqrt(sum(squares[0]) / sum(squares[1]))
