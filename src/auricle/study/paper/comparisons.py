"""Comparisons over a cohort: counts on other meshes of the same atria, and by harmonics or points.

What is compared: a finer mesh, or the surface rebuilt from few harmonics, with the surface that
was analysed; the points of Qslim with harmonics.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from auricle.study.paper.tables import Values, median
from auricle.study.paper.thinned_features import WAYS

GEOMETRY_SHARE = 0.99
"""Of the geometry's power, at which its counts are compared: 90 % takes a handful of harmonics."""


@dataclass(frozen=True)
class Comparison:
    """Counts of harmonics on another surface beside those on the surface analysed.

    Attributes
    ----------
    where
        Vertices of the finer mesh, or harmonics the surface was rebuilt from.
    words
        Which map: ``geometry``, or the size of one focus and its width.
    share
        Of the power.
    n_cases
        How many cases hold both.
    before, after
        Medians over cases of the cases' medians over placements.
    change, change_low, change_high
        after / before - 1 case by case: median, least and greatest.
    """

    where: int
    words: str
    share: float
    n_cases: int
    before: float
    after: float
    change: float
    change_low: float
    change_high: float


@dataclass(frozen=True)
class RecoveredMap:
    """How many harmonics or points a map takes for one error.

    Attributes
    ----------
    size, sigma_mm, n_foci
        Which map.
    counts
        By each of `WAYS`, median over cases of the number at which the mean error reaches the
        wanted one, between those measured by straight lines of the logarithms; infinite where
        the most do not suffice.
    gd_ratio
        Mean distance of the surface thinned out with the map over that without, at the number of
        points nearest to `counts` of the former: median over cases.
    """

    size: str
    sigma_mm: float
    n_foci: int
    counts: dict[str, float]
    gd_ratio: float


def resolution_comparisons(documents: Sequence[Values]) -> tuple[Comparison, ...]:
    """Counts on meshes of other numbers of vertices, foci at the same places."""
    found = [
        (finer["n_vertices"], *each)
        for document in documents
        for finer in document["beyond"]["resolution"]
        for each in (
            *_geometry(document, finer["geometry"]),
            *_single_foci(document, finer["features"]),
        )
    ]
    return tuple(_comparisons(found))


def recovered_comparisons(documents: Sequence[Values]) -> tuple[Comparison, ...]:
    """Counts of maps carried to the surface rebuilt from few harmonics."""
    found = [
        (again["count"], *each)
        for document in documents
        for again in document["beyond"]["recovered"]
        for each in _single_foci(document, again["features"])
    ]
    return tuple(_comparisons(found))


def recovered_maps(documents: Sequence[Values], *, share: float) -> tuple[RecoveredMap, ...]:
    """Harmonics and points with which a map keeps a share of its power: nRMSE = √(1 - share)."""
    rows = []
    for number, first in enumerate(documents[0]["thinned_features"]):
        records = [document["thinned_features"][number] for document in documents]
        found = [
            {way: count_reaching(each["counts"], each["nrmse"][way], (1 - share) ** 0.5)
             for way in WAYS}
            for each in records
        ]  # fmt: skip
        counts = {way: median([each[way] for each in found]) for way in WAYS}
        ratios = [
            each["gd_mm"]["points_with_feature"][place] / each["gd_mm"]["points"][place]
            for each in records
            for place in [int(np.abs(np.subtract(each["counts"], counts[WAYS[2]])).argmin())]
        ]
        rows.append(
            RecoveredMap(
                first["size"], first["sigma_mm"], first["n_foci"], counts, float(np.median(ratios))
            )
        )
    return tuple(rows)


def count_reaching(counts: Sequence[int], errors: Sequence[float], wanted: float) -> float:
    """Number at which an error that falls with it first reaches `wanted`; infinite if it does not.

    Between two numbers error and number are joined by a straight line of their logarithms.

    Examples
    --------
    An error that falls as one over the number:

    >>> round(count_reaching([10, 100, 1000], [1.0, 0.1, 0.01], 0.05), 6)
    200.0
    """
    reached = np.flatnonzero(np.asarray(errors) <= wanted)
    if not len(reached):
        return float("inf")
    place = int(reached[0])
    if not place:
        return float(counts[0])
    pair = slice(place - 1, place + 1)
    falling = np.log(errors[pair])[::-1]
    return float(np.exp(np.interp(np.log(wanted), falling, np.log(counts[pair])[::-1])))


def _geometry(
    document: Values, counts: dict[str, int | None]
) -> Iterator[tuple[str, float, float, float]]:
    before, key = document["geometry"]["counts"], f"{GEOMETRY_SHARE:g}"
    yield "geometry", GEOMETRY_SHARE, _number(before[key]), _number(counts[key])


def _single_foci(
    document: Values, features: Sequence[dict[str, Any]]
) -> Iterator[tuple[str, float, float, float]]:
    """Words, share, the case's median count before and after."""
    before = {each["size"]: each for each in document["features"] if each["n_foci"] == 1}
    share = document["parameters"]["shares"][-1]
    for each in features:
        if each["size"] in before:
            yield (
                f"one {each['size']} focus, σ = {each['sigma_mm']:g} mm",
                share,
                median([_number(count) for count in before[each["size"]]["counts"][f"{share:g}"]]),
                median([_number(count) for count in each["counts"][f"{share:g}"]]),
            )


def _comparisons(
    found: Sequence[tuple[int, str, float, float, float]],
) -> Iterator[Comparison]:
    """One for each place, map and share; pairs beyond the harmonics at hand are left out."""
    known = [each for each in found if np.isfinite(each[3:]).all()]
    for where, words, share in sorted(dict.fromkeys(each[:3] for each in known), key=_by_where):
        pairs = np.array([each[3:] for each in known if each[:3] == (where, words, share)])
        changes = pairs[:, 1] / pairs[:, 0] - 1.0
        yield Comparison(
            where,
            words,
            share,
            len(pairs),
            float(np.median(pairs[:, 0])),
            float(np.median(pairs[:, 1])),
            float(np.median(changes)),
            float(changes.min()),
            float(changes.max()),
        )


def _by_where(kind: tuple[int, str, float]) -> int:
    """Order of comparisons: by place, else as they come."""
    return kind[0]


def _number(count: int | None) -> float:
    return np.inf if count is None else float(count)
