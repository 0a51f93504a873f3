"""Maps from files: right where samples are good, silent where they say nothing."""

import json
import math

import numpy as np
import pytest

from auricle.errors import InputError
from auricle.study.mapping import map_samples
from auricle.study.mapping_result import MappingConfig, MappingResult
from auricle.study.sampling_store import mapping_document
from auricle.surface.reading import read_surface

pytestmark = pytest.mark.usefixtures("solved_once")
SMALL = {"n_vertices": 700, "n_modes": 90}
N = 120


@pytest.fixture(scope="module")
def vertices(chamber_file) -> np.ndarray:
    return read_surface(chamber_file).vertices


@pytest.fixture
def places(vertices) -> np.ndarray:
    return vertices[np.random.default_rng(5).permutation(len(vertices))[:N]]


@pytest.fixture
def mapped(chamber_file, table):
    """Maps samples with parameters."""

    def run(positions, values, *further, **parameters) -> MappingResult:
        validate = parameters.pop("validate", False)
        config = MappingConfig(**SMALL, **parameters)
        samples = table(positions, values, *further)
        return map_samples(chamber_file, samples, config, validate=validate)

    return run


@pytest.fixture
def noisy(places, truth) -> np.ndarray:
    return truth(places) + np.random.default_rng(6).normal(0, 2.0, N)


def error(result, truth) -> np.ndarray:
    return result.mean - truth(result.prepared.surface.vertices)


def test_the_map_is_as_near_the_truth_as_it_says(mapped, places, noisy, truth):
    result = mapped(places, noisy, noise=2.0)
    off = error(result, truth)
    measured = off.std() / truth(result.prepared.surface.vertices).std()
    assert 0.5 * measured < result.predicted_nrmse < 2 * measured
    assert (np.abs(off) < 1.96 * result.std).mean() > 0.9
    assert result.noise_fitted == pytest.approx(2.0, rel=0.3)
    assert result.verdict.enough


def test_exact_samples_of_a_smooth_map_leave_next_to_no_error(mapped, places, truth):
    result = mapped(places, truth(places))
    assert np.abs(error(result, truth)).max() < 1.0
    assert result.predicted_nrmse < 0.03


def test_noise_that_nobody_states_counts_as_detail(mapped, places, noisy):
    """As `Reconstruction.std_with_detail`: variances add."""
    silent, stated = (mapped(places, noisy, noise=noise) for noise in (None, 50.0))
    assert silent.noise_stated is None
    assert silent.predicted_nrmse > 1.5 * silent.smooth_nrmse
    assert (silent.std > silent.noise_fitted).all()
    assert stated.predicted_nrmse == stated.smooth_nrmse
    none = mapped(places, noisy, noise=0.0)
    np.testing.assert_allclose(none.std, silent.std)
    assert none.noise_stated == 0.0


def test_noise_stated_by_sample_is_that_of_the_column(mapped, places, truth):
    """Sabotage: to ignore the column gives all samples a say and an error of several ms."""
    rng = np.random.default_rng(7)
    wild = np.arange(N) % 3 == 0
    deviations = np.where(wild, 40.0, 0.5)
    values = truth(places) + rng.normal(0, deviations)
    told = mapped(places, values, deviations, noise_column="sd")
    untold = mapped(places, values, deviations)
    rms = [float(np.sqrt(np.square(error(each, truth)).mean())) for each in (told, untold)]
    assert rms[0] < 1.5
    assert rms[0] < 0.3 * rms[1]
    assert told.noise_stated == pytest.approx(np.sqrt(np.square(deviations).mean()))


def test_samples_repeated_in_a_place_are_surer_by_the_root_of_their_number(mapped, places, noisy):
    fourfold = np.repeat(places, 4, axis=0)
    result = mapped(fourfold, np.repeat(noisy, 4), noise=2.0)
    assert len(result.placed) == N
    assert result.noise_stated == pytest.approx(1.0)


def test_an_offset_and_a_scale_of_the_values_are_those_of_the_map(mapped, places, noisy):
    base = mapped(places, noisy, noise=2.0)
    moved = mapped(places, 1000 + 3 * noisy, noise=6.0)
    np.testing.assert_allclose(moved.mean, 1000 + 3 * base.mean, rtol=1e-6)
    np.testing.assert_allclose(moved.std, 3 * base.std, rtol=1e-4)
    assert moved.predicted_nrmse == pytest.approx(base.predicted_nrmse, rel=1e-4)


