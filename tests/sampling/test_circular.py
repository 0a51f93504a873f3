"""Times on a cycle: no seam, no favoured phase, singularities marked, deviations right."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from auricle.arrays import Floats
from auricle.errors import InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.circular import CircularReconstruction, fit_circular
from auricle.sampling.cycle import circular_difference, wrapped
from auricle.sampling.gaussian_process import GaussianProcess, NoisePrior
from auricle.sampling.sites import Sites

CYCLE = 200.0


def reentry(chamber: Chamber) -> Floats:
    """One turn about the z axis a cycle, ms: singular at the poles."""
    vertices = chamber.mesh.vertices
    return np.asarray((np.arctan2(vertices[:, 1], vertices[:, 0]) / (2 * np.pi) * CYCLE) % CYCLE)


def away_from_poles(chamber: Chamber) -> Floats:
    return np.asarray(np.hypot(chamber.mesh.vertices[:, 0], chamber.mesh.vertices[:, 1]) > 12)


@pytest.fixture(scope="module")
def process(sphere_chamber: Chamber) -> GaussianProcess:
    chosen = np.random.default_rng(4).choice(642, 120, replace=False)
    return GaussianProcess(sphere_chamber, Sites.at_vertices(chosen))


@pytest.fixture(scope="module")
def times(process: GaussianProcess) -> Floats:
    exact = reentry(process.chamber)[process.sites.corners[:, 0]]
    return np.asarray(exact + 2.0 * np.random.default_rng(5).standard_normal(120))


@pytest.fixture(scope="module")
def fitted(process: GaussianProcess, times: Floats) -> CircularReconstruction:
    return fit_circular(process, times, CYCLE)


def rms_error(found: CircularReconstruction, truth: Floats, where: Floats) -> float:
    return float(np.sqrt((circular_difference(found.time, truth, CYCLE)[where] ** 2).mean()))


def test_a_reentry_is_rebuilt_without_a_seam(
    process: GaussianProcess, times: Floats, fitted: CircularReconstruction
) -> None:
    chamber = process.chamber
    truth, where = reentry(chamber), away_from_poles(chamber)
    error = rms_error(fitted, truth, where)
    scalar = process.fit(times).mean
    assert error < 3.0
    assert np.sqrt((circular_difference(scalar, truth, CYCLE)[where] ** 2).mean()) > 4 * error
    seam = where & (np.abs(circular_difference(truth, 0 * truth, CYCLE)) < 10)
    assert rms_error(fitted, truth, seam) < 1.5 * error + 0.5
    assert ((fitted.time >= 0) & (fitted.time < CYCLE)).all()


@settings(max_examples=10, deadline=None)
@given(phase=st.floats(-500, 500), turns=st.integers(0, 2**32 - 1))
def test_a_constant_phase_and_whole_cycles_change_nothing_else(
    process: GaussianProcess,
    times: Floats,
    fitted: CircularReconstruction,
    phase: float,
    turns: int,
) -> None:
    cycles = np.random.default_rng(turns).integers(-3, 4, len(times))
    moved = fit_circular(process, times + phase + CYCLE * cycles, CYCLE)
    clear = fitted.resultant > 0.05
    difference = circular_difference(moved.time, fitted.time + phase, CYCLE)
    assert np.abs(difference[clear]).max() < 0.02
    assert np.allclose(moved.resultant, fitted.resultant, atol=1e-4)
    assert np.allclose(moved.std, fitted.std, atol=0.02)


def test_the_poles_are_singular_and_little_else(
    process: GaussianProcess, fitted: CircularReconstruction
) -> None:
    vertices = process.chamber.mesh.vertices
    for pole in (vertices[:, 2].argmax(), vertices[:, 2].argmin()):
        assert fitted.singular[pole]
    off_axis = np.hypot(vertices[:, 0], vertices[:, 1])
    assert off_axis[fitted.singular].max() < 12


def test_deviations_cover_the_error(
    process: GaussianProcess, fitted: CircularReconstruction
) -> None:
    truth, where = reentry(process.chamber), away_from_poles(process.chamber)
    off = np.abs(circular_difference(fitted.time, truth, CYCLE))[where]
    assert 0.9 < (off < 1.96 * fitted.std[where]).mean() < 0.995


def test_the_deviation_is_that_of_directions_of_normal_vectors(
    fitted: CircularReconstruction, rng: np.random.Generator
) -> None:
    chosen = np.argsort(fitted.std)[[0, 300, 600, 635, -1]]
    for vertex in chosen.tolist():
        mean, spread = fitted.components.mean[vertex], fitted.components.std[vertex]
        drawn = mean + spread * rng.standard_normal((200_000, 2))
        resultant = np.abs(np.exp(1j * np.arctan2(drawn[:, 1], drawn[:, 0])).mean())
        expected = np.sqrt(-2 * np.log(resultant)) * CYCLE / (2 * np.pi)
        assert fitted.std[vertex] == pytest.approx(min(expected, CYCLE / np.sqrt(12)), rel=0.02)


def test_the_noise_of_times_is_found_and_can_be_stated(
    process: GaussianProcess, times: Floats, fitted: CircularReconstruction
) -> None:
    to_time = CYCLE / (2 * np.pi) * np.sqrt(2)
    assert 0.5 < fitted.components.hyperparameters.noise * to_time < 6.0
    stated = fit_circular(process, times, CYCLE, noise=2.0)
    assert stated.components.hyperparameters.noise * to_time == pytest.approx(2.0)
    firm = fit_circular(process, times, CYCLE, noise_prior=NoisePrior(8.0, 0.01))
    assert firm.components.hyperparameters.noise * to_time == pytest.approx(8.0, rel=0.05)


def test_one_time_is_known_nowhere_else(sphere_chamber: Chamber) -> None:
    found = fit_circular(
        GaussianProcess(sphere_chamber, Sites.at_vertices([0])), np.array([50.0]), CYCLE
    )
    assert found.components.knows_nothing
    assert np.allclose(found.time, 50.0)
    assert np.median(found.std) > 0.15 * CYCLE


def test_a_cycle_has_a_length(process: GaussianProcess, times: Floats) -> None:
    with pytest.raises(InputError, match="cycle length 0"):
        fit_circular(process, times, 0.0)


@given(time=st.floats(-1e4, 1e4), other=st.floats(-1e4, 1e4))
def test_differences_go_the_short_way_and_bring_one_home(time: float, other: float) -> None:
    times, others = np.array([time]), np.array([other])
    difference = circular_difference(times, others, CYCLE)
    assert -CYCLE / 2 <= difference[0] < CYCLE / 2
    home = circular_difference(others + difference, times, CYCLE)
    assert home[0] == pytest.approx(0.0, abs=1e-8)
    assert 0 <= wrapped(times, CYCLE)[0] < CYCLE
