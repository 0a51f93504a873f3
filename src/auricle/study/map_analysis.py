"""Analysis of a vendor's study: each map and quantity judged by its own points."""

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from auricle.arrays import PerVertex, Points, Truths
from auricle.electroanatomy.points import UNITS, MappingPoints
from auricle.electroanatomy.points_csv import PointTable
from auricle.electroanatomy.study import ElectroanatomicMap, ElectroanatomicStudy
from auricle.errors import InputError
from auricle.progress import Progress, silent
from auricle.sampling.samples import Samples, place
from auricle.study.exports import export_source, read_export
from auricle.study.field_analysis import analyzed_field
from auricle.study.map_study import FIELDS, FieldAnalysis, MapAnalysis, MapStudy, MapStudyConfig
from auricle.study.mapping import rebuilt_map
from auricle.study.mapping_result import MappingConfig
from auricle.study.point_extent import point_extent
from auricle.study.preparation import PreparedSurface, prepare_soup
from auricle.study.provenance import versions
from auricle.study.result import Source

_VERTICES_A_MODE = 4
_TIME = "local_activation_time"


@dataclass(frozen=True, eq=False)
class _Case:
    """One map to analyse and what holds for all of them."""

    one: ElectroanatomicMap
    source: Source
    config: MapStudyConfig

    @property
    def points(self) -> MappingPoints:
        """Those that the vendor's map uses."""
        return self.one.points.chosen(self.one.points.included)

    @property
    def cycle_length(self) -> float | None:
        if self.config.cycle_length_ms is not None:
            return self.config.cycle_length_ms
        told = self.one.cycle_length
        return told if math.isfinite(told) and told > 0 else None


def analyze_export(
    path: Path,
    config: MapStudyConfig | None = None,
    *,
    table: PointTable | None = None,
    progress: Progress = silent,
) -> MapStudy:
    """Analyse every map of an export.

    Parameters
    ----------
    path
        A vendor's export, or a table of points.
    config
        The parameters.
    table
        How a table is written.
    progress
        Told the stages.

    Raises
    ------
    InputError
        If the export cannot be read or a parameter is at fault.
    SolverError
        If the harmonics miss their certificate.
    """
    begin = time.perf_counter()
    progress("read export", 0, 1)
    study = read_export(path, table=table, signals=False)
    source = export_source(path, study.system)
    progress("read export", 1, 1)
    found = analyze_study(study, config, source=source, progress=progress)
    return replace(found, seconds={"whole": time.perf_counter() - begin})


def analyze_study(
    study: ElectroanatomicStudy,
    config: MapStudyConfig | None = None,
    *,
    source: Source,
    progress: Progress = silent,
) -> MapStudy:
    """As `analyze_export`, of a study that has been read already.

    Raises
    ------
    InputError
        If it holds no map, or a quantity was asked for that no map has.
    SolverError
        If the harmonics miss their certificate.
    """
    config = config or MapStudyConfig()
    _require_fields(study, config)
    maps = tuple(
        _analyzed(_Case(one, source, config), number, len(study.maps), progress)
        for number, one in enumerate(study.maps, start=1)
    )
    return MapStudy(
        source=source,
        system=study.system,
        config=config,
        maps=maps,
        remarks=study.remarks,
        versions=versions(),
        seconds={},
    )


def used_positions(points: MappingPoints) -> Points:
    """Where points count, shape (n, 3), mm: as the vendor projected them, else as measured."""
    projected = _projected(points)
    used: Points = np.where(projected[:, None], points.projected_positions, points.positions)
    return used


def _projected(points: MappingPoints) -> Truths:
    """Which points the vendor has put on its surface."""
    return np.asarray(np.isfinite(points.projected_positions).all(axis=1))


def _require_fields(study: ElectroanatomicStudy, config: MapStudyConfig) -> None:
    if not study.maps:
        raise InputError("the export holds no map: export a study with maps")
    recorded = {name for one in study.maps for name in one.points.recorded}
    for name in config.fields:
        if name not in UNITS:
            raise InputError(f"no quantity {name!r}: choose from {', '.join(UNITS)}")
        if name not in recorded:
            held = ", ".join(sorted(recorded)) or "no values at points"
            raise InputError(f"no point has a {name}: the export holds {held}")


