"""Tables of a study's maps: all of them side by side, and each quantity's own numbers."""

import math

from auricle.report.tables import Table
from auricle.report.wording import field_words, number, percent, printable
from auricle.sampling.criteria import POINTS_PER_HARMONIC
from auricle.sampling.literature import FILL_DISTANCES_MM
from auricle.study.conduction_velocity import ConductionVelocity
from auricle.study.low_voltage import LowVoltage
from auricle.study.map_study import FieldAnalysis, MapStudy
from auricle.study.point_extent import PointExtent
from auricle.study.vendor_comparison import VendorComparison

_NOTHING = "–"
_QUANTITY = ("Quantity", "Value")


def points_table(study: MapStudy) -> Table:
    """Every map and quantity in a row: points, density, error, how many would have done."""
    rows = tuple(
        (f"{printable(one.name)}, {field_words(field.name)}", *_overview(field))
        for one in study.maps
        for field in one.fields
    )
    head = (
        "Map",
        "places with a value",
        "per cm²",
        "farthest place, mm",
        "mapped",
        "error there",
        "too sparse there",
        "enough for the target",
        "redundant",
    )
    within = f"within {study.config.mapped_within_mm:g} mm of a point along the surface"
    return Table(f"Side by side (mapped: {within})", head, rows)


def fill_table(study: MapStudy) -> Table:
    """Share of the surface within the distances up to which systems colour their maps."""
    rows = tuple(
        (
            f"{printable(one.name)}, {field_words(field.name)}",
            *(percent(field.fill_shares[words]) for words in FILL_DISTANCES_MM),
        )
        for one in study.maps
        for field in one.fields
    )
    head = ("Map", *(f"{words}: {mm:g} mm" for words, mm in FILL_DISTANCES_MM.items()))
    return Table("Surface within the fill distances that mapping systems use", head, rows)


def extent_table(found: PointExtent) -> Table:
    """Where the points of a map lie in space."""
    sides = " × ".join(number(side) for side in found.sides_mm)
    hull = _NOTHING
    if math.isfinite(found.hull_area_mm2):
        hull = (
            f"{number(found.hull_area_mm2 / 100)} cm², {number(found.per_cm2_of_hull)} places per "
            "cm² of it"
        )
    rows = (
        ("Places that differ", f"{found.n_places:,}"),
        ("Box along the axes", f"{sides} mm"),
        ("Median distance to the nearest other, straight", _with_mm(found.spacing_mm)),
        ("Largest of these distances", _with_mm(found.largest_gap_mm)),
        ("Convex hull (cuts across hollows: a scale, not an area of wall)", hull),
    )
    return Table("The points in space", _QUANTITY, rows)


def quantity_tables(field: FieldAnalysis) -> tuple[Table, ...]:
    """The numbers of one quantity of one map."""
    tables = [_sampling_table(field)]
    if field.vendor is not None:
        tables.append(_vendor_table(field.vendor, field.rebuilt.placed.unit))
    if field.low_voltage is not None:
        tables.append(_low_voltage_table(field.low_voltage))
    if field.velocity is not None:
        tables.append(_velocity_table(field.velocity))
    return tuple(tables)


def parameters_table(study: MapStudy) -> Table:
    """What the user may change."""
    config = study.config
    cycle = config.cycle_length_ms
    rows = (
        ("Target error", percent(config.target_nrmse)),
        ("Cycle length", "as the export says" if cycle is None else f"{cycle:g} ms"),
        ("Farthest a point may lie off the surface", f"{config.max_distance_mm:g} mm"),
        ("Mapped: within", f"{config.mapped_within_mm:g} mm of a point"),
        ("Low voltage: below", f"{config.low_voltage_mv:g} mV"),
        ("Maps drawn", f"{config.n_draws:,}"),
        ("Vertices to simplify to", f"{config.n_vertices:,}"),
        ("Harmonics to solve for", f"{config.n_modes:,}"),
        ("Seed", str(config.seed)),
    )
    return Table("Parameters of this run", ("Parameter", "Value"), rows)


def _overview(field: FieldAnalysis) -> tuple[str, ...]:
    result, less = field.rebuilt, field.redundancy
    density = number(result.coverage.density_per_cm2)
    gap = number(result.coverage.radius_mm)
    known = (f"{len(result.placed):,}", density, gap, percent(field.mapped_share))
    if less is None:
        return (*known, "nothing is known", _NOTHING, _NOTHING, _NOTHING)
    enough = field.n_sufficient
    return (
        *known,
        percent(field.mapped_nrmse),
        percent(field.undersampled_share),
        "not even all" if enough is None else f"{enough:,}",
        f"{less.n_redundant:,}",
    )


