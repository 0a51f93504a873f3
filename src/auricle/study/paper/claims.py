"""Claims: what the paper says of its findings in words, each held against the cohort's numbers."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from itertools import pairwise

import numpy as np

from auricle.study.paper.statistics import PairedTest, summary
from auricle.study.paper.tables import (
    Values,
    counts_of,
    decay_rows,
    decays_by_range,
    headline_decays,
)

LOW_PASS_HARMONICS = 0.1
"""Share of the harmonics that "the first coefficients" are taken to be."""
LOW_PASS_POWER = 0.9
NEARLY_ALL = 0.95
"""Share of the comparisons in which an order must hold to count as confirmed."""
SAME_ORDER = 2.0
"""Factor within which two τ count as of the same order."""
SIGNIFICANT = 0.05
FAR_APART = 1.5
"""Ratio from which two counts are taken to be very different."""


class Outcome(Enum):
    """What the numbers say of a claim."""

    CONFIRMED = "confirmed"
    PARTLY = "partly confirmed"
    REFUTED = "refuted"
    OPEN = "cannot be told"


@dataclass(frozen=True)
class Claim:
    """One finding of the paper and what became of it.

    Attributes
    ----------
    words
        What the paper says.
    place
        Where.
    outcome
        Of the test.
    criterion
        What would have confirmed it.
    evidence
        The numbers.
    """

    words: str
    place: str
    outcome: Outcome
    criterion: str
    evidence: str


def claims(documents: Sequence[Values]) -> tuple[Claim, ...]:
    """Every claim, tested on the cases of a cohort (Gaussian foci, area-weighted power)."""
    tests: tuple[Callable[[Sequence[Values]], Claim], ...] = (
        _geometry_is_low_pass,
        _features_are_low_pass,
        _size_orders_counts,
        _counts_grow_with_size,
        _counts_fall_with_foci,
        _shares_ask_for_different_counts,
        _gd_agrees,
        _mse_differs,
        _quarter_thousand_is_enough,
    )
    return tuple(test(documents) for test in tests)


def _geometry_is_low_pass(documents: Sequence[Values]) -> Claim:
    shares = []
    for document in documents:
        accumulated = document["geometry"]["accumulated_share"]
        shares.append(accumulated[_first_tenth(len(accumulated)) - 1])
    return _low_pass(
        shares, "the higher power of coefficients is concentrated in the lower frequencies", "§3"
    )


def _features_are_low_pass(documents: Sequence[Values]) -> Claim:
    shares = []
    for document in documents:
        for each in document["features"]:
            by_harmonic = each["share_by_harmonic"]
            shares.append(float(np.sum(by_harmonic[: _first_tenth(len(by_harmonic))])))
    return _low_pass(
        shares,
        "the power spectrum of the surrogate feature is concentrated in the first coefficients",
        "§3, Figure 5",
    )


def _low_pass(shares: Sequence[float], words: str, place: str) -> Claim:
    reached = sum(share >= LOW_PASS_POWER for share in shares)
    least, middle = min(shares, default=0.0), summary(shares or [0.0]).median
    return Claim(
        words,
        place,
        _outcome(reached, len(shares)),
        f"the first tenth of the harmonics holds {100 * LOW_PASS_POWER:g} % of the power, in "
        f"{100 * NEARLY_ALL:g} % of the maps",
        f"holds in {reached} of {len(shares)}; median share {100 * middle:.4g} %, "
        f"least {100 * least:.4g} %",
    )


def _size_orders_counts(documents: Sequence[Values]) -> Claim:
    held, compared = _ordered(documents)
    return Claim(
        "small foci need more coefficients than medium ones, and these more than wide ones",
        "Table 1",
        _outcome(held, compared),
        f"in {100 * NEARLY_ALL:g} % of cases, placements, numbers of foci and shares",
        f"in {held} of {compared}",
    )


def _counts_grow_with_size(documents: Sequence[Values]) -> Claim:
    held, compared = _ordered(documents)
    return Claim(
        "the number of coefficients increased with the mechanism size: smoother variations need "
        "a high number of coefficients",
        "§3, against Table 1",
        _outcome(compared - held, compared),
        f"the opposite order in {100 * NEARLY_ALL:g} % of them",
        f"counts do not fall with size in {compared - held} of {compared}",
    )


def _ordered(documents: Sequence[Values]) -> tuple[int, int]:
    """Comparisons in which small > medium > wide, and all; a count beyond the band is largest."""
    held = compared = 0
    for document in documents:
        sizes = list(dict.fromkeys(each["size"] for each in document["features"]))
        foci = sorted({each["n_foci"] for each in document["features"]})
        for n_foci in foci:
            for share in document["parameters"]["shares"]:
                rows = [_beyond_last(counts_of([document], n_foci, size, share)) for size in sizes]
                for counts in zip(*rows, strict=True):
                    compared += 1
                    held += all(wider < narrower for narrower, wider in pairwise(counts))
    return held, compared


def _counts_fall_with_foci(documents: Sequence[Values]) -> Claim:
    ratios = []
    for document in documents:
        foci = sorted({each["n_foci"] for each in document["features"]})
        for size in dict.fromkeys(each["size"] for each in document["features"]):
            for share in document["parameters"]["shares"]:
                one, most = (
                    _beyond_last(counts_of([document], n_foci, size, share))
                    for n_foci in (foci[0], foci[-1])
                )
                if np.isfinite([*one, *most]).all():
                    ratios.append(float(np.median(one) / np.median(most)))
    found = summary(ratios or [1.0])
    return Claim(
        "one focus needs more coefficients than three: 217 against 67 for small foci at 85 %",
        "Table 1",
        _outcome(sum(ratio >= FAR_APART for ratio in ratios), len(ratios)),
        f"the count for one focus is {FAR_APART} times that for the most foci or more, in "
        f"{100 * NEARLY_ALL:g} % of cases, sizes and shares (printed: 1.7 to 7.9, but 0.72 for "
        "wide foci at 85 %)",
        f"median ratio {found.median:.2f}, {found.low:.2f} to {found.high:.2f}",
    )


def _shares_ask_for_different_counts(documents: Sequence[Values]) -> Claim:
    ratios = [
        wanted / less
        for document in documents
        for each in document["features"]
        if {"0.85", "0.9"} <= set(each["counts"])
        for less, wanted in zip(each["counts"]["0.85"], each["counts"]["0.9"], strict=True)
        if less is not None and wanted is not None
    ]
    found = summary(ratios or [1.0])
    return Claim(
        "the number of coefficients was very different when considering 85 % against 90 %",
        "§3, Table 1",
        _outcome(sum(ratio >= FAR_APART for ratio in ratios), len(ratios)),
        f"a ratio of {FAR_APART} or more in {100 * NEARLY_ALL:g} % of maps (printed: 2.3 to 9.1)",
        f"median ratio {found.median:.2f}, {found.low:.2f} to {found.high:.2f}; a Gaussian's in "
        f"theory {np.log(0.10) / np.log(0.15):.2f}",
    )


def _gd_agrees(documents: Sequence[Values]) -> Claim:
    test, numbers = _tested(documents, "GD")
    if test is None:
        outcome = Outcome.OPEN
    elif test.ratio_low >= 1 / SAME_ORDER and test.ratio_high <= SAME_ORDER:
        outcome = Outcome.CONFIRMED
    elif 1 / SAME_ORDER <= test.ratio <= SAME_ORDER:
        outcome = Outcome.PARTLY
    else:
        outcome = Outcome.REFUTED
    return Claim(
        "consistent τ under GD for MHA and Qslim, their difference not significant",
        "abstract, §3",
        outcome,
        f"the interval of the ratio of τ lies within a factor {SAME_ORDER:g}",
        numbers,
    )


def _mse_differs(documents: Sequence[Values]) -> Claim:
    test, numbers = _tested(documents, "MSE")
    if test is None:
        outcome = Outcome.OPEN
    elif test.p_value < SIGNIFICANT and test.ratio_high < 1 / SAME_ORDER:
        outcome = Outcome.CONFIRMED
    elif test.p_value < SIGNIFICANT and test.ratio < 1:
        outcome = Outcome.PARTLY
    else:
        outcome = Outcome.REFUTED
    return Claim(
        "under MSE τ is far smaller for MHA than for Qslim",
        "abstract, §3",
        outcome,
        f"p < {SIGNIFICANT:g} and MHA's below Qslim's by more than a factor {SAME_ORDER:g}; partly "
        "if smaller at that p only",
        numbers,
    )


def _quarter_thousand_is_enough(documents: Sequence[Values]) -> Claim:
    counts = [document["geometry"]["counts"].get("0.9") for document in documents]
    distances = [
        document["quality"]["mha"]["gd_from_original_mm"][place]
        for document in documents
        for place, count in enumerate(document["quality"]["mha"]["counts"])
        if count == 250
    ]
    enough = [count is not None and count <= 250 for count in counts]
    found = f"mean GD at 250 {summary(distances).mean:.2f} mm; " if distances else ""
    reached = [count for count in counts if count is not None]
    needed = f"{min(reached)} to {max(reached)}" if reached else "more than there are"
    return Claim(
        "about 250 coefficients can be an adequate number to reconstruct the geometry",
        "§3, Figure 1",
        _outcome(sum(enough), len(enough)),
        f"250 harmonics hold 90 % of the varying power in {100 * NEARLY_ALL:g} % of the cases",
        f"{found}90 % of the power takes {needed} harmonics: far fewer than 250 are adequate by "
        "this measure",
    )


def _tested(documents: Sequence[Values], error: str) -> tuple[PairedTest | None, str]:
    rows = decay_rows(documents)
    (row,) = (each for each in headline_decays(rows) if each.error == error)
    ranges = [each for each in decays_by_range(rows) if each.error == error and each.test]
    test = row.test
    if test is None:
        return None, "fewer than three cases have a τ of both methods"
    return test, (
        f"MHA {test.first.mean:.1f} ± {test.first.deviation:.1f}, Qslim {test.second.mean:.1f} ± "
        f"{test.second.deviation:.1f}; ratio {test.ratio:.2f} ({test.ratio_low:.2f} to "
        f"{test.ratio_high:.2f}); {test.name}, p = {test.p_value:.2g}, n = {test.first.n}. "
        "Ratio and p by the counts fitted: "
        + "; ".join(
            f"{each.counts} {each.test.ratio:.2f}, {each.test.p_value:.2g}"
            for each in ranges
            if each.test
        )
    )


def _outcome(held: int, compared: int) -> Outcome:
    if not compared:
        return Outcome.OPEN
    if held >= NEARLY_ALL * compared:
        return Outcome.CONFIRMED
    return Outcome.PARTLY if held >= 0.5 * compared else Outcome.REFUTED


def _beyond_last(counts: Sequence[Sequence[float | None]]) -> list[float]:
    """Counts of all placements, those beyond the harmonics at hand as infinite."""
    return [np.inf if count is None else count for case in counts for count in case]


def _first_tenth(n_modes: int) -> int:
    return max(1, round(LOW_PASS_HARMONICS * n_modes))