def _analyzed(case: _Case, number: int, n_maps: int, progress: Progress) -> MapAnalysis:
    progress("maps", number - 1, n_maps)
    points = case.points
    prepared, faults = _prepared(case, progress)
    remarks = [*case.one.remarks, *faults, *_remarks(case)]
    fields: list[FieldAnalysis] = []
    for name in _chosen(points, case.config):
        if prepared is None:
            break
        try:
            fields.append(_field(case, prepared, name, progress))
        except InputError as fault:
            remarks.append(f"{name} not analysed: {fault}")
    progress("maps", number, n_maps)
    return MapAnalysis(
        name=case.one.name,
        number=number,
        prepared=prepared,
        extent=point_extent(used_positions(points)),
        n_points=len(case.one.points),
        n_included=len(points),
        fields=tuple(fields),
        remarks=tuple(remarks),
    )


def _chosen(points: MappingPoints, config: MapStudyConfig) -> Iterator[str]:
    wanted = config.fields or FIELDS
    return (name for name in wanted if name in points.recorded)


def _prepared(case: _Case, progress: Progress) -> tuple[PreparedSurface | None, list[str]]:
    """The surface, if any point can be put on one; and why not."""
    soup, config = case.one.surface, case.config
    if soup is None:
        return None, ["no surface: only where its points lie can be said"]
    if not any(_chosen(case.points, config)):
        return None, []
    n_modes = min(config.n_modes, len(np.unique(soup.faces)) // _VERTICES_A_MODE)
    try:
        prepared = prepare_soup(
            soup,
            replace(case.source, name=f"{case.source.name}, {case.one.name}"),
            n_vertices=config.n_vertices,
            n_modes=n_modes,
            seed=config.seed,
            progress=progress,
        )
    except InputError as fault:
        return None, [f"surface not analysed: {fault}"]
    fewer = [f"{n_modes} harmonics, of {config.n_modes} asked for: the surface is coarse"]
    return prepared, fewer if n_modes < config.n_modes else []


def _remarks(case: _Case) -> Iterator[str]:
    points = case.one.points
    if not len(points):
        yield "no mapping points: nothing can be said of how well it was sampled"
        return
    left_out = len(points) - len(case.points)
    if left_out:
        yield f"points the vendor's map does not use left out: {left_out:,}"
    if not any(_chosen(case.points, case.config)):
        yield "no point holds a value of a quantity that is analysed"
    projected = _projected(case.points)
    if projected.any():
        moved = np.linalg.norm(
            (case.points.projected_positions - case.points.positions)[projected], axis=1
        )
        yield (
            f"{projected.sum():,} points are used where the system projected them, "
            f"{np.median(moved):.1f} mm from where they were measured in the median, "
            f"{moved.max():.1f} mm at most"
        )


def _field(case: _Case, prepared: PreparedSurface, name: str, progress: Progress) -> FieldAnalysis:
    config, points = case.config, case.points
    points = points.chosen(np.isfinite(getattr(points, name)))
    cycle = case.cycle_length if name == _TIME else None
    placed = place(
        Samples(used_positions(points), getattr(points, name), name=name, unit=UNITS[name]),
        prepared.chamber,
        max_distance=config.max_distance_mm,
        cycle_length=cycle,
    )
    mapping = MappingConfig(
        value=name,
        cycle_length_ms=cycle,
        max_distance_mm=config.max_distance_mm,
        target_nrmse=config.target_nrmse,
        n_next=0,
        n_vertices=config.n_vertices,
        n_modes=prepared.chamber.basis.n_modes,
        seed=config.seed,
    )
    rebuilt = rebuilt_map(
        prepared,
        (len(points), placed),
        mapping,
        source=case.source,
        validate=False,
        progress=progress,
    )
    identifiers = points.identifiers[placed.kept]
    return analyzed_field(rebuilt, config, identifiers, vendor=_vendor_values(prepared, name))


def _vendor_values(prepared: PreparedSurface, name: str) -> PerVertex | None:
    """The vendor's map on the surface, NaN where it has no value; None if there is none."""
    for field in prepared.fields:
        if field.name == name and field.values.ndim == 1 and field.sampled.any():
            return field.values
    return None
