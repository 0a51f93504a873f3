"""Planning one case: how many samples a kind of map needs on a surface, and where."""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from dataclasses import field as dataclass_field
from pathlib import Path
from types import MappingProxyType
from typing import get_args

import numpy as np

from auricle.arrays import Floats, PerVertex
from auricle.errors import InputError
from auricle.progress import Progress, silent
from auricle.sampling.bandwidth import class_tails
from auricle.sampling.chamber import Chamber
from auricle.sampling.local_nyquist import local_nyquist, modal_transfer
from auricle.sampling.plan import Design, ExpectedMap, SamplingPlan, plan_samples
from auricle.sampling.recommendation import ACQUISITIONS, Recommendation, recommendation
from auricle.sampling.samples import Samples, place
from auricle.sampling.samples_file import read_positions
from auricle.sampling.sites import Sites
from auricle.sampling.tails import Tails, truncation_tail
from auricle.simulation.map_classes import MAP_CLASSES
from auricle.study.preparation import N_MODES, N_VERTICES, PreparedSurface, prepare
from auricle.study.provenance import versions
from auricle.surface.field import FieldMap

N_DRAWS = 20
"""Maps of a class drawn to learn its bandwidth."""
TARGETS = (0.05, 0.1, 0.2, 0.3)
"""Errors that the table of a plan is made for, beside the target."""


@dataclass(frozen=True)
class PlanConfig:
    """What is to be planned for.

    Attributes
    ----------
    map_class, parameters
        A class of maps (`MAP_CLASSES`) and what differs from its defaults; or
    field, cycle_length_ms
        a map of this kind on the surface itself, with its period if it holds activation times of
        a re-entry; or
    bandwidth
        a number of harmonics. Exactly one of the three.
    target_nrmse
        Error to reach, relative to the map's standard deviation.
    noise_ratio
        Standard deviation of a sample's error relative to the map's.
    acquisition
        ``planned`` (the points of the plan are taken) or ``unplanned``.
    quantile
        Share of the class's maps for which the number is to suffice.
    n_samples
        A number to plan for instead of the recommended one.
    design
        How the points are chosen: ``farthest``, ``pivoted_qr``, ``a_optimal``, ``d_optimal``.
    n_vertices, n_modes
        Vertices to simplify to, harmonics to solve for.
    seed
        Of everything random.
    """

    map_class: str | None = None
    parameters: Mapping[str, float] = dataclass_field(default_factory=dict)
    field: str | None = None
    cycle_length_ms: float | None = None
    bandwidth: int | None = None
    target_nrmse: float = 0.1
    noise_ratio: float = 0.0
    acquisition: str = "planned"
    quantile: float = 0.9
    n_samples: int | None = None
    design: Design = "farthest"
    n_vertices: int = N_VERTICES
    n_modes: int = N_MODES
    seed: int = 1

    def __post_init__(self) -> None:
        object.__setattr__(self, "parameters", MappingProxyType(dict(self.parameters)))
        asked = [name is not None for name in (self.map_class, self.field, self.bandwidth)]
        if sum(asked) != 1:
            raise InputError("say what is to be mapped: a class of maps, a field or a bandwidth")
        if self.map_class is not None and self.map_class not in MAP_CLASSES:
            raise InputError(
                f"no class of maps {self.map_class!r}: choose from {', '.join(MAP_CLASSES)}"
            )
        if self.bandwidth is not None and not 2 <= self.bandwidth <= self.n_modes:
            raise InputError(
                f"a bandwidth of {self.bandwidth} harmonics: give 2 to {self.n_modes}, or solve "
                "for more"
            )
        if self.n_samples is not None and self.n_samples < 1:
            raise InputError(f"{self.n_samples} samples: ask for at least 1")


@dataclass(frozen=True, eq=False)
class PlanResult:
    """A plan and the grounds it stands on.

    Attributes
    ----------
    prepared
        The surface.
    config
        What was asked.
    wanted
        What is to be mapped, in words.
    tails
        How the error of such maps falls with the harmonics.
    recommendation
        For the target and the acquisition asked for.
    by_target
        Recommendations for further errors, planned and unplanned: (target, acquisition) → it.
    existing
        Samples taken already, on the surface; empty if there are none.
    plan
        The points; None where no number suffices and none was given.
    wavelengths
        Finest wavelength the plan supports at each vertex of the surface, mm, shape (n,);
        infinite where none; empty without a plan.
    example
        One map of the kind, to look at, on the surface; None for a bandwidth.
    remarks
        What the reader should know beside the surface's own.
    versions
        Of auricle and the libraries.
    seconds
        Wall time by stage.
    """

    prepared: PreparedSurface
    config: PlanConfig
    wanted: str
    tails: Tails
    recommendation: Recommendation
    by_target: Mapping[tuple[float, str], Recommendation]
    existing: Sites
    plan: SamplingPlan | None
    wavelengths: PerVertex
    example: FieldMap | None
    remarks: tuple[str, ...]
    versions: Mapping[str, str]
    seconds: Mapping[str, float] = dataclass_field(default_factory=dict)

    @property
    def positions(self) -> Floats:
        """Where the planned points lie, in order, shape (m, 3), mm."""
        if self.plan is None:
            return np.empty((0, 3))
        return self.prepared.chamber.mesh.vertices[self.plan.planned]


