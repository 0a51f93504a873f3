"""Planning one case: how many samples a kind of map needs on a surface, and where."""

import math
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from auricle.arrays import Floats, Points, Truths
from auricle.errors import InputError
from auricle.progress import Progress, silent
from auricle.sampling.catheter import Placements, planned_placements
from auricle.sampling.chamber import Chamber
from auricle.sampling.local_nyquist import local_nyquist, modal_transfer
from auricle.sampling.plan import ExpectedMap, SamplingPlan, evaluated_plan, plan_samples
from auricle.sampling.recommendation import (
    ACQUISITIONS,
    DENSEST_PER_CM2,
    Recommendation,
    recommendation,
)
from auricle.sampling.samples import Samples, place
from auricle.sampling.samples_file import read_positions
from auricle.sampling.sites import Sites
from auricle.sampling.tails import Tails
from auricle.study.plan_result import CATHETERS, PlanConfig, PlanResult
from auricle.study.preparation import PreparedSurface, prepare
from auricle.study.provenance import versions
from auricle.study.wanted import wanted

TARGETS = (0.05, 0.1, 0.2, 0.3)
"""Errors that the table of a plan is made for, beside the target."""


def plan_surface(
    path: Path,
    config: PlanConfig,
    *,
    existing: Path | None = None,
    progress: Progress = silent,
) -> PlanResult:
    """How many samples a map of this kind needs on the surface in a file, and where.

    Parameters
    ----------
    path
        A surface file.
    config
        What is to be mapped and how well.
    existing
        A CSV file with the positions of samples taken already.
    progress
        Told the stages.

    Raises
    ------
    InputError
        If a file or a parameter is at fault.
    SolverError
        If the harmonics miss their certificate.
    """
    begin = time.perf_counter()
    taken_at = None if existing is None else read_positions(existing)
    prepared = prepare(
        path,
        n_vertices=config.n_vertices,
        n_modes=config.n_modes,
        seed=config.seed,
        needed=[name for name in (config.field, config.forbid) if name is not None],
        progress=progress,
    )
    solved = time.perf_counter()
    result = plan_prepared(prepared, config, existing=taken_at, about=existing, progress=progress)
    return replace(result, seconds={"prepare": solved - begin, **result.seconds})


def plan_prepared(
    prepared: PreparedSurface,
    config: PlanConfig,
    *,
    existing: Points | None = None,
    about: Path | None = None,
    progress: Progress = silent,
) -> PlanResult:
    """As `plan_surface`, on a surface that is prepared already.

    Parameters
    ----------
    prepared
        The surface.
    config
        What is to be mapped; parameters of preparation are only recorded.
    existing
        Positions of samples taken already, shape (m, 3), mm.
    about
        The file these came from, for messages.
    progress
        Told the stages.

    Raises
    ------
    InputError
        If a parameter is at fault.
    """
    begin = time.perf_counter()
    chamber = prepared.chamber
    asked = wanted(prepared, config, progress)
    advised, by_target = _recommended(asked.tails, chamber, config)
    progress("plan", 0, 2)
    taken, remarks = _existing(about, existing, chamber)
    expected = ExpectedMap(_monotone(asked.tails.at(config.quantile)), config.noise_ratio)
    n_samples = config.n_samples or _still_needed(advised, chamber, taken)
    plan, placements = _planned(prepared, n_samples, expected, taken, config)
    progress("plan", 1, 2)
    wavelengths = np.empty(0)
    if plan is not None:
        transfer = modal_transfer(chamber, plan.sites, expected.prior(area=chamber.basis.area))
        found = local_nyquist(chamber, transfer).wavelengths
        wavelengths = found[: prepared.surface.n_vertices]
    progress("plan", 2, 2)
    return PlanResult(
        prepared=prepared,
        config=config,
        wanted=asked.words,
        tails=asked.tails,
        recommendation=advised,
        by_target=by_target,
        existing=taken,
        plan=plan,
        placements=placements,
        wavelengths=wavelengths,
        example=asked.example,
        remarks=(*remarks, *_forbidden_remark(prepared, config)),
        versions=versions(),
        seconds={"plan": time.perf_counter() - begin},
    )


