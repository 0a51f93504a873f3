"""What analysing a vendor's study takes and gives: parameters and results, field by field."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from auricle.arrays import Integers, PerVertex, Truths
from auricle.errors import InputError
from auricle.study.conduction_velocity import ConductionVelocity
from auricle.study.low_voltage import THRESHOLD_MV, LowVoltage
from auricle.study.mapping_result import MappingResult
from auricle.study.point_extent import PointExtent
from auricle.study.preparation import N_MODES, N_VERTICES, PreparedSurface
from auricle.study.redundancy import Redundancy
from auricle.study.result import Source
from auricle.study.vendor_comparison import VendorComparison

FIELDS = ("local_activation_time", "bipolar_voltage", "unipolar_voltage")
"""Quantities that are analysed unless others are named."""


@dataclass(frozen=True)
class MapStudyConfig:
    """How the maps of a study are judged.

    Attributes
    ----------
    fields
        Quantities to analyse, by OpenEP's names; empty: those of `FIELDS` that were recorded.
    target_nrmse
        Error at which sampling is enough.
    cycle_length_ms
        Period of activation times that wrap round; None: as the export says, if it does.
    max_distance_mm
        How far off the surface a point may lie.
    mapped_within_mm
        A place counts as mapped if a point lies within this distance along the surface.
    low_voltage_mv
        Bipolar voltage below which wall counts as of low voltage.
    n_draws
        Maps drawn to say how sure areas and velocities are.
    n_vertices, n_modes
        Vertices to simplify to, harmonics to solve for.
    seed
        Of everything random.
    """

    fields: tuple[str, ...] = ()
    target_nrmse: float = 0.1
    cycle_length_ms: float | None = None
    max_distance_mm: float = 5.0
    mapped_within_mm: float = 10.0
    low_voltage_mv: float = THRESHOLD_MV
    n_draws: int = 100
    n_vertices: int = N_VERTICES
    n_modes: int = N_MODES
    seed: int = 1

    def __post_init__(self) -> None:
        if not 0 < self.target_nrmse < 1:
            raise InputError(f"a target error of {self.target_nrmse}: give more than 0, below 1")
        for words, value in (
            ("cycle length", self.cycle_length_ms or 1.0),
            ("farthest distance", self.max_distance_mm),
            ("distance mapped", self.mapped_within_mm),
            ("low voltage", self.low_voltage_mv),
        ):
            if not 0 < value < float("inf"):
                raise InputError(f"{words} {value}: give a positive number")
        if self.n_draws < 20:
            raise InputError(f"{self.n_draws} maps drawn: ask for 20 or more")


@dataclass(frozen=True, eq=False)
class FieldAnalysis:
    """One quantity of one map.

    Attributes
    ----------
    rebuilt
        The reconstruction, its uncertainty, coverage, bandwidth and local Nyquist.
    identifiers
        Number of the mapping point of each sample placed, shape (m,); of several in one place
        the first.
    mapped, mapped_share
        Vertices of the surface that count as mapped, shape (n,), and their share of the area.
    undersampled_share
        Share of the mapped area that is sampled too sparsely for the map's bandwidth.
    fill_shares
        Share of the surface within each of `FILL_DISTANCES_MM` of a point.
    redundancy
        How the error over the mapped part rises as points are taken out; None where nothing is
        known of the map.
    vendor_values
        The vendor's own map at the surface's vertices, NaN where it has none, shape (n,); None
        if there is none.
    vendor
        How it compares; None if it does not.
    low_voltage, velocity
        Of bipolar voltage and of activation times; None for others.
    """

    rebuilt: MappingResult
    identifiers: Integers
    mapped: Truths
    mapped_share: float
    undersampled_share: float
    fill_shares: Mapping[str, float]
    redundancy: Redundancy | None
    vendor_values: PerVertex | None
    vendor: VendorComparison | None
    low_voltage: LowVoltage | None
    velocity: ConductionVelocity | None

    @property
    def name(self) -> str:
        """OpenEP's name of the quantity."""
        return self.rebuilt.placed.name

    @property
    def knows_nothing(self) -> bool:
        """Whether the points say too little of the map for any number to be believed."""
        return self.redundancy is None

    @property
    def mapped_nrmse(self) -> float:
        """Expected error over the mapped part, relative to the map's deviation; NaN if unknown."""
        return math.nan if self.redundancy is None else float(self.redundancy.nrmse[0])

    @property
    def n_sufficient(self) -> int | None:
        """Points that would have been enough for the target there; None if all are not."""
        if self.redundancy is None:
            return None
        return self.redundancy.enough_for(self.rebuilt.config.target_nrmse)


@dataclass(frozen=True, eq=False)
class MapAnalysis:
    """One map of a study.

    Attributes
    ----------
    name, number
        What it is called, and its place in the study, from 1.
    prepared
        Its surface; None if there is none that can be analysed.
    extent
        Its points as they lie in space; None if there are none.
    n_points, n_included
        How many there are, and how many of them the vendor's map uses.
    fields
        What was measured there.
    remarks
        What was left out or cannot be said, one phrase each.
    """

    name: str
    number: int
    prepared: PreparedSurface | None
    extent: PointExtent | None
    n_points: int
    n_included: int
    fields: tuple[FieldAnalysis, ...]
    remarks: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class MapStudy:
    """All maps of an export, analysed.

    Attributes
    ----------
    source
        What the export is known by; not its name, which may be a patient's.
    system
        The mapping system.
    config
        The parameters.
    maps
        In the order of the export.
    remarks
        What was left out of the export as a whole.
    versions, seconds
        Of auricle and the libraries; wall time by stage.
    """

    source: Source
    system: str
    config: MapStudyConfig
    maps: tuple[MapAnalysis, ...]
    remarks: tuple[str, ...]
    versions: Mapping[str, str]
    seconds: Mapping[str, float]
