"""Maps from samples: calibrated on draws from the prior, honest where nothing is known."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from auricle.arrays import Floats
from auricle.errors import InputError
from auricle.sampling.chamber import Chamber, chamber
from auricle.sampling.gaussian_process import GaussianProcess, NoisePrior, default_modes
from auricle.sampling.matern import matern_variances
from auricle.sampling.reconstruction import Hyperparameters, prior_variation
from auricle.sampling.sites import Sites
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere

LENGTH, AMPLITUDE, NOISE = 18.0, 5.0, 0.5
KNOWN = Hyperparameters(LENGTH, AMPLITUDE, NOISE)


def scattered(chamber: Chamber, n_samples: int, rng: np.random.Generator) -> Sites:
    faces = chamber.mesh.faces[rng.choice(chamber.mesh.n_faces, n_samples, replace=False)]
    return Sites(faces, rng.dirichlet([1, 1, 1], n_samples))


def from_prior(chamber: Chamber, rng: np.random.Generator, count: int) -> Floats:
    """Maps of the prior about 100, shape (n, count)."""
    variances = AMPLITUDE**2 * matern_variances(chamber.basis, length=LENGTH)
    coefficients = np.sqrt(variances)[:, None] * rng.standard_normal((len(variances), count))
    return 100 + chamber.basis.inverse(coefficients)


def activation(chamber: Chamber) -> Floats:
    """Times from a focus, ms."""
    return np.linalg.norm(chamber.mesh.vertices - chamber.mesh.vertices[5], axis=1)


def test_planned_error_is_achieved_and_intervals_cover_on_draws_from_the_prior(
    open_chamber: Chamber, rng: np.random.Generator
) -> None:
    sites = scattered(open_chamber, 60, rng)
    process = GaussianProcess(open_chamber, sites, n_modes=144)
    truths = from_prior(open_chamber, rng, 200)
    values = sites.of(truths) + NOISE * rng.standard_normal((60, 200))
    found = process.given(values, KNOWN)
    areas = open_chamber.accessible_areas
    squares = areas @ (found.mean - truths) ** 2
    variation = areas @ (truths - areas @ truths / areas.sum()) ** 2
    achieved = np.sqrt(squares.mean() / variation.mean())
    assert achieved == pytest.approx(found.planned_nrmse, rel=0.05)
    covered = np.abs(found.mean - truths) < 1.96 * found.std[:, None]
    assert 0.93 < (areas @ covered).mean() / areas.sum() < 0.97


def test_intervals_cover_when_everything_is_fitted(
    sphere_chamber: Chamber, rng: np.random.Generator
) -> None:
    covered, predicted, achieved = [], [], []
    for truth in from_prior(sphere_chamber, rng, 30).T:
        sites = scattered(sphere_chamber, 80, rng)
        values = sites.of(truth) + NOISE * rng.standard_normal(80)
        found = GaussianProcess(sphere_chamber, sites).fit(values)
        covered.append(np.abs(found.mean - truth) < 1.96 * found.std)
        predicted.append(found.predicted_nrmse**2)
        achieved.append(sphere_chamber.nrmse(found.mean, truth) ** 2)
    assert 0.92 < np.mean(covered) < 0.97
    assert np.sqrt(np.mean(predicted) / np.mean(achieved)) == pytest.approx(1.0, abs=0.1)


def test_hyperparameters_are_found_again(sphere_chamber: Chamber, rng: np.random.Generator) -> None:
    sites = scattered(sphere_chamber, 300, rng)
    truths = from_prior(sphere_chamber, rng, 8)
    values = sites.of(truths) + NOISE * rng.standard_normal((300, 8))
    found = GaussianProcess(sphere_chamber, sites, smoothness=1.5).fit(values).hyperparameters
    assert found.length == pytest.approx(LENGTH, rel=0.15)
    assert found.amplitude == pytest.approx(AMPLITUDE, rel=0.15)
    assert found.noise == pytest.approx(NOISE, rel=0.15)


def test_likelihood_is_that_of_the_differences_from_one_sample(
    sphere_chamber: Chamber, rng: np.random.Generator
) -> None:
    """Restricted likelihoods of two fits differ as those of N − 1 contrasts do."""
    sites = scattered(sphere_chamber, 12, rng)
    values = sites.of(activation(sphere_chamber))
    contrasts = np.linalg.qr(np.column_stack([np.ones(12), np.eye(12)[:, 1:]]))[0][:, 1:]
    process = GaussianProcess(sphere_chamber, sites, n_modes=144, smoothness=1.5)
    logs = []
    for noise in (0.2, 2.0):
        found = process.fit(values, noise=noise)
        known = found.hyperparameters
        assert known.noise == pytest.approx(noise, rel=1e-9)
        prior = found.posterior.prior_variances
        spread = (process.at_samples * prior) @ process.at_samples.T + noise**2 * np.eye(12)
        among = contrasts.T @ spread @ contrasts
        seen = contrasts.T @ values
        expected = -0.5 * (
            11 * np.log(2 * np.pi)
            + np.linalg.slogdet(among)[1]
            + seen @ np.linalg.solve(among, seen)
        )
        logs.append(found.log_marginal_likelihood - expected)
    assert logs[0] == pytest.approx(0.0, abs=1e-6)
    assert logs[1] == pytest.approx(0.0, abs=1e-6)


@settings(max_examples=15, deadline=None)
@given(scale=st.floats(0.01, 100), offset=st.floats(-200, 200))
def test_an_affine_change_of_the_values_changes_the_map_alike(
    sphere_chamber: Chamber, scale: float, offset: float
) -> None:
    sites = scattered(sphere_chamber, 40, np.random.default_rng(8))
    process = GaussianProcess(sphere_chamber, sites)
    values = sites.of(activation(sphere_chamber))
    before, after = process.fit(values), process.fit(scale * (values + offset))
    assert np.allclose(after.mean, scale * (before.mean + offset), atol=2e-3 * scale)
    assert np.allclose(after.std, scale * before.std, rtol=2e-3)


def test_a_larger_sphere_gives_the_same_map(sphere_chamber: Chamber) -> None:
    larger = chamber(icosphere(radius=90.0, subdivisions=3), 144)
    sites = scattered(sphere_chamber, 50, np.random.default_rng(9))
    values = sites.of(activation(sphere_chamber))
    small = GaussianProcess(sphere_chamber, sites).fit(values)
    large = GaussianProcess(larger, sites).fit(values)
    assert np.allclose(large.mean, small.mean, atol=1e-2)
    ratio = large.hyperparameters.length / small.hyperparameters.length
    assert ratio == pytest.approx(3.0, rel=1e-3)


def test_noise_collapses_neither_with_few_samples_nor_with_none_stated(
    sphere_chamber: Chamber, rng: np.random.Generator
) -> None:
    sites = scattered(sphere_chamber, 25, rng)
    values = sites.of(activation(sphere_chamber)) + rng.standard_normal(25)
    process = GaussianProcess(sphere_chamber, sites)
    assert process.fit(values).hyperparameters.noise > 0.01 * values.std()
    stated = process.fit(values, noise_prior=NoisePrior(3.0, 0.1)).hyperparameters.noise
    assert stated == pytest.approx(3.0, rel=0.3)


def test_samples_of_less_noise_count_more(sphere_chamber: Chamber) -> None:
    sites = Sites.at_vertices([10, 10, 200, 300, 400, 500])
    values = np.array([0.0, 4.0, 2.0, 3.0, 1.0, 2.0])
    shape = np.array([0.1, 1.0, 0.1, 0.1, 0.1, 0.1])
    found = GaussianProcess(sphere_chamber, sites, noise_shape=shape).fit(values, noise=1.0)
    assert found.mean[10] < 0.5


@pytest.mark.parametrize(
    "values",
    [
        pytest.param([120.0], id="one"),
        pytest.param([120.0, 121.0], id="two"),
        pytest.param([120.0] * 30, id="all equal"),
        pytest.param([0.0] * 30, id="all zero"),
    ],
)
def test_what_says_nothing_is_said_to_say_nothing(
    sphere_chamber: Chamber, rng: np.random.Generator, values: list[float]
) -> None:
    sites = scattered(sphere_chamber, len(values), rng)
    found = GaussianProcess(sphere_chamber, sites).fit(np.array(values))
    assert found.knows_nothing
    assert np.isfinite(found.mean).all()
    assert np.allclose(found.mean, np.mean(values), atol=1.0)
    assert found.std.min() > 0
    if len(values) < 3:
        assert found.predicted_nrmse > 0.8
        assert np.median(found.std) > 50


def test_samples_all_in_one_place_leave_the_rest_to_the_prior(
    sphere_chamber: Chamber, rng: np.random.Generator
) -> None:
    sites = Sites.at_vertices(np.full(20, 33))
    values = 120 + rng.standard_normal(20)
    found = GaussianProcess(sphere_chamber, sites).fit(values)
    assert found.knows_nothing
    assert found.std[33] < 2
    assert np.median(found.std) > 50
    assert np.isfinite(found.leave_one_out[0]).all()


def test_fewer_samples_than_modes_and_more_agree_where_they_meet(
    sphere_chamber: Chamber, rng: np.random.Generator
) -> None:
    """Both ways of conditioning, by samples and by modes, on all but the same problem."""
    sites = scattered(sphere_chamber, 41, rng)
    values = sites.of(activation(sphere_chamber))
    maps = [
        GaussianProcess(sphere_chamber, sites[np.arange(count)], n_modes=41).given(
            values[:count], KNOWN
        )
        for count in (40, 41)
    ]
    extra = Sites(sites.corners[40:], sites.weights[40:])
    surprise = values[40] - extra.of(maps[0].mean)[0]
    moved = extra.of(maps[1].mean - maps[0].mean)[0]
    here = maps[0].posterior.covariance.seen_by(extra.of(sphere_chamber.basis.modes[:, :41]))
    assert moved == pytest.approx(surprise * here[0] / (here[0] + NOISE**2), rel=1e-8)


def test_leave_one_out_is_standard_where_the_prior_is_true(
    sphere_chamber: Chamber, rng: np.random.Generator
) -> None:
    sites = scattered(sphere_chamber, 200, rng)
    truths = from_prior(sphere_chamber, rng, 6)
    values = sites.of(truths) + NOISE * rng.standard_normal((200, 6))
    found = GaussianProcess(sphere_chamber, sites, n_modes=144).given(values, KNOWN)
    assert found.standardized_variance == pytest.approx(1.0, abs=0.12)


def test_draws_pass_by_the_samples_and_spread_as_the_deviation_says(
    sphere_chamber: Chamber, rng: np.random.Generator
) -> None:
    sites = scattered(sphere_chamber, 50, rng)
    found = GaussianProcess(sphere_chamber, sites, n_modes=144).given(
        sites.of(activation(sphere_chamber)), KNOWN
    )
    drawn = found.draw(rng, 8_000)
    assert drawn.shape == (8_000, sphere_chamber.mesh.n_vertices)
    assert np.allclose(drawn.std(axis=0), found.std, rtol=0.1)
    assert np.allclose(drawn.mean(axis=0), found.mean, atol=0.2)


def test_detail_too_fine_for_the_samples_is_told_apart_from_known_noise(
    sphere_chamber: Chamber, rng: np.random.Generator
) -> None:
    """Truth with detail of deviation 2 at every vertex; samples with noise 1 besides."""
    smooth = from_prior(sphere_chamber, rng, 24)
    truths = smooth + 2.0 * rng.standard_normal(smooth.shape)
    chosen = rng.choice(sphere_chamber.mesh.n_vertices, 200, replace=False)
    values = truths[chosen] + rng.standard_normal((200, 24))
    found = GaussianProcess(sphere_chamber, Sites.at_vertices(chosen)).fit(values)
    off = np.abs(np.delete(found.mean - truths, chosen, axis=0))
    for std, least, most in (
        (found.std, 0.0, 0.85),
        (found.std_with_detail(noise=1.0), 0.93, 0.97),
        (found.std_with_detail(), 0.955, 0.985),
    ):
        assert least < (off < 1.96 * np.delete(std, chosen)[:, None]).mean() < most
    achieved = np.mean(
        [sphere_chamber.nrmse(*pair) for pair in zip(found.mean.T, truths.T, strict=True)]
    )
    assert found.predicted_nrmse_with_detail(noise=1.0) == pytest.approx(achieved, rel=0.1)
    assert found.predicted_nrmse_with_detail(noise=99.0) == found.predicted_nrmse


def test_one_wall_says_nothing_of_the_wall_behind_it(rng: np.random.Generator) -> None:
    """Two walls 6 mm apart: a peak of one must not show on the other."""
    ball = icosphere(radius=30.0, subdivisions=4)
    flat = chamber(Mesh(ball.vertices * [1.0, 1.0, 0.1], ball.faces), 200)
    vertices = flat.mesh.vertices
    upper = vertices[:, 2] > 0
    truth = np.where(upper, np.exp(-(vertices[:, 0] ** 2 + vertices[:, 1] ** 2) / (2 * 64)), 0)
    chosen = rng.choice(flat.mesh.n_vertices, 250, replace=False)
    found = GaussianProcess(flat, Sites.at_vertices(chosen)).fit(truth[chosen])
    middle = np.hypot(vertices[:, 0], vertices[:, 1]) < 8
    assert np.abs(found.mean[middle & ~upper]).max() < 0.05
    assert found.mean[middle & upper].max() > 0.85


def test_prior_variation_is_what_draws_have(
    open_chamber: Chamber, rng: np.random.Generator
) -> None:
    variances = AMPLITUDE**2 * matern_variances(open_chamber.basis, length=LENGTH)
    maps = from_prior(open_chamber, rng, 2_000)
    measured = np.mean([open_chamber.rms(each - open_chamber.mean(each)) ** 2 for each in maps.T])
    assert prior_variation(open_chamber, variances) == pytest.approx(measured, rel=0.05)


def test_the_number_of_modes_follows_the_samples_and_the_mesh(sphere_chamber: Chamber) -> None:
    assert default_modes(sphere_chamber, 10) == 144
    process = GaussianProcess(sphere_chamber, Sites.at_vertices([1, 2]), n_modes=30)
    assert process.at_samples.shape == (2, 30)


def test_a_mode_and_a_value_for_everything_or_a_clear_line(sphere_chamber: Chamber) -> None:
    two = Sites.at_vertices([1, 2])
    with pytest.raises(InputError, match="no sample"):
        GaussianProcess(sphere_chamber, Sites.at_vertices([]))
    with pytest.raises(InputError, match="1 harmonics cannot carry"):
        GaussianProcess(sphere_chamber, two, n_modes=1)
    with pytest.raises(InputError, match="one positive number a site"):
        GaussianProcess(sphere_chamber, two, noise_shape=np.array([1.0, 0.0]))
    process = GaussianProcess(sphere_chamber, two)
    with pytest.raises(InputError, match=r"values of shape \(3,\)"):
        process.fit(np.zeros(3))
    with pytest.raises(InputError, match="NaN or infinite"):
        process.fit(np.array([1.0, np.nan]))
    with pytest.raises(InputError, match="give 0 or a positive"):
        process.fit(np.array([1.0, 2.0]), noise=-1.0)
    with pytest.raises(InputError, match="give positive numbers"):
        process.fit(np.array([1.0, 2.0]), noise_prior=NoisePrior(0.0))
