"""What the stages of a case cost, how that grows with the surface, and what many cases need."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from scipy.stats import linregress

from auricle.arrays import Floats

_OF_THE_INPUT = ("surface", "simplify")
"""Stages whose work grows with the surface as read; the others' with the surface analysed."""

_LEAST_SPAN = 1.5
"""Ratio of the largest to the smallest surface below which no exponent is stated."""

_LEAST_SECONDS = 0.01
"""A stage shorter than this says nothing of its growth."""


class Timed(Protocol):
    """A case's values and timings."""

    @property
    def values(self) -> Mapping[str, Any]:
        """What was found, numbers of vertices among it."""

    @property
    def timings(self) -> Mapping[str, float]:
        """Seconds by stage."""


@dataclass(frozen=True)
class StageCost:
    """What one stage costs over the cases of a study.

    Attributes
    ----------
    stage
        Its name.
    n_cases
        Cases that went through it.
    median_s, total_s
        Wall time of one worker, s.
    share
        Of the time of all stages.
    exponent, exponent_error
        b in seconds ∝ nᵇ over the cases, n the number of vertices it works on, and its standard
        error; None where the cases are too much of a size.
    """

    stage: str
    n_cases: int
    median_s: float
    total_s: float
    share: float
    exponent: float | None
    exponent_error: float | None


@dataclass(frozen=True)
class ClusterNeed:
    """What a number of cases needs at the cost of those of a study.

    Attributes
    ----------
    n_cases, n_cores
        Cases, and workers of one core each.
    core_hours
        For all of them.
    wall_hours
        With every core at work: the core-hours shared out, the longest case at the end of it.
    longest_case_hours
        Less than this no number of cores can make it.
    """

    n_cases: int
    n_cores: int
    core_hours: float
    wall_hours: float
    longest_case_hours: float


def stage_costs(cases: Sequence[Timed]) -> tuple[StageCost, ...]:
    """Cost of every stage, in the order of the stages."""
    stages = list(dict.fromkeys(stage for case in cases for stage in case.timings))
    total = sum(sum(case.timings.values()) for case in cases)
    return tuple(_stage_cost(stage, cases, total) for stage in stages)


def _stage_cost(stage: str, cases: Sequence[Timed], total: float) -> StageCost:
    through = [case for case in cases if stage in case.timings]
    seconds = np.array([case.timings[stage] for case in through])
    known = [(n, s) for case, s in zip(through, seconds, strict=True) if (n := _size(case, stage))]
    sizes = np.array([n for n, _ in known], dtype=float)
    exponent, error = _exponent(sizes, np.array([s for _, s in known]))
    return StageCost(
        stage,
        len(through),
        float(np.median(seconds)),
        float(seconds.sum()),
        float(seconds.sum() / total) if total else 0.0,
        exponent,
        error,
    )


def _size(case: Timed, stage: str) -> int:
    """Vertices a stage works on; 0 if the case does not say."""
    which = "surface_as_read" if stage in _OF_THE_INPUT else "surface_analyzed"
    return int(case.values.get(which, {}).get("n_vertices", 0))


def _exponent(sizes: Floats, seconds: Floats) -> tuple[float | None, float | None]:
    measurable = seconds >= _LEAST_SECONDS
    sizes, seconds = sizes[measurable], seconds[measurable]
    if len(np.unique(sizes)) < 3 or sizes.max() < _LEAST_SPAN * sizes.min():
        return None, None
    line = linregress(np.log(sizes), np.log(seconds))
    return float(line.slope), float(line.stderr)


def cluster_need(cases: Sequence[Timed], *, n_cases: int, n_cores: int) -> ClusterNeed:
    """What `n_cases` like these need on `n_cores` cores.

    Examples
    --------
    Ten thousand cases of 36 s are 100 core-hours, on 100 cores an hour and a last case:

    >>> from auricle.study.cohort.gathering import KeptCase
    >>> from auricle.study.cohort.case import Case
    >>> like = KeptCase(Case("a", "a.vtp", "0f"), {}, {"harmonics": 36.0})
    >>> cluster_need([like], n_cases=10_000, n_cores=100)  # doctest: +NORMALIZE_WHITESPACE
    ClusterNeed(n_cases=10000, n_cores=100, core_hours=100.0, wall_hours=1.01,
        longest_case_hours=0.01)
    """
    seconds = np.array([sum(case.timings.values()) for case in cases])
    hours = n_cases * float(seconds.mean()) / 3600
    longest = float(seconds.max()) / 3600
    return ClusterNeed(n_cases, n_cores, hours, hours / n_cores + longest, longest)
