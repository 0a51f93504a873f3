"""What the stages of a case cost, how that grows with the surface, and what many cases need."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from auricle.arrays import Floats

_OF_THE_INPUT = ("surface", "simplify")
"""Stages whose work grows with the surface as read; the others' with the surface analysed and with
its harmonics."""

_LEAST_SPAN = 1.5
"""Ratio of the largest to the smallest surface below which no exponent is stated."""

_FEWEST_SIZES = 3

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
        b in seconds ∝ nᵇ·kᶜ over the cases, n the number of vertices it works on, and its standard
        error; None where the cases are too much of a size.
    modes_exponent, modes_exponent_error
        c, k the number of harmonics; None where all cases have about as many, or for stages that
        come before harmonics.
    """

    stage: str
    n_cases: int
    median_s: float
    total_s: float
    share: float
    exponent: float | None
    exponent_error: float | None
    modes_exponent: float | None = None
    modes_exponent_error: float | None = None


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
    known = [
        (s, *sizes)
        for case, s in zip(through, seconds.tolist(), strict=True)
        if min(sizes := _sizes(case, stage)) > 0
    ]
    fitted = _exponents(np.reshape(known, (-1, 3)))
    return StageCost(
        stage,
        len(through),
        float(np.median(seconds)),
        float(seconds.sum()),
        float(seconds.sum() / total) if total else 0.0,
        *fitted,
    )


def _sizes(case: Timed, stage: str) -> tuple[int, int]:
    """Vertices and harmonics a stage works on; 0 vertices if the case does not say."""
    of_the_input = stage in _OF_THE_INPUT
    which = "surface_as_read" if of_the_input else "surface_analyzed"
    n_vertices = int(case.values.get(which, {}).get("n_vertices", 0))
    n_modes = int(case.values.get("certificate", {}).get("n_modes", 1))
    return n_vertices, 1 if of_the_input else n_modes


def _exponents(rows: Floats) -> tuple[float | None, float | None, float | None, float | None]:
    """Exponent of vertices with its standard error, and of harmonics; rows (seconds, n, k)."""
    measured = rows[rows[:, 0] >= _LEAST_SECONDS]
    wide = [
        len(np.unique(sizes)) >= _FEWEST_SIZES and sizes.max() >= _LEAST_SPAN * sizes.min()
        for sizes in measured[:, 1:].T
    ]
    chosen = np.flatnonzero(wide)
    left = len(measured) - len(chosen) - 1
    if not len(chosen) or left < 1:
        return None, None, None, None
    logs = np.log(measured)
    factors = np.column_stack([np.ones(len(logs)), logs[:, 1 + chosen]])
    solution, _, rank, _ = np.linalg.lstsq(factors, logs[:, 0])
    if rank < factors.shape[1]:
        return None, None, None, None
    variance = ((logs[:, 0] - factors @ solution) ** 2).sum() / left
    errors = np.sqrt(variance * np.diag(np.linalg.inv(factors.T @ factors)))
    found: list[float | None] = [None] * 4
    for place, which in enumerate(chosen.tolist(), start=1):
        found[2 * which : 2 * which + 2] = float(solution[place]), float(errors[place])
    return found[0], found[1], found[2], found[3]


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
