"""The paper's tables and claims over cohorts whose numbers are known."""

import copy

import numpy as np
import pytest

from auricle.errors import InputError
from auricle.study.paper.claims import Outcome, claims
from auricle.study.paper.tables import count_rows, decay_rows, headline_decays, taus

SIZES = {"small": 4.0, "medium": 8.0, "wide": 16.0}


def document(*, tau=(200.0, 180.0, 70.0, 400.0), counts=None, geometry=(250, 960), tail=0.5):
    """Values of a case as `run_case` has them, as far as tables and claims read them."""
    counts = counts or {"small": (200, 500), "medium": (100, 400), "wide": (20, 150)}
    errors = dict(
        zip([("mha", "GD"), ("qslim", "GD"), ("mha", "MSE"), ("qslim", "MSE")], tau, strict=True)
    )
    readings = {"GD": "gd_from_original_mm", "MSE": "mse_mm2"}
    decay = [
        {
            "method": method,
            "error": readings[error],
            "range": "even",
            "with_floor": False,
            "tau": value,
        }
        for (method, error), value in errors.items()
    ]
    share = tail ** np.arange(1000)
    features = [
        {
            "size": size,
            "sigma_mm": sigma,
            "n_foci": n_foci,
            "counts": {
                "0.85": [counts[size][0] // n_foci] * 2,
                "0.9": [counts[size][1] // n_foci] * 2,
            },
            "share_by_harmonic": (share / share.sum()).tolist(),
        }
        for size, sigma in SIZES.items()
        for n_foci in (1, 2, 3)
    ]
    return {
        "name": "made up",
        "parameters": {"shares": [0.85, 0.9]},
        "geometry": {
            "accumulated_share": np.linspace(0.5, 1.0, 1000).tolist(),
            "counts": {"0.85": geometry[0], "0.9": geometry[1]},
        },
        "quality": {"mha": {"counts": [250], "gd_from_original_mm": [0.2]}},
        "features": features,
        "decay": decay,
    }


def cohort(n=7, **changed):
    """Cases that scatter a little in their τ."""
    spread = np.random.default_rng(3).normal(1.0, 0.05, (n, 4))
    base = document(**changed)
    found = []
    for row in spread:
        each = copy.deepcopy(base)
        for record, factor in zip(each["decay"], row, strict=True):
            record["tau"] = None if record["tau"] is None else record["tau"] * factor
        found.append(each)
    return found


def outcome_of(documents, words):
    (found,) = (claim for claim in claims(documents) if words in claim.words)
    return found.outcome


def test_the_papers_own_numbers_give_ratios_of_one():
    rows = {(row.n_foci, row.size, row.share): row for row in count_rows(cohort())}
    assert rows[None, None, 0.85].printed == 250
    assert rows[None, None, 0.85].ratio == 1.0
    assert rows[1, "small", 0.9].printed == 531
    assert rows[1, "small", 0.9].ratio == pytest.approx(500 / 531)
    gd, mse = headline_decays(decay_rows(cohort()))
    assert (gd.error, mse.error) == ("GD", "MSE")
    assert gd.printed == ((211.2, 89.0), (173.8, 19.7))
    assert gd.ratios[0] == pytest.approx(200 / 211.2, rel=0.05)
    assert mse.ratios[1] == pytest.approx(400 / 392.6, rel=0.05)


def test_counts_beyond_the_band_are_not_taken_for_small_ones():
    short = document()
    for record in short["features"]:
        record["counts"]["0.9"] = [None, 30]
    row = next(each for each in count_rows([short, document()]) if each.share == 0.9 and each.size)
    assert row.n_beyond == 1
    assert row.high == np.inf
    assert row.low == 30
    assert row.median >= 500


def test_without_cases_there_is_no_table():
    with pytest.raises(InputError, match="no cases"):
        count_rows([])


def test_a_case_without_tau_is_left_out_of_both_methods():
    documents = cohort()
    documents[2]["decay"][0]["tau"] = None
    gd = headline_decays(decay_rows(documents))[0]
    assert gd.mha.n == gd.qslim.n == 6
    assert gd.n_without == 1
    assert taus(documents, "gd_from_original_mm", "even", with_floor=False)["mha"][2] is None


def test_two_cases_are_too_few_for_a_test():
    gd = headline_decays(decay_rows(cohort(2)))[0]
    assert gd.test is None
    assert gd.mha.n == 2
    assert outcome_of(cohort(2), "τ under GD") is Outcome.OPEN


def test_a_cohort_like_the_papers_confirms_what_it_says_of_tau():
    assert outcome_of(cohort(), "τ under GD") is Outcome.CONFIRMED
    assert outcome_of(cohort(), "under MSE τ") is Outcome.CONFIRMED


def test_a_cohort_unlike_the_papers_refutes_it():
    other = cohort(tau=(500.0, 100.0, 400.0, 70.0))
    assert outcome_of(other, "τ under GD") is Outcome.REFUTED
    assert outcome_of(other, "under MSE τ") is Outcome.REFUTED


def test_a_smaller_difference_under_mse_confirms_in_part():
    assert outcome_of(cohort(tau=(40.0, 40.0, 15.0, 26.0)), "under MSE τ") is Outcome.PARTLY


def test_order_and_direction_of_sizes_exclude_each_other():
    falling, rising = (
        cohort(),
        cohort(counts={"small": (20, 150), "medium": (100, 400), "wide": (200, 500)}),
    )
    assert outcome_of(falling, "small foci need more") is Outcome.CONFIRMED
    assert outcome_of(falling, "increased with the mechanism size") is Outcome.REFUTED
    assert outcome_of(rising, "small foci need more") is Outcome.REFUTED
    assert outcome_of(rising, "increased with the mechanism size") is Outcome.CONFIRMED


def test_numbers_of_foci_and_shares_are_told_apart():
    assert outcome_of(cohort(), "one focus needs more") is Outcome.CONFIRMED
    assert outcome_of(cohort(), "very different when considering") is Outcome.CONFIRMED
    close = cohort(counts={"small": (300, 360), "medium": (120, 150), "wide": (30, 36)})
    assert outcome_of(close, "very different when considering") is Outcome.REFUTED


def test_a_spectrum_that_is_level_is_not_low_pass():
    assert outcome_of(cohort(), "surrogate feature is concentrated") is Outcome.CONFIRMED
    assert outcome_of(cohort(tail=1.0), "surrogate feature is concentrated") is Outcome.REFUTED
    assert outcome_of(cohort(), "concentrated in the lower frequencies") is Outcome.REFUTED


def test_a_quarter_thousand_is_enough_only_where_it_holds_90_percent():
    assert outcome_of(cohort(), "about 250") is Outcome.REFUTED
    assert outcome_of(cohort(geometry=(4, 5)), "about 250") is Outcome.CONFIRMED
