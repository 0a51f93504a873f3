"""Electrograms on disk: the samples in one ``.npz``, all else in JSON beside it."""

import math
from pathlib import Path
from typing import Any

import numpy as np

from auricle.atomic import write_text, write_whole
from auricle.electroanatomy.electrogram import Electrogram
from auricle.electroanatomy.study import ElectroanatomicMap
from auricle.study.store import json_text


def write_electrograms(folder: Path, one: ElectroanatomicMap) -> None:
    """Write the electrograms of a map to ``electrograms.npz`` and ``electrograms.json``.

    The archive holds an array ``point_N`` for each mapping point that has signals, N its number
    in ``points.csv``, of shape (samples, channels), float64, mV; the JSON its sampling rate,
    channels, their roles, annotations (sample index from 0) and window of interest (ms).

    Raises
    ------
    OutputError
        If they cannot be written.
    """
    names = {row: f"point_{one.points.identifiers[row]}" for row in sorted(one.electrograms)}
    arrays = {name: one.electrograms[row].samples for row, name in names.items()}
    write_whole(folder / "electrograms.npz", lambda place: _save(place, arrays))
    document = {
        "format": "auricle electrograms 1",
        "unit": "mV",
        "electrograms": {
            name: {"row": row + 1, **_description(one.electrograms[row])}
            for row, name in names.items()
        },
    }
    write_text(folder / "electrograms.json", json_text(document))


def _save(place: Path, arrays: dict[str, np.ndarray]) -> None:
    with place.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **arrays)


def _description(signal: Electrogram) -> dict[str, Any]:
    window = [_finite(edge) for edge in signal.window_of_interest]
    return {
        "sampling_rate_hz": signal.sampling_rate,
        "channels": list(signal.channels),
        "bipolar": signal.bipolar or None,
        "unipolar": signal.unipolar or None,
        "reference": signal.reference or None,
        "reference_annotation_sample": _finite(signal.reference_annotation),
        "map_annotation_sample": _finite(signal.map_annotation),
        "window_of_interest_ms": None if None in window else window,
    }


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