def test_the_order_of_the_samples_does_not_change_the_map(mapped, places, noisy):
    order = np.random.default_rng(1).permutation(N)
    base, mixed = mapped(places, noisy), mapped(places[order], noisy[order])
    np.testing.assert_allclose(mixed.mean, base.mean, rtol=1e-6)
    assert mixed.predicted_nrmse == pytest.approx(base.predicted_nrmse, rel=1e-6)


def test_the_error_as_samples_came_ends_at_the_error_of_all(mapped, places, noisy):
    found = mapped(places, noisy, noise=2.0)
    assert found.progression.counts[-1] == N
    assert found.progression.predicted_nrmse[-1] == pytest.approx(found.predicted_nrmse, rel=1e-6)
    assert found.progression.predicted_nrmse[0] > 3 * found.predicted_nrmse


def test_each_next_point_lowers_the_predicted_error(mapped, places, noisy):
    found = mapped(places[:30], noisy[:30], n_next=6)
    errors = np.concatenate([[found.predicted_nrmse], found.next_nrmse])
    assert (np.diff(errors) < 0).all()
    there = np.array([point.position for point in found.next_points])
    gaps = np.linalg.norm(there[:, None] - places[None, :30], axis=2).min(axis=1)
    assert gaps.min() > 5


def test_next_points_keep_out_of_a_region_that_is_forbidden(mapped, places, noisy):
    found = mapped(places[:30], noisy[:30], n_next=8, forbid="left")
    assert max(point.position[0] for point in found.next_points) <= 0


def test_no_next_points_may_be_asked_for(mapped, places, noisy):
    assert mapped(places, noisy, n_next=0).next_points == ()


CYCLE = 200.0


@pytest.fixture
def winding(places) -> np.ndarray:
    """One turn round the z axis within a cycle: no seam but a singularity at each pole."""
    return CYCLE * np.arctan2(places[:, 1], places[:, 0]) / (2 * np.pi)


def circular(a, b):
    return (a - b + CYCLE / 2) % CYCLE - CYCLE / 2


def test_times_of_a_cycle_are_mapped_across_the_seam(mapped, places, winding):
    found = mapped(places, winding, cycle_length_ms=CYCLE)
    x, y, z = found.prepared.surface.vertices.T
    away = np.hypot(x, y) > 15
    off = circular(found.mean, CYCLE * np.arctan2(y, x) / (2 * np.pi))
    assert np.abs(off[away]).max() < 15
    assert (np.abs(z[found.singular]) > 20).all()
    assert np.abs(found.residuals).max() <= CYCLE / 2
    assert found.std.max() <= CYCLE / math.sqrt(12)


def test_whole_cycles_more_or_less_change_nothing(mapped, places, winding):
    base = mapped(places, winding, cycle_length_ms=CYCLE)
    more = winding + CYCLE * (np.arange(N) % 5 - 2)
    moved = mapped(places, more, cycle_length_ms=CYCLE)
    np.testing.assert_allclose(circular(moved.mean, base.mean), 0.0, atol=1e-5)
    np.testing.assert_allclose(moved.residuals, base.residuals, atol=1e-5)


def test_the_noise_of_times_of_a_cycle_is_in_ms(mapped, places, winding):
    noisy = winding + np.random.default_rng(8).normal(0, 4.0, N)
    found = mapped(places, noisy, cycle_length_ms=CYCLE, noise=4.0)
    assert found.noise_stated == pytest.approx(4.0)
    assert found.noise_fitted == pytest.approx(4.0, rel=0.4)


def test_residuals_are_what_the_others_do_not_foretell(mapped, places, truth):
    values = truth(places)
    values[17] += 30
    found = mapped(places, values)
    at = int(np.flatnonzero(found.placed.kept == 17)[0])
    assert found.residuals[at] == pytest.approx(30, abs=3)


def test_a_doubted_sample_inflates_neither_noise_nor_error(mapped, places, noisy):
    """Sabotage: the noise of all samples, the raised one included, is many times larger."""
    spoilt = noisy.copy()
    spoilt[[11, 60]] += 80
    plain = mapped(places, noisy)
    robust = mapped(places, spoilt, robust=True)
    assert set(robust.placed.kept[robust.doubted]) == {11, 60}
    assert robust.noise_fitted == pytest.approx(plain.noise_fitted, rel=0.3)
    assert robust.predicted_nrmse == pytest.approx(plain.predicted_nrmse, rel=0.3)
    assert robust.progression.predicted_nrmse[-1] == pytest.approx(robust.predicted_nrmse)
    assert "2 of 120 samples contradict" in robust.remarks[-1]


