"""Plans from a file: the number is the criterion's, the points are where they may be."""

import json
from pathlib import Path

import numpy as np
import pytest

from auricle.errors import InputError
from auricle.study.plan_result import CATHETERS, PlanConfig, PlanResult, checked_design
from auricle.study.planning import TARGETS, plan_surface
from auricle.study.sampling_store import plan_document
from auricle.surface.shapes import icosphere

SMALL = {"n_vertices": 700, "n_modes": 90}
pytestmark = pytest.mark.usefixtures("solved_once")
BAND = {**SMALL, "bandwidth": 20}


@pytest.fixture(scope="module")
def plain(chamber_file) -> PlanResult:
    return plan_surface(chamber_file, PlanConfig(**BAND))


def positions_file(path: Path, positions: np.ndarray) -> Path:
    np.savetxt(path, positions, delimiter=",", header="x,y,z", comments="")
    return path


def apart(points: np.ndarray, others: np.ndarray) -> float:
    return float(np.linalg.norm(points[:, None] - others[None], axis=2).min())


def test_a_map_of_k_harmonics_takes_two_points_a_harmonic(plain):
    """The criterion itself, on a closed surface without noise; three and a half if unplanned."""
    assert plain.recommendation.n_samples == 40
    assert len(plain.positions) == 40
    assert plain.plan.n == 40
    assert plain.by_target[0.1, "unplanned"].n_samples == 70


def test_a_map_within_the_band_is_rebuilt_without_error(plain):
    assert plain.plan.predicted_nrmse == pytest.approx(0.0, abs=1e-9)


def test_every_target_is_answered_both_ways(plain):
    assert set(plain.by_target) == {(t, how) for t in TARGETS for how in ("planned", "unplanned")}


def test_points_already_taken_lower_the_number_and_are_kept_away_from(
    chamber_file, plain, tmp_path
):
    taken = plain.positions[:15]
    result = plan_surface(
        chamber_file, PlanConfig(**BAND), existing=positions_file(tmp_path / "taken.csv", taken)
    )
    assert len(result.existing) == 15
    assert len(result.positions) == 25
    assert apart(result.positions, taken) > 0.5 * result.recommendation.spacing_mm
    document = plan_document(result)
    assert document["n_samples"] == document["n_existing"] + document["n_planned"] == 40


def test_points_asked_for_come_beside_those_taken(chamber_file, plain, tmp_path):
    file = positions_file(tmp_path / "taken.csv", plain.positions[:15])
    result = plan_surface(chamber_file, PlanConfig(**BAND, n_samples=7), existing=file)
    assert len(result.positions) == 7
    assert plan_document(result)["n_samples"] == 22
    assert result.recommendation.n_samples == 40


def test_enough_points_taken_need_no_more_and_are_judged(chamber_file, plain, tmp_path):
    file = positions_file(tmp_path / "taken.csv", plain.positions)
    result = plan_surface(chamber_file, PlanConfig(**BAND), existing=file)
    assert len(result.positions) == 0
    assert result.plan.n == 40
    assert result.plan.coverage.radius_mm == pytest.approx(plain.plan.coverage.radius_mm, rel=0.05)


def test_a_class_of_maps_is_drawn_and_shown(chamber_file):
    config = PlanConfig(
        map_class="gaussian", parameters={"width_mm": 14.0}, target_nrmse=0.2, **SMALL
    )
    result = plan_surface(chamber_file, config)
    assert result.tails.n_maps == 20
    assert result.wanted == "Gaussian foci of a standard deviation (width 14 mm, foci 1)"
    assert len(result.example.values) == 642
    assert len(result.positions) == result.recommendation.n_samples


def test_a_map_that_is_given_is_planned_for(chamber_file):
    """LAT is a polynomial of degree 2: nearly all its power lies in the first nine harmonics."""
    result = plan_surface(chamber_file, PlanConfig(field="LAT", **SMALL))
    assert result.recommendation.n_modes <= 20
    assert result.example.name == "LAT"


def test_a_period_makes_of_a_steep_map_a_richer_one(chamber_file):
    plain, wound = (
        plan_surface(
            chamber_file, PlanConfig(field="LAT", cycle_length_ms=cycle, target_nrmse=0.3, **SMALL)
        )
        for cycle in (None, 40.0)
    )
    assert wound.recommendation.n_samples > 2 * plain.recommendation.n_samples


def test_an_error_out_of_reach_is_said_and_nothing_is_planned(chamber_file):
    config = PlanConfig(map_class="disc", target_nrmse=0.02, **SMALL)
    result = plan_surface(chamber_file, config)
    assert result.recommendation.unreachable
    assert result.plan is None
    assert result.positions.shape == (0, 3)
    assert plan_document(result)["n_samples"] is None


def test_points_may_be_asked_for_beyond_reach(chamber_file):
    config = PlanConfig(map_class="disc", target_nrmse=0.02, n_samples=30, **SMALL)
    result = plan_surface(chamber_file, config)
    assert len(result.positions) == 30
    assert 0.02 < result.plan.predicted_nrmse < 1.2


