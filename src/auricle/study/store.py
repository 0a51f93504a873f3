"""Results on disk: JSON with units in the key names, arrays beside it, whole or absent."""

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from auricle.arrays import Floats
from auricle.atomic import write_text, write_whole
from auricle.sampling.criteria import Criterion
from auricle.spectral.harmonics import Harmonics
from auricle.study.provenance import versions
from auricle.study.result import CaseResult, Signal, Source

RESULT_FORMAT = "auricle result 1"


def json_text(document: Mapping[str, Any]) -> str:
    """A document as JSON: keys in order, numbers at full precision, no NaN, one final line feed."""
    return json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def result_document(result: CaseResult) -> dict[str, Any]:
    """Everything in a result but its arrays and timings, ready for JSON.

    The same input, version and parameters give the same document to the last digit.
    """
    return {
        "format": RESULT_FORMAT,
        "notice": "Research software, not a medical device.",
        "source": asdict(result.source),
        "parameters": asdict(result.config),
        "versions": dict(result.versions),
        "repairs": [asdict(repair) for repair in result.repairs],
        "remarks": list(result.remarks),
        "surface_as_read": asdict(result.original),
        "surface_analyzed": asdict(result.analyzed),
        "simplification_gd_mm": result.simplification_gd_mm,
        "shell": {
            "area_mm2": result.shell_area_mm2,
            "n_vertices": result.n_shell_vertices,
            "cap_areas_mm2": list(result.cap_areas_mm2),
            "laplacian": result.laplacian,
        },
        "certificate": asdict(result.certificate),
        "geometry": _signal_document(result.geometry),
        "geometry_errors": [asdict(error) for error in result.geometry_errors],
        "fields": [_signal_document(signal) for signal in result.fields],
        "simulated": [_signal_document(signal) for signal in result.simulated],
    }


def _signal_document(signal: Signal) -> dict[str, Any]:
    return {
        "name": signal.name,
        "title": signal.title,
        "unit": signal.field.unit,
        "unsampled_area_share": signal.unsampled_share,
        "details": dict(signal.details),
        "total_power": signal.spectrum.total,
        "constant_power": signal.spectrum.constant_power,
        "share_in_band": float(signal.spectrum.cumulative()[-1]),
        "criteria": [_criterion_document(each, signal) for each in signal.criteria],
        "for_error": [_criterion_document(each, signal) for each in signal.for_error],
    }


def _criterion_document(criterion: Criterion, signal: Signal) -> dict[str, Any]:
    need = criterion.need
    document = {
        "share": criterion.share,
        "with_constant": criterion.with_constant,
        "nrmse": criterion.nrmse,
        "reached_in_band": need is not None,
    }
    if need is not None:
        document |= asdict(need)
        document["measured_nrmse"] = float(signal.nrmse[need.n_modes - 1])
    return document


def write_harmonics(
    basis: Harmonics, folder: Path, *, source: Source, parameters: Mapping[str, Any]
) -> Path:
    """Write `modes.npy`, `areas.npy` and, last, `harmonics.json`; returns the last.

    The arrays are plain NumPy files that can be memory-mapped: modes of shape (n, k) in 1/mm,
    areas of shape (n,) in mm².
    """
    write_array(folder / "modes.npy", basis.modes)
    write_array(folder / "areas.npy", basis.areas)
    place = folder / "harmonics.json"
    document = {
        "format": "auricle harmonics 1",
        "source": asdict(source),
        "parameters": dict(parameters),
        "versions": versions(),
        "n_vertices": len(basis.areas),
        "n_modes": basis.n_modes,
        "area_mm2": basis.area,
        "laplacian": basis.laplacian,
        "zero_modes": basis.certificate.n_zero_modes,
        "certificate": asdict(basis.certificate),
        "eigenvalues_per_mm2": basis.eigenvalues.tolist(),
    }
    write_text(place, json_text(document))
    return place


def write_array(path: Path, array: Floats) -> None:
    """Write one array as .npy, whole or not at all."""
    write_whole(path, lambda place: _save(place, array))


def _save(path: Path, array: Floats) -> None:
    with path.open("wb") as file:
        np.save(file, array, allow_pickle=False)
