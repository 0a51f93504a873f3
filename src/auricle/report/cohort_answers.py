"""What a study answers, in sentences: the top of a cohort's page, and what resolution changes."""

from collections import Counter
from collections.abc import Iterator, Sequence

from auricle.report.cohort_tables import count_words, signed_percent
from auricle.report.wording import counted, listed, number, percent
from auricle.study.paper.claims import Claim, Outcome
from auricle.study.paper.comparisons import (
    Comparison,
    recovered_maps,
    resolution_comparisons,
)
from auricle.study.paper.tables import (
    CountRow,
    DecayRow,
    Values,
    headline_decays,
    nearest_by_range,
)

UNBIASED = 0.05
"""Median change of a count, up to which another mesh is taken to tell the same."""


def study_answers(
    documents: Sequence[Values],
    counts: Sequence[CountRow],
    decays: Sequence[DecayRow],
    found: Sequence[Claim],
) -> list[str]:
    """The answers of a study, a sentence or two each, in the order of its page.

    Parameters
    ----------
    documents
        Values of the cases.
    counts, decays, found
        Their Table 1, τ under every reading, and claims.
    """
    return [
        _tally(found),
        *_decay_answers(headline_decays(decays), nearest_by_range(decays)),
        *_count_answers(counts),
        *_recovery_answers(documents),
        *resolution_answers(documents),
    ]


def resolution_answers(documents: Sequence[Values]) -> Iterator[str]:
    """Whether the number of vertices that surfaces were reduced to changes the counts."""
    found = resolution_comparisons(documents)
    if not found:
        return
    base = max(document["surface_analyzed"]["n_vertices"] for document in documents)
    finest = {where: max(each.n_cases for each in found if each.where == where)
              for where in dict.fromkeys(each.where for each in found)}  # fmt: skip
    meshes = listed([f"{where:,} ({counted(n, 'atrium', 'atria')})" for where, n in finest.items()])
    worst = max(found, key=lambda each: abs(each.change))
    low = min(found, key=lambda each: each.change_low)
    high = max(found, key=lambda each: each.change_high)
    verdict = (
        "the reduction does not bias counts by energy"
        if abs(worst.change) <= UNBIASED
        else "the reduction biases counts by energy"
    )
    yield (
        f"Does the reduction to {base:,} vertices bias the answer? With {meshes} in its place and "
        "foci at the same places, the median change of a count of harmonics is "
        f"{signed_percent(worst.change)} where it is largest ({_words(worst)}), the change in "
        f"single atria {signed_percent(low.change_low)} to {signed_percent(high.change_high)}: "
        f"{verdict}."
    )


def _words(each: Comparison) -> str:
    return f"{each.words}, {percent(each.share)}, {each.where:,} vertices"


def _tally(found: Sequence[Claim]) -> str:
    outcomes = Counter(claim.outcome for claim in found)
    tally = listed([f"{outcomes[each]} {each.value}" for each in Outcome if outcomes[each]])
    return f"Of {counted(len(found), 'finding')} of the paper: {tally}."


def _decay_answers(headline: Sequence[DecayRow], nearest: Sequence[DecayRow]) -> Iterator[str]:
    for row in headline:
        if row.mha is None or row.qslim is None:
            continue
        closest = next(each for each in nearest if each.error == row.error)
        yield (
            f"τ under {row.error}: {_tau_words(row)}; the paper prints {row.printed[0][0]:g} "
            f"and {row.printed[1][0]:g}."
            + (
                f" Fitted to counts {closest.counts} it is {_tau_words(closest)}."
                if closest.counts != row.counts
                else ""
            )
        )


def _count_answers(counts: Sequence[CountRow]) -> Iterator[str]:
    ratios = [row.ratio for row in counts if row.ratio is not None and row.n_foci is not None]
    if ratios:
        yield (
            f"Table 1's feature counts here are {number(min(ratios), digits=2)} to "
            f"{number(max(ratios), digits=2)} times the printed ones, with foci whose widths the "
            "paper does not state."
        )


def _recovery_answers(documents: Sequence[Values]) -> Iterator[str]:
    """Harmonics against points of Qslim for as much of a map, one focus."""
    share = documents[0]["parameters"]["shares"][-1]
    found = recovered_maps(documents, share=share)
    rows = [each for each in found if each.n_foci == min(other.n_foci for other in found)]
    if rows:
        parts = [
            f"{each.size} {count_words(each.counts['harmonics'])}, "
            f"{count_words(each.counts['points_with_feature'])} and "
            f"{count_words(each.counts['points'])}"
            for each in rows
        ]
        yield (
            f"To keep {percent(share)} of the power of {counted(rows[0].n_foci, 'focus', 'foci')} "
            "it takes so many harmonics, points of Qslim with the map in its quadric (R⁴), and "
            f"points of Qslim that knows the geometry only: {'; '.join(parts)}."
        )


def _tau_words(row: DecayRow) -> str:
    if row.mha is None or row.qslim is None:
        return "not known"
    return (
        f"{number(row.mha.mean)} ± {number(row.mha.deviation)} harmonics and "
        f"{number(row.qslim.mean)} ± {number(row.qslim.deviation)} points"
    )