def _planned(
    prepared: PreparedSurface,
    n_samples: int,
    expected: ExpectedMap,
    taken: Sites,
    config: PlanConfig,
) -> tuple[SamplingPlan | None, Placements | None]:
    """The points asked for beside those taken; what those are good for, if none is needed."""
    chamber = prepared.chamber
    if not n_samples:
        if not len(taken):
            return None, None
        return evaluated_plan(chamber, taken, expected, design="none: enough are taken"), None
    if config.catheter is not None:
        return _laid(prepared, n_samples, expected, taken, config)
    plan = plan_samples(
        chamber,
        n_samples,
        expected,
        design=config.design,
        allowed=_allowed(prepared, config),
        existing=taken if len(taken) else None,
    )
    return plan, None


def _laid(
    prepared: PreparedSurface,
    n_samples: int,
    expected: ExpectedMap,
    taken: Sites,
    config: PlanConfig,
) -> tuple[SamplingPlan, Placements]:
    """Placements of the catheter that bring so many electrodes onto the surface.

    Its electrodes lie close together, so that the number for single points is not enough: unless
    a number is asked for, placements are added until least squares meets the target, or the
    electrodes are as dense as any that are recommended.
    """
    chamber, allowed = prepared.chamber, _allowed(prepared, config)
    pattern = CATHETERS[str(config.catheter)]()
    most = DENSEST_PER_CM2 * chamber.accessible_area / 100
    count = math.ceil(n_samples / len(pattern.offsets))
    while True:
        placements = planned_placements(chamber, pattern, count, allowed=allowed, existing=taken)
        missing = n_samples - len(placements.sites)
        if missing <= 0:
            both = Sites(
                np.concatenate([taken.corners, placements.sites.corners]),
                np.concatenate([taken.weights, placements.sites.weights]),
            )
            plan = evaluated_plan(chamber, both, expected, design=f"catheter: {config.catheter}")
            met = plan.predicted_nrmse <= config.target_nrmse
            if met or config.n_samples is not None or len(both) > most:
                return plan, placements
        count += max(math.ceil(count / 4), math.ceil(missing / len(pattern.offsets)))


def _allowed(prepared: PreparedSurface, config: PlanConfig) -> Truths | None:
    return None if config.forbid is None else prepared.allowed_by(config.forbid)


def _forbidden_remark(prepared: PreparedSurface, config: PlanConfig) -> tuple[str, ...]:
    if config.forbid is None:
        return ()
    chamber = prepared.chamber
    share = chamber.mean((~prepared.allowed_by(config.forbid)).astype(float))
    return (
        f"no point is placed where {config.forbid} is not 0 ({share:.1%} of the area); the error "
        "there counts all the same",
    )


def _recommended(
    tails: Tails, chamber: Chamber, config: PlanConfig
) -> tuple[Recommendation, dict[tuple[float, str], Recommendation]]:
    def advised(target: float, acquisition: str) -> Recommendation:
        return recommendation(
            tails,
            chamber,
            target_nrmse=target,
            noise_ratio=config.noise_ratio,
            acquisition=acquisition,
            quantile=config.quantile,
        )

    targets = sorted({*TARGETS, config.target_nrmse})
    table = {(target, how): advised(target, how) for target in targets for how in ACQUISITIONS}
    return advised(config.target_nrmse, config.acquisition), table


def _existing(
    path: Path | None, positions: Points | None, chamber: Chamber
) -> tuple[Sites, tuple[str, ...]]:
    if positions is None:
        return Sites.at_vertices([]), ()
    try:
        placed = place(Samples(positions, np.zeros(len(positions))), chamber)
    except InputError as fault:
        raise InputError(f"{path or 'samples taken'}: {fault}") from fault
    return placed.sites, placed.remarks


def _still_needed(advised: Recommendation, chamber: Chamber, taken: Sites) -> int:
    """Points to plan beside those taken; 0 if there are enough or no number suffices."""
    if advised.n_samples is None:
        return 0
    return advised.points_for(taken.positions(chamber.mesh)) or 0


def _monotone(tail: Floats) -> Floats:
    """The least tail above this one that never grows: a reconstruction may use fewer harmonics."""
    bounded: Floats = np.minimum(np.maximum.accumulate(tail[::-1])[::-1], 1.0)
    return bounded
