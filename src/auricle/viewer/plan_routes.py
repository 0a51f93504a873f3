"""What the page asks of a plan: how many points a kind of map needs here, and where."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from auricle.errors import InputError
from auricle.progress import Progress
from auricle.sampling.plan import Design
from auricle.simulation.map_classes import MAP_CLASSES
from auricle.study.plan_result import CATHETERS, PlanConfig, PlanResult, checked_design
from auricle.study.planning import plan_prepared
from auricle.study.sampling_store import plan_document
from auricle.viewer.container import packed
from auricle.viewer.endpoints import Call, Endpoint, Work
from auricle.viewer.live_map import LiveMap
from auricle.viewer.open_case import OpenCase

_DESIGNS = {
    "farthest": "spread evenly",
    "pivoted_qr": "best conditioned (few points)",
    "a_optimal": "least mean variance",
    "d_optimal": "most information",
}
_NUMBERS = ("cycle_length_ms", "bandwidth", "target_nrmse", "noise_ratio", "n_samples", "quantile")
_COUNTS = ("bandwidth", "n_samples")
_WORDS = ("map_class", "field", "acquisition", "forbid", "catheter")


@dataclass(frozen=True, eq=False)
class OpenPlan:
    """The plan that is open in the page."""

    result: PlanResult


def choices(call: Call) -> Mapping[str, Any]:
    """What can be planned for: classes of maps with their parameters, fields, designs."""
    case = call.workspace.require(OpenCase, "no surface is open")
    return {
        "classes": [
            {
                "name": each.name,
                "title": each.title,
                "parameters": dict(each.parameters),
                "is_circular": each.is_circular,
            }
            for each in MAP_CLASSES.values()
        ],
        "fields": [
            {"name": each.name, "unit": each.unit}
            for each in case.prepared.fields
            if each.values.ndim == 1
        ],
        "designs": [{"name": name, "title": _DESIGNS[name]} for name in get_args(Design)],
        "catheters": list(CATHETERS),
        "n_modes": case.prepared.chamber.basis.n_modes,
    }


def plan(call: Call) -> Work:
    """Plan for what the document asks, with the names and units of `PlanConfig`.

    With ``beside_samples`` the samples of the live map count as taken.
    """
    workspace = call.workspace
    case = workspace.require(OpenCase, "no surface is open")
    told = call.document()
    config = _config(told, case)
    live = workspace.find(LiveMap) if told.get("beside_samples") else None
    existing = None if live is None or not live.n_taken else live.positions

    def run(progress: Progress) -> Mapping[str, Any]:
        result = plan_prepared(case.prepared, config, existing=existing, progress=progress)
        with workspace.lock:
            workspace.put(OpenPlan(result))
        return plan_document(result)

    return Work(run)


def plan_maps(call: Call) -> bytes:
    """Points, supported wavelength and an example of the maps of the open plan."""
    found = call.workspace.require(OpenPlan, "nothing is planned yet").result
    example = found.example
    arrays: dict[str, NDArray[Any]] = {"positions": found.positions.astype(np.float32)}
    if len(found.wavelengths):
        finite = np.where(np.isfinite(found.wavelengths), found.wavelengths, np.nan)
        arrays["wavelengths"] = finite.astype(np.float32)
    if example is not None:
        arrays["example"] = example.values.astype(np.float32)
    header = {
        "wanted": found.wanted,
        "example": None if example is None else {"name": example.name, "unit": example.unit},
    }
    return packed(header, arrays)


def _config(told: Mapping[str, Any], case: OpenCase) -> PlanConfig:
    asked: dict[str, Any] = {}
    for name in _NUMBERS:
        if told.get(name) is not None:
            value = _number(name, told[name])
            asked[name] = int(value) if name in _COUNTS else value
    for name in _WORDS:
        if told.get(name):
            asked[name] = str(told[name])
    parameters = told.get("parameters") or {}
    if not isinstance(parameters, dict):
        raise InputError("the parameters of a class are numbers by name: give those")
    return PlanConfig(
        **asked,
        parameters={str(name): _number(name, value) for name, value in parameters.items()},
        design=checked_design(str(told.get("design", "farthest"))),
        n_vertices=case.prepared.surface.n_vertices,
        n_modes=case.prepared.chamber.basis.n_modes,
    )


def _number(name: str, value: object) -> float:
    numeric = isinstance(value, int | float) and not isinstance(value, bool)
    if not numeric or not math.isfinite(float(str(value))):
        raise InputError(f"{name} {value!r}: give a number")
    return float(str(value))


ENDPOINTS = (
    Endpoint("GET", "/api/plan/choices", choices),
    Endpoint("POST", "/api/plan", plan),
    Endpoint("GET", "/api/plan/maps", plan_maps),
)
