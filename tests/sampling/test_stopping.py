"""When sampling may stop, and what is said when it may not."""

import math
from dataclasses import replace

import pytest

from auricle.sampling.bandwidth import Bracket
from auricle.sampling.stopping import (
    LARGEST_CLOSING,
    LARGEST_LEFT_OUT_SHARE,
    LARGEST_LOO_VARIANCE,
    LARGEST_UNDERSAMPLED_SHARE,
    Evidence,
    verdict,
)

ENOUGH = Evidence(
    n_samples=200,
    knows_nothing=False,
    target_nrmse=0.1,
    predicted_nrmse=0.1,
    bracket=Bracket(0.99, 40, 60),
    undersampled_share=LARGEST_UNDERSAMPLED_SHARE,
    loo_variance=LARGEST_LOO_VARIANCE,
    left_out_share=LARGEST_LEFT_OUT_SHARE,
)
"""Every piece of evidence at its limit: still enough."""

AGAINST = {
    "predicted error": {"predicted_nrmse": 0.1001},
    "not a number": {"predicted_nrmse": math.nan},
    "bandwidth is not yet known": {"bracket": Bracket(0.99, 40, 61)},
    "beyond the harmonics": {"bracket": None},
    "too sparsely": {"undersampled_share": 0.101},
    "differ from what their neighbours predict": {"loo_variance": 1.51},
    "left out": {"left_out_share": 0.51},
}


def test_evidence_at_its_limits_is_enough():
    assert ENOUGH.bracket.closing == LARGEST_CLOSING
    assert verdict(ENOUGH).enough
    assert verdict(ENOUGH).reasons == ()


@pytest.mark.parametrize("name", AGAINST)
def test_each_piece_of_evidence_speaks_against_by_itself(name):
    found = verdict(replace(ENOUGH, **AGAINST[name]))
    assert not found.enough
    (reason,) = found.reasons
    assert name in reason or name == "not a number"


def test_unknown_residuals_alone_do_not_speak_against():
    assert verdict(replace(ENOUGH, loo_variance=math.nan)).enough


@pytest.mark.parametrize("count", [1, 7])
def test_where_nothing_is_known_no_number_is_quoted(count):
    """However good the numbers look: they are guesses."""
    perfect = replace(
        ENOUGH, n_samples=count, knows_nothing=True, predicted_nrmse=1e-9, left_out_share=0.0
    )
    found = verdict(perfect)
    assert not found.enough
    (reason,) = found.reasons
    assert reason.startswith("1 sample says" if count == 1 else "7 samples say")
    assert "%" not in reason


def test_samples_that_mostly_lie_off_the_surface_are_named_even_where_nothing_is_known():
    found = verdict(replace(ENOUGH, knows_nothing=True, left_out_share=0.9))
    assert "90 % of the samples were left out" in found.reasons[-1]


@pytest.mark.parametrize(
    ("error", "words"),
    [(0.1004, "10.04 %"), (0.104, "10.4 %"), (0.12, "12 %"), (1.14, "110 %"), (4.0, "400 %")],
)
def test_an_error_is_told_apart_from_its_target(error, words):
    (reason,) = verdict(replace(ENOUGH, predicted_nrmse=error)).reasons
    assert reason == f"the predicted error is {words}, above the target of 10 %"


def test_every_reason_is_given():
    changes = {key: value for each in AGAINST.values() for key, value in each.items()}
    unknown = verdict(replace(ENOUGH, **changes))
    assert len(unknown.reasons) == 4
    open_still = verdict(replace(ENOUGH, **{**changes, "bracket": Bracket(0.99, 4, 61)}))
    assert len(open_still.reasons) == 5
