"""What planning a case takes and gives: the parameters and the result of a plan."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from dataclasses import field as dataclass_field
from types import MappingProxyType
from typing import get_args

import numpy as np

from auricle.arrays import Floats, PerVertex
from auricle.errors import InputError
from auricle.sampling.catheter import (
    ElectrodePattern,
    Placements,
    circular_catheter,
    grid_catheter,
    linear_catheter,
    star_catheter,
)
from auricle.sampling.plan import Design, SamplingPlan
from auricle.sampling.recommendation import Recommendation
from auricle.sampling.sites import Sites
from auricle.sampling.tails import Tails
from auricle.simulation.map_classes import MAP_CLASSES
from auricle.study.preparation import N_MODES, N_VERTICES, PreparedSurface
from auricle.surface.field import FieldMap

CATHETERS: Mapping[str, Callable[[], ElectrodePattern]] = MappingProxyType(
    {
        "grid": grid_catheter,
        "star": star_catheter,
        "loop": circular_catheter,
        "row": linear_catheter,
    }
)
"""Common catheters by their shape."""


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
        Points to place, besides those taken already, instead of those still needed.
    forbid
        Name of a field of the surface: no point is placed where it is not 0.
    catheter
        A multi-electrode catheter that takes them (`CATHETERS`): placements are planned, as many
        as bring that number of electrodes onto the surface; None: one point at a time.
    design
        How single points are chosen: ``farthest``, ``pivoted_qr``, ``a_optimal``, ``d_optimal``.
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
    forbid: str | None = None
    catheter: str | None = None
    design: Design = "farthest"
    n_vertices: int = N_VERTICES
    n_modes: int = N_MODES
    seed: int = 1

    def __post_init__(self) -> None:
        object.__setattr__(self, "parameters", MappingProxyType(dict(self.parameters)))
        asked = [name is not None for name in (self.map_class, self.field, self.bandwidth)]
        if sum(asked) != 1:
            raise InputError("say what is to be mapped: a class of maps, a field or a bandwidth")
        _check_class(self.map_class, self.parameters)
        if self.bandwidth is not None and not 2 <= self.bandwidth <= self.n_modes:
            raise InputError(
                f"a bandwidth of {self.bandwidth} harmonics: give 2 to {self.n_modes}, or solve "
                "for more"
            )
        if not 0 < self.target_nrmse < 1:
            raise InputError(f"a target error of {self.target_nrmse}: give more than 0, below 1")
        if not 0 <= self.noise_ratio < math.inf:
            raise InputError(f"a noise of {self.noise_ratio} deviations: give 0 or more")
        if self.n_samples is not None and self.n_samples < 1:
            raise InputError(f"{self.n_samples} samples: ask for at least 1")
        if self.catheter is not None and self.catheter not in CATHETERS:
            raise InputError(f"no catheter {self.catheter!r}: choose from {', '.join(CATHETERS)}")
        self._check_cycle()

    def _check_cycle(self) -> None:
        cycle = self.cycle_length_ms
        if cycle is not None and not 0 < cycle < math.inf:
            raise InputError(f"a cycle length of {cycle} ms: give a positive number")
        if cycle is not None and self.field is None:
            raise InputError("a cycle length belongs to a map that is given: name its field too")


def _check_class(name: str | None, parameters: Mapping[str, float]) -> None:
    if name is None:
        if parameters:
            raise InputError("parameters belong to a class of maps: name the class too")
        return
    if name not in MAP_CLASSES:
        raise InputError(f"no class of maps {name!r}: choose from {', '.join(MAP_CLASSES)}")
    MAP_CLASSES[name].settings(**parameters)


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
        The points, those taken already included; None where no number suffices, none was given
        and none is taken.
    placements
        Of the catheter, its electrodes being the plan's points; None if there is no catheter.
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
    placements: Placements | None
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
        every = self.plan.sites.positions(self.prepared.chamber.mesh)
        return every[len(self.existing) :]


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