@pytest.mark.parametrize("design", ["farthest", "pivoted_qr", "a_optimal", "d_optimal"])
def test_every_design_avoids_what_is_forbidden(chamber_file, design):
    config = PlanConfig(**BAND, n_samples=25, forbid="left", design=design)
    result = plan_surface(chamber_file, config)
    assert len(np.unique(result.positions, axis=0)) == 25
    assert result.positions[:, 0].max() <= 0
    assert "left is not 0" in result.remarks[-1]


@pytest.mark.parametrize("shape", CATHETERS)
def test_a_catheter_brings_as_many_electrodes_as_are_asked_for(chamber_file, shape):
    result = plan_surface(chamber_file, PlanConfig(**BAND, catheter=shape))
    placements = result.placements
    assert len(result.positions) >= 40
    n_electrodes = len(CATHETERS[shape]().offsets)
    assert len(placements.centres) * n_electrodes == len(result.positions) + placements.n_off
    assert np.array_equal(np.unique(placements.placement), np.arange(len(placements.centres)))


def test_a_grid_lies_on_the_surface_with_its_own_spacing(chamber_file):
    result = plan_surface(chamber_file, PlanConfig(**BAND, catheter="grid"))
    first = result.positions[result.placements.placement == 0]
    gaps = np.linalg.norm(first[:, None] - first[None], axis=2)
    nearest = np.sort(gaps, axis=1)[:, 1]
    np.testing.assert_allclose(nearest, 4.0, rtol=0.2)


def test_a_catheter_avoids_what_is_forbidden(chamber_file):
    config = PlanConfig(**BAND, n_samples=40, catheter="star", forbid="left")
    result = plan_surface(chamber_file, config)
    # Electrodes lie inside triangles, whose nearest vertex counts.
    assert result.positions[:, 0].max() < 4
    assert result.placements.n_off > 0


def test_the_same_input_gives_the_same_document_whatever_time_it_took(chamber_file, plain):
    again = plan_surface(chamber_file, PlanConfig(**BAND))
    texts = [json.dumps(plan_document(each), allow_nan=False) for each in (plain, again)]
    assert texts[0] == texts[1]
    assert again.seconds != plain.seconds


def test_planned_points_are_vertices_of_the_surface(plain):
    assert apart(plain.positions[:1], plain.prepared.surface.vertices) == 0
    assert len(plain.wavelengths) == plain.prepared.surface.n_vertices


@pytest.mark.parametrize(
    ("asked", "cause"),
    [
        ({}, "say what is to be mapped"),
        ({"field": "LAT", "bandwidth": 5}, "say what is to be mapped"),
        ({"map_class": "waves"}, "no class of maps 'waves'"),
        ({"map_class": "disc", "parameters": {"depth": 1.0}}, "disc has no parameter 'depth'"),
        ({"map_class": "disc", "parameters": {"radius_mm": -1.0}}, "positive"),
        ({"bandwidth": 5, "parameters": {"width_mm": 1.0}}, "belong to a class"),
        ({"bandwidth": 501}, "give 2 to 500"),
        ({"bandwidth": 5, "target_nrmse": 1.0}, "target error of 1.0"),
        ({"bandwidth": 5, "target_nrmse": float("nan")}, "target error of nan"),
        ({"bandwidth": 5, "noise_ratio": -0.1}, "noise of -0.1"),
        ({"bandwidth": 5, "n_samples": 0}, "at least 1"),
        ({"bandwidth": 5, "catheter": "lasso"}, "no catheter 'lasso'"),
        ({"bandwidth": 5, "cycle_length_ms": 200.0}, "belongs to a map that is given"),
        ({"field": "LAT", "cycle_length_ms": 0.0}, "cycle length of 0.0 ms"),
    ],
)
def test_an_impossible_request_is_refused_before_any_work(asked, cause):
    with pytest.raises(InputError, match=cause):
        PlanConfig(**asked)


def test_an_unknown_design_is_refused():
    assert checked_design("farthest") == "farthest"
    with pytest.raises(InputError, match="no design 'spiral'"):
        checked_design("spiral")


@pytest.mark.parametrize(
    ("asked", "cause"),
    [
        ({"field": "voltage"}, "no field named 'voltage': the surface has LAT, direction"),
        ({"field": "direction"}, "is a vector"),
        ({"bandwidth": 5, "forbid": "veins"}, "no field named 'veins'"),
    ],
)
def test_a_field_that_is_missing_is_told_before_the_harmonics_are_solved(
    chamber_file, monkeypatch, asked, cause
):
    def solved(*_args, **_options):
        raise AssertionError("solved in vain")

    monkeypatch.setattr("auricle.study.preparation.cached_harmonics", solved)
    with pytest.raises(InputError, match=cause):
        plan_surface(chamber_file, PlanConfig(**asked, **SMALL))


def test_a_region_without_any_place_left_is_refused(chamber_file):
    with pytest.raises(InputError, match="forbids all of the surface"):
        plan_surface(chamber_file, PlanConfig(**BAND, forbid="everywhere"))


def test_positions_elsewhere_are_refused_by_their_files_name(chamber_file, tmp_path):
    far = positions_file(
        tmp_path / "far.csv", 1000 * icosphere(radius=1.0, subdivisions=1).vertices
    )
    with pytest.raises(InputError, match=r"far\.csv: all .* more than 5 mm off"):
        plan_surface(chamber_file, PlanConfig(**BAND), existing=far)
