"""An analysed study as JSON, units in the key names, and the points of its maps as tables."""

import csv
import io
import math
from collections.abc import Mapping
from dataclasses import asdict, fields
from typing import Any

import numpy as np

from auricle.study.conduction_velocity import ConductionVelocity
from auricle.study.low_voltage import LowVoltage
from auricle.study.map_study import FieldAnalysis, MapAnalysis, MapStudy
from auricle.study.point_extent import PointExtent
from auricle.study.sampling_store import NOTICE, mapping_document
from auricle.study.vendor_comparison import VendorComparison
from auricle.surface.field import FieldMap

_KEPT = (
    "name",
    "unit",
    "n_samples",
    "knows_nothing",
    "enough",
    "reasons",
    "predicted_nrmse",
    "predicted_nrmse_if_all_noise",
    "noise_fitted",
    "hyperparameters",
    "standardized_loo_variance",
    "bandwidth",
    "undersampled_area_share",
    "coverage",
)
"""What of a reconstruction's document is told of every quantity."""


def map_study_document(study: MapStudy) -> dict[str, Any]:
    """A study for JSON: the same export, version and parameters give the same document."""
    return {
        "format": "auricle map study 1",
        "notice": NOTICE,
        "system": study.system,
        "n_bytes": study.source.n_bytes,
        "sha256": study.source.sha256,
        "parameters": asdict(study.config),
        "versions": dict(study.versions),
        "remarks": list(study.remarks),
        "maps": [_map(one) for one in study.maps],
    }


def points_csv(field: FieldAnalysis) -> str:
    """The points used of one quantity: where on the surface, the value, and what each is worth.

    ``order_dispensable`` is 1 for the point that is missed least; empty for the few that are never
    taken out. ``redundant`` is 1 for those that can all be left out together. Both, and
    residuals, are empty where nothing is known of the map.
    """
    result, less = field.rebuilt, field.redundancy
    orders = np.full(len(result.placed), -1)
    if less is not None:
        orders[less.removed] = np.arange(1, len(less.removed) + 1)
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    unit = result.placed.unit
    writer.writerow(
        [
            *("point", "x_mm", "y_mm", "z_mm", f"{field.name}_{unit}", "n_merged"),
            *(f"residual_{unit}", "order_dispensable", "redundant"),
        ]
    )
    positions = result.placed.sites.positions(result.prepared.chamber.mesh)
    for index, position in enumerate(positions.tolist()):
        order = int(orders[index])
        redundant = "" if less is None else int(0 < order <= less.n_redundant)
        writer.writerow(
            [
                int(field.identifiers[index]),
                *(f"{value:.3f}" for value in position),
                f"{result.placed.values[index]:.6g}",
                int(result.placed.counts[index]),
                _words(float(result.residuals[index])),
                order if order > 0 else "",
                redundant,
            ]
        )
    return file.getvalue()


def map_fields(one: MapAnalysis) -> list[FieldMap]:
    """All that was found of a map, as fields on its analysed surface."""
    found: list[FieldMap] = []
    for field in one.fields:
        result, name = field.rebuilt, field.name
        mesh, unit = result.prepared.surface, result.placed.unit
        if field.vendor_values is not None:
            found.append(FieldMap(mesh, field.vendor_values, f"{name}_vendor", unit))
        found.append(FieldMap(mesh, field.mapped.astype(float), f"{name}_mapped"))
        if field.knows_nothing:
            continue
        waves = np.where(np.isfinite(result.wavelengths), result.wavelengths, np.nan)
        values = np.where(result.singular, np.nan, result.mean)
        found += [
            FieldMap(mesh, values, name, unit),
            FieldMap(mesh, result.std, f"{name}_standard_deviation", unit),
            FieldMap(mesh, waves, f"{name}_supported_wavelength", "mm"),
            FieldMap(mesh, result.undersampled.astype(float), f"{name}_undersampled"),
        ]
        if field.velocity is not None:
            local = field.velocity
            found += [
                FieldMap(mesh, local.local, "conduction_velocity", "m/s"),
                FieldMap(mesh, local.local_low, "conduction_velocity_5_percent", "m/s"),
                FieldMap(mesh, local.local_high, "conduction_velocity_95_percent", "m/s"),
            ]
    return found


def _map(one: MapAnalysis) -> dict[str, Any]:
    prepared = one.prepared
    return {
        "name": one.name,
        "number": one.number,
        "n_points": one.n_points,
        "n_included": one.n_included,
        "extent": None if one.extent is None else _extent(one.extent),
        "space": None if prepared is None else prepared.space,
        "surface_area_mm2": None if prepared is None else prepared.chamber.accessible_area,
        "repairs": [] if prepared is None else [asdict(repair) for repair in prepared.repairs],
        "remarks": [*(() if prepared is None else prepared.remarks), *one.remarks],
        "quantities": [_field(each) for each in one.fields],
    }


def _extent(found: PointExtent) -> dict[str, Any]:
    return _told({**asdict(found), "sides_mm": list(found.sides_mm)})


def _field(field: FieldAnalysis) -> dict[str, Any]:
    whole = mapping_document(field.rebuilt)
    less = field.redundancy
    return {
        **{key: whole[key] for key in _KEPT},
        "cycle_length_ms": field.rebuilt.config.cycle_length_ms,
        "remarks": list(field.rebuilt.placed.remarks),
        "mapped_area_share": field.mapped_share,
        "mapped_predicted_nrmse": _finite(field.mapped_nrmse),
        "mapped_undersampled_area_share": None if less is None else field.undersampled_share,
        "area_share_within_fill_distance": dict(field.fill_shares),
        "n_sufficient": field.n_sufficient,
        "n_redundant": None if less is None else less.n_redundant,
        "vendor": _vendor(field.vendor),
        "low_voltage": _low_voltage(field.low_voltage),
        "conduction_velocity": _velocity(field.velocity),
    }


def _vendor(found: VendorComparison | None) -> dict[str, Any] | None:
    return None if found is None else _told(asdict(found))


def _low_voltage(found: LowVoltage | None) -> dict[str, Any] | None:
    return None if found is None else _told(asdict(found))


def _velocity(found: ConductionVelocity | None) -> dict[str, Any] | None:
    if found is None:
        return None
    numbers = {
        f"{each.name}_m_per_s": getattr(found, each.name)
        for each in fields(found)
        if not each.name.startswith("local")
    }
    return _told(numbers)


def _told(numbers: Mapping[str, Any]) -> dict[str, Any]:
    """The same with None where JSON has no number."""
    return {
        key: _finite(value) if isinstance(value, float) else value for key, value in numbers.items()
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _words(value: float) -> str:
    return f"{value:.4g}" if math.isfinite(value) else ""