def _sampling_table(field: FieldAnalysis) -> Table:
    result, less = field.rebuilt, field.redundancy
    rows = [
        ("Places with a value", f"{len(result.placed):,}"),
        ("Density over the whole surface", f"{number(result.coverage.density_per_cm2)} per cm²"),
        ("Median distance to the nearest other", _with_mm(result.coverage.spacing_mm)),
        ("Farthest place from any point", f"{number(result.coverage.radius_mm)} mm"),
        ("Share of the surface mapped", percent(field.mapped_share)),
    ]
    if less is not None:
        rows += [
            ("Expected error of the mapped part", percent(field.mapped_nrmse)),
            ("Expected error of the whole surface", percent(result.predicted_nrmse)),
            (
                "Mapped part sampled too sparsely for the bandwidth",
                percent(field.undersampled_share),
            ),
            ("Points that can be left out, error up by 5 %", f"{less.n_redundant:,}"),
            *_bandwidth_rows(field),
        ]
    return Table("Sampling", _QUANTITY, tuple(rows))


def _bandwidth_rows(field: FieldAnalysis) -> list[tuple[str, str]]:
    """The bracket of the bandwidth, and the points it asks for if they are spread evenly."""
    result = field.rebuilt
    chamber = result.prepared.chamber
    share = chamber.accessible_area / chamber.basis.area
    rows = []
    for each in result.brackets:
        error = percent(math.sqrt(1 - each.share))
        ends = [
            math.ceil(POINTS_PER_HARMONIC["planned"] * modes * share)
            for modes in (each.lower, each.upper)
        ]
        rows.append(
            (
                f"Bandwidth for an error of {error}, whole surface",
                f"{_range(each.lower, each.upper)} harmonics: {_range(*ends)} points spread evenly",
            )
        )
    return rows


def _vendor_table(found: VendorComparison, unit: str) -> Table:
    rows = (
        ("Surface on which the system's map has a value", percent(found.coloured_share)),
        (
            "Difference, root mean square over the mapped part",
            f"{number(found.rms_difference)} {unit}",
        ),
        ("The same, of the system's map's deviation", _share(found.relative)),
        (
            "Mapped part where they differ by more than two standard deviations",
            percent(found.beyond_share),
        ),
        (
            "System's map from the points' values, root mean square",
            f"{number(found.vendor_at_points)} {unit}",
        ),
        (
            "Rebuilt map from the points' values, root mean square",
            f"{number(found.map_at_points)} {unit}",
        ),
    )
    return Table("The mapping system's own map beside this one", _QUANTITY, rows)


def _low_voltage_table(found: LowVoltage) -> Table:
    rows = [
        ("Area mapped", _area(found.mapped_mm2)),
        (f"Below {found.threshold_mv:g} mV, expected", _area(found.expected_mm2)),
        (
            "Nine maps of ten that fit the points",
            f"{_area(found.low_mm2)} to {_area(found.high_mm2)}",
        ),
        ("On the most probable map, which is smoother", _area(found.of_map_mm2)),
        ("Share of the points", percent(found.share_of_points)),
    ]
    if math.isfinite(found.vendor_mm2):
        rows.append(("On the system's own map, where it has a value", _area(found.vendor_mm2)))
        rows.append(("Mapped area with a value of the system's", _area(found.vendor_mapped_mm2)))
    return Table("Low voltage, within the mapped part", _QUANTITY, tuple(rows))


def _velocity_table(found: ConductionVelocity) -> Table:
    rows = [
        ("Median over the mapped area, expected", f"{number(found.expected)} m/s"),
        (
            "Nine maps of ten that fit the points",
            f"{number(found.low)} to {number(found.high)} m/s",
        ),
    ]
    rows.append(
        ("On the most probable map, which is smoother and so faster", f"{number(found.of_map)} m/s")
    )
    if math.isfinite(found.vendor):
        rows.append(("On the system's own map", f"{number(found.vendor)} m/s"))
    return Table("Conduction velocity", _QUANTITY, tuple(rows))


def _with_mm(value: float) -> str:
    return f"{number(value)} mm" if math.isfinite(value) else _NOTHING


def _range(low: int, high: int) -> str:
    return f"{low:,}" if low == high else f"{low:,} to {high:,}"


def _area(area_mm2: float) -> str:
    return f"{number(area_mm2 / 100)} cm²"


def _share(value: float) -> str:
    return percent(value) if math.isfinite(value) else _NOTHING
