import numpy as np
import pytest

from auricle.errors import InputError
from auricle.sampling.catheter import grid_catheter, planned_placements
from auricle.sampling.least_squares import least_squares
from auricle.sampling.plan import ExpectedMap, evaluated_plan, plan_samples, predicted_nrmse
from auricle.sampling.sites import Sites

DESIGNS = ["farthest", "pivoted_qr", "a_optimal", "d_optimal"]


@pytest.fixture(scope="session")
def activation(atrium_chamber):
    """Activation from two foci, and what is expected of it."""
    marching = atrium_chamber.marching
    truth = np.minimum(marching.from_source([100]), marching.from_source([1500]))
    tail = 1 - atrium_chamber.basis.power_spectrum(truth).cumulative()
    return truth, tail


@pytest.mark.parametrize("design", DESIGNS)
@pytest.mark.parametrize("noise", [0.0, 0.1])
def test_the_predicted_error_is_that_of_least_squares_within_a_third(
    atrium_chamber, activation, rng, design, noise
):
    truth, tail = activation
    plan = plan_samples(atrium_chamber, 100, ExpectedMap(tail, noise), design=design)
    deviation = atrium_chamber.rms(truth - atrium_chamber.mean(truth))
    errors = []
    for _ in range(3):
        samples = plan.sites.of(truth) + noise * deviation * rng.normal(size=100)
        rebuilt = least_squares(
            atrium_chamber, plan.sites, samples, n_modes=plan.n_modes, allow_unstable=True
        )
        errors.append(atrium_chamber.nrmse(rebuilt.values, truth))
    assert 0.75 < np.mean(errors) / plan.predicted_nrmse < 1.33
    assert np.mean(errors) < plan.bound.nrmse
    assert plan.n == 100


def test_more_points_and_less_noise_make_smaller_errors(atrium_chamber, activation):
    _, tail = activation
    by_count = [
        plan_samples(atrium_chamber, n, ExpectedMap(tail, 0.1)).predicted_nrmse
        for n in (25, 50, 100, 200)
    ]
    by_noise = [
        plan_samples(atrium_chamber, 100, ExpectedMap(tail, eta)) for eta in (0.4, 0.1, 0.0)
    ]
    assert (np.diff(by_count) < 0).all()
    assert (np.diff([plan.predicted_nrmse for plan in by_noise]) < 0).all()
    assert by_noise[0].n_modes < by_noise[-1].n_modes


@pytest.mark.parametrize("design", DESIGNS)
def test_a_planned_bandwidth_is_never_unstable_however_tempting(atrium_chamber, design):
    """All of the map lies in as many harmonics as there are points."""
    tail = np.where(np.arange(1, 151) < 40, 1.0, 0.0)
    plan = plan_samples(atrium_chamber, 40, ExpectedMap(tail), design=design)
    assert plan.stability.verdict != "unstable"
    assert plan.n_modes == plan.stability.n_modes < 40


def test_existing_points_come_first_and_the_plan_keeps_to_its_region(open_chamber):
    tail = np.linspace(1.0, 0.0, 100)
    allowed = open_chamber.mesh.vertices[:, 0] > 0
    existing = Sites(open_chamber.mesh.faces[300:303], np.tile([0.2, 0.3, 0.5], (3, 1)))
    for design in DESIGNS:
        plan = plan_samples(
            open_chamber,
            20,
            ExpectedMap(tail, 0.05),
            design=design,
            allowed=allowed,
            existing=existing,
        )
        assert plan.n == 23
        np.testing.assert_array_equal(plan.sites.weights[:3], existing.weights)
        np.testing.assert_array_equal(plan.sites.nearest_vertices[3:], plan.planned)
        assert (allowed & open_chamber.accessible)[plan.planned].all()


def test_a_single_point_promises_nothing(atrium_chamber, activation):
    plan = plan_samples(atrium_chamber, 1, ExpectedMap(activation[1]))
    assert plan.n_modes == 1
    assert plan.predicted_nrmse >= 1.0
    assert plan.bound.nrmse >= 1.0


def test_a_catheters_placements_are_judged_like_any_sites(atrium_chamber, activation):
    _, tail = activation
    placements = planned_placements(atrium_chamber, grid_catheter(), 6)
    clustered = evaluated_plan(
        atrium_chamber, placements.sites, ExpectedMap(tail), design="grid catheter"
    )
    spread = plan_samples(atrium_chamber, clustered.n, ExpectedMap(tail))
    assert clustered.predicted_nrmse > 1.5 * spread.predicted_nrmse
    assert clustered.coverage.radius_mm > 1.5 * spread.coverage.radius_mm
    assert not len(clustered.planned)


def test_the_prediction_is_its_formula(atrium_chamber, activation):
    _, tail = activation
    plan = plan_samples(atrium_chamber, 60, ExpectedMap(tail, 0.2))
    share = plan.stability.noise_gain * plan.n_modes / 60
    expected = tail[plan.n_modes - 1] * (1 + share) + 0.2**2 * share
    assert plan.predicted_nrmse == pytest.approx(np.sqrt(expected), rel=1e-12)
    assert predicted_nrmse(plan.stability, ExpectedMap(tail, 0.2)) == plan.predicted_nrmse


def test_a_prior_has_the_power_that_the_tail_expects(activation):
    expected = ExpectedMap(activation[1], 0.1)
    prior = expected.prior(area=50.0)
    held = expected.tail[0] - expected.tail[-1]
    assert prior.variances[1:].sum() == pytest.approx(50.0 * held, rel=1e-9)
    assert prior.noise == 0.1
    assert ExpectedMap(np.ones(1)).prior(area=50.0).variances.tolist() == [50.0]


@pytest.mark.parametrize(
    ("tail", "noise"),
    [([0.5, 0.6], 0.0), ([1.2, 0.1], 0.0), ([], 0.0), ([1.0, np.nan], 0.0), ([1.0], -0.1)],
)
def test_expectations_that_make_no_sense_are_refused(tail, noise):
    with pytest.raises(InputError, match=r"tail|noise"):
        ExpectedMap(np.array(tail), noise)


def test_a_design_without_a_name_is_refused(sphere_chamber):
    with pytest.raises(InputError, match="no design is called 'best'"):
        plan_samples(sphere_chamber, 10, ExpectedMap(np.linspace(1, 0, 50)), design="best")
