"""A session that takes samples as they come is a refit with all of them, at every step."""

import numpy as np
import pytest

from auricle.errors import InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.gaussian_process import GaussianProcess
from auricle.sampling.live import SMOOTHNESS, Session
from auricle.sampling.locator import Locator
from auricle.sampling.posterior import Posterior
from auricle.sampling.reconstruction import Hyperparameters, Reconstruction
from auricle.sampling.running_posterior import RunningPosterior
from auricle.sampling.sites import Sites

KNOWN = Hyperparameters(length=20.0, amplitude=30.0, noise=2.0)


def time_at(position: np.ndarray) -> float:
    return 100 + float(np.linalg.norm(position - np.array([0.0, 30.0, 0.0])))


def run(
    chamber: Chamber, n_samples: int, hyperparameters: Hyperparameters | None = KNOWN
) -> Session:
    rng = np.random.default_rng(11)
    session = Session(chamber, hyperparameters=hyperparameters)
    while session.n_samples < n_samples:
        face = chamber.mesh.faces[rng.integers(chamber.mesh.n_faces)]
        if chamber.accessible[face].all():
            position = rng.dirichlet([1, 1, 1]) @ chamber.mesh.vertices[face]
            session.add(position * 1.02, time_at(position) + 2 * rng.standard_normal())
    return session


def refit(session: Session) -> Reconstruction:
    process = GaussianProcess(session.chamber, session.sites, n_modes=session.n_modes)
    return process.given(session.values, session.hyperparameters)


def assert_is_the_refit(session: Session) -> None:
    expected = refit(session)
    running = session.running
    assert np.allclose(session.mean, expected.mean, rtol=1e-8)
    assert np.allclose(session.std, expected.std, rtol=1e-8)
    assert np.allclose(running.coefficients, expected.coefficient_mean, rtol=1e-8, atol=1e-6)
    covariance = expected.posterior.covariance.matrix
    assert np.allclose(running.covariance, covariance, rtol=0, atol=1e-8 * covariance.max())
    modes = session.chamber.basis.modes[:, : session.n_modes]
    gram = modes.T @ (session.chamber.accessible_areas[:, None] * modes)
    seen = modes @ covariance
    reach = np.einsum("nk,kl,nl->n", seen, gram, seen)
    assert np.allclose(running.reach, reach, rtol=1e-8, atol=1e-8 * reach.mean())
    assert running.predicted_nrmse == pytest.approx(expected.predicted_nrmse, rel=1e-8)


@pytest.mark.parametrize("hyperparameters", [KNOWN, None])
@pytest.mark.parametrize("n_samples", [1, 7, 73, 200])
def test_every_state_is_that_of_a_refit(
    open_chamber: Chamber, n_samples: int, hyperparameters: Hyperparameters | None
) -> None:
    assert_is_the_refit(run(open_chamber, n_samples, hyperparameters))


def test_the_worth_of_vertices_stays_exact_when_it_has_fallen_far(open_chamber: Chamber) -> None:
    assert_is_the_refit(run(open_chamber, 300, Hyperparameters(20.0, 30.0, 0.3)))


@pytest.mark.parametrize("hyperparameters", [KNOWN, None])
def test_many_at_once_give_the_state_of_one_by_one(
    open_chamber: Chamber, hyperparameters: Hyperparameters | None
) -> None:
    slow = run(open_chamber, 40, hyperparameters)
    quick = Session(open_chamber, hyperparameters=hyperparameters)
    quick.add_all(slow.sites, slow.values)
    assert_is_the_refit(quick)
    assert quick.hyperparameters == slow.hyperparameters
    assert np.allclose(quick.mean, slow.mean, rtol=1e-8)
    assert quick.predicted_errors[-1] == pytest.approx(slow.predicted_errors[-1], rel=1e-8)
    quick.undo()
    slow.undo()
    assert np.allclose(quick.mean, slow.mean, rtol=1e-8)


def test_many_at_once_are_refused_whole(open_chamber: Chamber) -> None:
    session = run(open_chamber, 6)
    before = session.mean.copy()
    with pytest.raises(InputError, match="a number for each"):
        session.add_all(session.sites, np.full(6, np.nan))
    cap = np.flatnonzero(~open_chamber.accessible)[:1]
    with pytest.raises(InputError, match="over a cap"):
        session.add_all(Sites.at_vertices(cap), np.zeros(1))
    session.add_all(Sites.at_vertices([]), np.empty(0))
    assert session.n_samples == 6
    assert np.array_equal(session.mean, before)


def test_undo_gives_the_state_before(open_chamber: Chamber) -> None:
    session = run(open_chamber, 30)
    before = session.mean.copy(), session.predicted_errors[:]
    session.add(np.array([30.0, 0.0, 0.0]), 1e4)
    assert np.abs(session.mean - before[0]).max() > 1e3
    session.undo()
    assert np.allclose(session.mean, before[0], rtol=1e-12)
    assert session.predicted_errors == before[1]
    assert_is_the_refit(session)