SILENT = {
    "one": (slice(1), slice(1), 1.0),
    "four": (slice(4), slice(4), 1.0),
    "all equal": (slice(N), slice(N), 0.0),
    "all in one place": ([0] * N, slice(N), 1.0),
}
"""Which places, which values, and how much these vary."""


@pytest.mark.parametrize("name", SILENT)
@pytest.mark.parametrize("cycle", [None, CYCLE])
def test_where_nothing_is_known_no_number_is_given(mapped, places, noisy, name, cycle):
    where, which, share = SILENT[name]
    values = share * noisy[which] + (1 - share) * 80.0
    result = mapped(places[where], values, cycle_length_ms=cycle, validate=True)
    assert result.knows_nothing
    assert not result.verdict.enough
    for values in (result.mean, result.std, result.residuals, result.next_nrmse):
        assert np.isnan(values).all()
    assert np.isinf(result.wavelengths).all()
    assert result.undersampled_share == pytest.approx(1.0)
    assert result.undersampled.all()
    document = mapping_document(result)
    text = json.dumps(document, allow_nan=False)
    assert "guess" not in text
    for key in ("predicted_nrmse", "predicted_nrmse_if_all_noise", "noise_fitted"):
        assert document[key] is None
    assert document["hyperparameters"] is None
    assert document["standardized_loo_variance"] is None
    assert document["bandwidth"] == document["progression"] == []
    assert document["cross_validation"] == {}
    assert len(document["next_points"]) == 5
    assert all(point["predicted_nrmse"] is None for point in document["next_points"])
    assert "nothing is known of the map" in result.remarks[-1]


def test_samples_that_mostly_lie_elsewhere_are_never_enough(mapped, places, truth):
    away = places + np.array([[70.0, 0.0, 0.0]])
    half = mapped(np.vstack([places, away]), np.tile(truth(places), 2))
    assert half.verdict.reasons == ()
    mostly = mapped(np.vstack([places, away, away]), np.tile(truth(places), 3))
    assert "67 % of the samples were left out" in mostly.verdict.reasons[0]


def test_missing_values_are_left_out_and_counted(mapped, places, noisy):
    holed = noisy.copy()
    holed[:7] = np.nan
    found = mapped(places, holed)
    assert len(found.placed) == N - 7
    assert "7 of 120 samples left out" in found.remarks[0]
    assert math.isfinite(found.predicted_nrmse)


def test_left_out_samples_are_foretold_by_every_method(mapped, places, noisy):
    found = mapped(places, noisy, validate=True)
    assert len(found.cross_validation) == 6
    ours = found.cross_validation["gaussian_process"]
    assert 1.5 < ours.rms < 4
    assert mapped(places, noisy).cross_validation == {}


def test_one_input_gives_one_document_whatever_time_it_took(mapped, places, noisy):
    first, second = (mapped(places, noisy, validate=True) for _ in range(2))
    texts = [json.dumps(mapping_document(each), allow_nan=False) for each in (first, second)]
    assert texts[0] == texts[1]
    assert first.seconds != second.seconds


@pytest.mark.parametrize(
    ("asked", "cause"),
    [
        ({"target_nrmse": 0.0}, "target error of 0.0"),
        ({"target_nrmse": math.nan}, "target error of nan"),
        ({"noise": -1.0}, "noise of -1.0"),
        ({"noise": math.inf}, "noise of inf"),
        ({"noise": 1.0, "noise_column": "sd"}, "given twice"),
        ({"cycle_length_ms": 0.0}, "cycle length of 0.0 ms"),
        ({"cycle_length_ms": math.nan}, "cycle length of nan ms"),
        ({"max_distance_mm": 0.0}, "distance of 0.0 mm"),
        ({"robust": True, "cycle_length_ms": 200.0}, "not fitted robustly"),
        ({"n_next": -1}, "-1 next points"),
    ],
)
def test_an_impossible_request_is_refused_before_any_work(asked, cause):
    with pytest.raises(InputError, match=cause):
        MappingConfig(**asked)


def test_a_region_that_is_not_there_is_told_before_the_harmonics(
    mapped, places, noisy, monkeypatch
):
    def solved(*_args, **_options):
        raise AssertionError("solved in vain")

    monkeypatch.setattr("auricle.study.preparation.cached_harmonics", solved)
    with pytest.raises(InputError, match="no field named 'veins'"):
        mapped(places, noisy, forbid="veins")
