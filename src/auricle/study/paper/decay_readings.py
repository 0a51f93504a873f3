"""Decay under every reading: τ of GD and MSE beside the paper's, with what it leaves open.

GD may be measured from the original or from the rebuilt surface, MSE vertex by vertex or to the
nearest vertex either way; the exponential may have a floor; the counts it is fitted to are not
stated; and the harmonics may be those of Eq. 1 as printed.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np

from auricle.study.paper.printed import DECAYS
from auricle.study.paper.tables import READING_WORDS

METHODS = ("mha", "qslim")
LEAST_SHARE = 0.5
"""A reading stands for itself only where at least this share of the cases has a τ under it."""


@dataclass(frozen=True)
class DecayReading:
    """One reading of τ, over all cases.

    Attributes
    ----------
    kind
        ``GD`` or ``MSE``.
    operator
        Of the harmonics: ``area_weighted`` or ``as_printed``. Qslim's τ has none.
    error, counts, with_floor
        Which error, the counts fitted to, and whether with a floor, as `quality.decays` has them.
    means, deviations
        Of τ over the cases that have one, points, for harmonics and then Qslim.
    n_cases
        How many have one, for each.
    distance
        Root mean square of ln(mean / printed mean) over both.
    """

    kind: str
    operator: str
    error: str
    counts: str
    with_floor: bool
    means: tuple[float, float]
    deviations: tuple[float, float]
    n_cases: tuple[int, int]
    distance: float

    @property
    def label(self) -> str:
        """In a few words."""
        floor = "with a floor" if self.with_floor else "without a floor"
        words, operator = READING_WORDS[self.error], self.operator.replace("_", " ")
        return f"{words}; counts {self.counts}, {floor}, {operator}"


def decay_readings(documents: Sequence[Mapping[str, Any]]) -> tuple[DecayReading, ...]:
    """Every reading of both errors that enough cases have a τ under, the nearest first by kind."""
    taus: dict[tuple[str, str, str, bool, str], list[float]] = {}
    for document in documents:
        for operator, record in _records(document):
            key = (
                operator,
                record["error"],
                record["range"],
                record["with_floor"],
                record["method"],
            )
            taus.setdefault(key, [])
            if record["tau"] is not None:
                taus[key].append(float(record["tau"]))
    least = LEAST_SHARE * len(documents)
    found = list(_readings(taus, least))
    return tuple(sorted(found, key=lambda each: (each.kind, each.distance)))


def nearest_decays(readings: Sequence[DecayReading]) -> tuple[DecayReading, ...]:
    """The nearest reading of each kind of error."""
    return tuple(next(each) for _, each in groupby(readings, key=lambda each: each.kind))


def _records(document: Mapping[str, Any]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Records of one case with the operator they belong to; Qslim's stand beside either."""
    conventions = document.get("conventions") or {}
    printed = conventions.get("decay", [])
    for record in document["decay"]:
        yield "area_weighted", record
        if record["method"] == "qslim" and printed:
            yield "as_printed", record
    for record in printed:
        yield "as_printed", record


def _readings(
    taus: Mapping[tuple[str, str, str, bool, str], list[float]], least: float
) -> Iterator[DecayReading]:
    for operator, error, counts, floor in dict.fromkeys(key[:4] for key in taus):
        both = [taus.get((operator, error, counts, floor, method), []) for method in METHODS]
        if min(len(each) for each in both) < max(least, 1):
            continue
        kind = "GD" if error.startswith("gd") else "MSE"
        printed = [DECAYS[(kind, method)][0] for method in METHODS]
        means = [float(np.mean(each)) for each in both]
        spread = [float(np.std(each, ddof=1)) if len(each) > 1 else 0.0 for each in both]
        yield DecayReading(
            kind=kind,
            operator=operator,
            error=error,
            counts=counts,
            with_floor=floor,
            means=(means[0], means[1]),
            deviations=(spread[0], spread[1]),
            n_cases=(len(both[0]), len(both[1])),
            distance=float(np.sqrt(np.mean(np.log(np.divide(means, printed)) ** 2))),
        )