def test_undo_goes_back_beyond_what_is_remembered_and_to_the_start(open_chamber: Chamber) -> None:
    session = run(open_chamber, 41)
    for left in range(40, 0, -1):
        session.undo()
        assert session.n_samples == left
    assert_is_the_refit(session)
    session.undo()
    with pytest.raises(InputError, match="no sample to take back"):
        session.undo()
    with pytest.raises(InputError, match="no sample yet"):
        session.mean  # noqa: B018


def test_hyperparameters_are_fitted_when_samples_double_or_on_request(
    sphere_chamber: Chamber,
) -> None:
    session = run(sphere_chamber, 0, None)
    fitted = []
    rng = np.random.default_rng(2)
    for index in range(1, 42):
        before = session.hyperparameters if index > 1 else None
        vertex = rng.integers(sphere_chamber.mesh.n_vertices)
        position = sphere_chamber.mesh.vertices[vertex]
        session.add(position, time_at(position) + rng.standard_normal())
        if session.hyperparameters is not before:
            fitted.append(index)
    assert fitted == [1, 5, 10, 20, 40]
    assert not session.knows_nothing
    session.refit()
    process = GaussianProcess(
        sphere_chamber, session.sites, n_modes=session.n_modes, smoothness=SMOOTHNESS
    )
    assert session.hyperparameters == process.fit(session.values).hyperparameters


def test_the_promised_drop_is_the_drop(open_chamber: Chamber) -> None:
    """Score of a vertex against conditioning with a sample there, for several vertices."""
    session = run(open_chamber, 25)
    drops = session.running.expected_drop(KNOWN.noise**2)
    before = session.running.mean_square_error
    for vertex in (0, 77, 300, 641):
        sites = Sites(
            np.vstack([session.sites.corners, [[vertex] * 3]]),
            np.vstack([session.sites.weights, [[1.0, 0.0, 0.0]]]),
        )
        after = GaussianProcess(open_chamber, sites, n_modes=session.n_modes).posterior(KNOWN)
        variance = after.covariance.seen_by(open_chamber.basis.modes[:, : session.n_modes])
        assert before - open_chamber.mean(variance) == pytest.approx(drops[vertex], rel=1e-8)


def test_error_predicted_on_the_way_falls_to_what_it_is(sphere_chamber: Chamber) -> None:
    session = run(sphere_chamber, 160, None)
    truth = np.array([time_at(vertex) for vertex in sphere_chamber.mesh.vertices])
    assert len(session.predicted_errors) == 160
    assert session.predicted_errors[-1] < 0.3 * session.predicted_errors[9]
    actual = sphere_chamber.nrmse(session.mean, truth)
    assert 0.5 < actual / session.predicted_errors[-1] < 2.0
    fall = session.predicted_errors[149] - session.predicted_errors[159]
    assert session.recent_change(10) == fall
    assert np.isnan(session.recent_change(160))


@pytest.mark.parametrize(
    ("position", "value", "cause"),
    [
        ([0.0, 0.0, -80.0], 1.0, "50.. mm off the surface"),
        ([0.0, 0.0, 30.0], 1.0, "over a cap"),
        ([0.0, np.nan, 0.0], 1.0, "three finite numbers"),
        ([0.0, 0.0], 1.0, "three finite numbers"),
        ([30.0, 0.0, 0.0], np.nan, "a number"),
    ],
)
def test_a_sample_that_cannot_be_leaves_the_session_as_it_was(
    open_chamber: Chamber, position: list[float], value: float, cause: str
) -> None:
    session = run(open_chamber, 12)
    before = session.mean.copy()
    with pytest.raises(InputError, match=cause):
        session.add(np.array(position), value)
    assert session.n_samples == 12
    assert np.array_equal(session.mean, before)


def test_a_running_posterior_and_its_copy_go_their_own_ways(open_chamber: Chamber) -> None:
    session = run(open_chamber, 12)
    before = session.running.covariance.copy(), session.mean.copy()
    other = session.running.copy()
    other.absorb(open_chamber.basis.modes[5, : session.n_modes], 1e3, 1.0)
    assert np.array_equal(session.running.covariance, before[0])
    assert np.array_equal(session.mean, before[1])
    assert not session.running.copy().take_back()


def test_a_running_posterior_starts_where_the_posterior_is(open_chamber: Chamber) -> None:
    session = run(open_chamber, 9)
    posterior = refit(session).posterior
    assert isinstance(posterior, Posterior)
    begun = RunningPosterior.of(open_chamber, session.running.gram, posterior, session.values)
    assert np.allclose(begun.mean, session.mean, rtol=1e-9)


def test_the_locator_finds_what_a_search_of_all_triangles_finds(
    sphere_chamber: Chamber, rng: np.random.Generator
) -> None:
    mesh = sphere_chamber.mesh
    points = rng.normal(size=(60, 3)) * 25
    expected, distances = Sites.nearest(mesh, points)
    locator = Locator(mesh)
    for index, point in enumerate(points):
        site, distance = locator.nearest(point)
        assert distance == pytest.approx(distances[index], rel=1e-12)
        assert np.allclose(site.positions(mesh)[0], expected.positions(mesh)[index], atol=1e-9)