@dataclass(frozen=True, eq=False)
class _Wanted:
    """What is to be mapped: in words, its tails, one example."""

    words: str
    tails: Tails
    example: FieldMap | None


def checked_design(name: str) -> Design:
    """The design of this name.

    Raises
    ------
    InputError
        If there is none.
    """
    for design in get_args(Design):
        if name == design:
            found: Design = design
            return found
    raise InputError(f"no design {name!r}: choose from {', '.join(get_args(Design))}")


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
    prepared = prepare(
        path,
        n_vertices=config.n_vertices,
        n_modes=config.n_modes,
        seed=config.seed,
        progress=progress,
    )
    solved = time.perf_counter()
    chamber = prepared.chamber
    wanted = _wanted(prepared, config, progress)
    advised, by_target = _recommended(wanted.tails, chamber, config)
    progress("plan", 0, 2)
    taken, remarks = _existing(existing, chamber)
    n_samples = config.n_samples or _still_needed(advised, chamber, taken)
    plan = None
    if n_samples:
        expected = ExpectedMap(_monotone(wanted.tails.at(config.quantile)), config.noise_ratio)
        plan = plan_samples(
            chamber,
            n_samples,
            expected,
            design=config.design,
            existing=taken if len(taken) else None,
        )
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
        wanted=wanted.words,
        tails=wanted.tails,
        recommendation=advised,
        by_target=by_target,
        existing=taken,
        plan=plan,
        wavelengths=wavelengths,
        example=wanted.example,
        remarks=remarks,
        versions=versions(),
        seconds={"prepare": solved - begin, "plan": time.perf_counter() - solved},
    )


def _wanted(prepared: PreparedSurface, config: PlanConfig, progress: Progress) -> _Wanted:
    chamber = prepared.chamber
    if config.map_class is not None:
        return _wanted_class(prepared, config, progress)
    if config.field is not None:
        return _wanted_field(prepared, config)
    bandwidth = config.bandwidth or 1
    tail = np.where(np.arange(1, chamber.basis.n_modes + 1) < bandwidth, 1.0, 0.0)
    words = f"a map of {bandwidth} harmonics"
    return _Wanted(words, Tails(tail[None], words), None)


def _wanted_class(prepared: PreparedSurface, config: PlanConfig, progress: Progress) -> _Wanted:
    """Maps of the class drawn on this chamber, one of them to look at."""
    chamber, map_class = prepared.chamber, MAP_CLASSES[str(config.map_class)]
    rows = []
    for index, rng in enumerate(np.random.default_rng(config.seed).spawn(N_DRAWS)):
        progress("draw maps of the class", index, N_DRAWS)
        tails = class_tails(chamber, map_class, n_draws=1, rng=rng, **config.parameters)
        rows.append(tails.squared_errors[0])
    progress("draw maps of the class", N_DRAWS, N_DRAWS)
    rng = np.random.default_rng(config.seed).spawn(1)[0]
    drawn = map_class.draw(chamber.mesh, rng, allowed=chamber.accessible, **config.parameters)
    example = FieldMap(
        prepared.surface, drawn.values[: prepared.surface.n_vertices], drawn.name, drawn.unit
    )
    settings = map_class.settings(**config.parameters)
    told = ", ".join(_parameter_words(name, value) for name, value in settings.items())
    words = f"{map_class.title} ({told})"
    source = f"{N_DRAWS} maps drawn on this surface: {words}"
    return _Wanted(words, Tails(np.array(rows), source), example)


def _parameter_words(name: str, value: float) -> str:
    """A parameter as it is read: its name, the number and the unit its name ends in.

    >>> _parameter_words("width_mm", 8.0), _parameter_words("velocity_mm_per_ms", 0.8)
    ('width 8 mm', 'velocity 0.8 mm/ms')
    """
    for ending, unit in (("_mm_per_ms", "mm/ms"), ("_mm", "mm"), ("_ms", "ms")):
        if name.endswith(ending):
            return f"{name.removesuffix(ending).replace('_', ' ')} {value:g} {unit}"
    return f"{name.replace('_', ' ')} {value:g}"


def _wanted_field(prepared: PreparedSurface, config: PlanConfig) -> _Wanted:
    by_name = {each.name: each for each in prepared.fields}
    if config.field not in by_name:
        have = ", ".join(sorted(by_name)) or "none"
        raise InputError(f"no field named {config.field!r}: the surface has {have}")
    found = by_name[config.field]
    if found.values.ndim != 1:
        raise InputError(f"field {found.name!r} is a vector: choose one number a vertex")
    chamber = prepared.chamber
    columns = found.values[:, None]
    if config.cycle_length_ms is not None:
        phase = 2 * np.pi * found.values / config.cycle_length_ms
        columns = np.column_stack([np.cos(phase), np.sin(phase)])
    on_shell = np.full((chamber.mesh.n_vertices, columns.shape[1]), np.nan)
    on_shell[: len(columns)] = columns
    tail = truncation_tail(chamber, on_shell)
    words = f"a map like {found.name}"
    return _Wanted(words, Tails(tail[None], f"the map {found.name} on this surface"), found)


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


def _existing(path: Path | None, chamber: Chamber) -> tuple[Sites, tuple[str, ...]]:
    if path is None:
        return Sites.at_vertices([]), ()
    positions = read_positions(path)
    try:
        placed = place(Samples(positions, np.zeros(len(positions))), chamber)
    except InputError as fault:
        raise InputError(f"{path}: {fault}") from fault
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
