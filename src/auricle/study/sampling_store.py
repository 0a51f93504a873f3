"""Plans and reconstructions as JSON: units in the key names, no arrays, no timings."""

import math
from collections.abc import Mapping
from dataclasses import asdict, fields
from typing import Any

from auricle.sampling.bandwidth import Bracket
from auricle.sampling.coverage import Coverage
from auricle.sampling.next_point import NextPoint
from auricle.sampling.plan import SamplingPlan
from auricle.study.mapping_result import MappingConfig, MappingResult
from auricle.study.planning import PlanConfig, PlanResult
from auricle.study.preparation import PreparedSurface

NOTICE = "Research software, not a medical device."


def plan_document(result: PlanResult) -> dict[str, Any]:
    """A plan for JSON: the same input, version and parameters give the same document.

    ``n_samples`` counts what is recommended, those taken already included; null where no number
    suffices. ``predicted_nrmse`` is that of the plan's own points where there is a plan.
    """
    advised, plan = result.recommendation, result.plan
    predicted = plan.predicted_nrmse if plan is not None else advised.predicted_nrmse
    return {
        "format": "auricle plan 1",
        "notice": NOTICE,
        **_origin(result.prepared),
        "parameters": _parameters(result.config),
        "versions": dict(result.versions),
        "remarks": [*result.prepared.remarks, *result.remarks],
        "wanted": result.wanted,
        "n_samples": result.config.n_samples or advised.n_samples,
        "predicted_nrmse": predicted,
        "recommendation": asdict(advised),
        "by_target": [
            {"target_nrmse": target, "acquisition": how, **asdict(each)}
            for (target, how), each in result.by_target.items()
        ],
        "n_existing": len(result.existing),
        "plan": None if plan is None else _plan(plan),
    }


def mapping_document(result: MappingResult) -> dict[str, Any]:
    """A reconstruction for JSON: the same input, version and parameters give the same document."""
    return {
        "format": "auricle map 1",
        "notice": NOTICE,
        **_origin(result.prepared),
        "samples": asdict(result.samples_source),
        "parameters": _parameters(result.config),
        "versions": dict(result.versions),
        "remarks": [*result.prepared.remarks, *result.remarks],
        "name": result.placed.name,
        "unit": result.placed.unit,
        "n_samples": len(result.placed),
        "predicted_nrmse": result.predicted_nrmse,
        "enough": result.verdict.enough,
        "reasons": list(result.verdict.reasons),
        "hyperparameters": {
            "length_mm": result.hyperparameters.length,
            "amplitude": result.hyperparameters.amplitude,
            "noise": result.hyperparameters.noise,
            "smoothness": result.hyperparameters.smoothness,
        },
        "standardized_loo_variance": _finite(result.loo_variance),
        "bandwidth": [_bracket(each) for each in result.brackets],
        "undersampled_area_share": result.undersampled_share,
        "coverage": _coverage(result.coverage),
        "next_points": [
            _next(point, float(error))
            for point, error in zip(result.next_points, result.next_nrmse, strict=True)
        ],
        "progression": [
            {"n_samples": int(count), "predicted_nrmse": float(error)}
            for count, error in zip(
                result.progression.counts, result.progression.predicted_nrmse, strict=True
            )
        ],
        "cross_validation": {
            name: asdict(error) for name, error in result.cross_validation.items()
        },
    }


def _origin(prepared: PreparedSurface) -> dict[str, Any]:
    return {
        "source": asdict(prepared.source),
        "space": prepared.space,
        "repairs": [asdict(repair) for repair in prepared.repairs],
        "surface_analyzed": asdict(prepared.analyzed),
        "accessible_area_mm2": prepared.chamber.accessible_area,
        "shell_area_mm2": prepared.chamber.basis.area,
        "certificate": asdict(prepared.chamber.basis.certificate),
    }


def _parameters(config: PlanConfig | MappingConfig) -> dict[str, Any]:
    values = {each.name: getattr(config, each.name) for each in fields(config)}
    return {
        name: dict(value) if isinstance(value, Mapping) else value for name, value in values.items()
    }


def _plan(plan: SamplingPlan) -> dict[str, Any]:
    judged = plan.stability
    return {
        "design": plan.design,
        "n_planned": len(plan.planned),
        "vertices": plan.planned.tolist(),
        "n_modes": plan.n_modes,
        "predicted_nrmse": plan.predicted_nrmse,
        "stability": {
            "constant": judged.constant,
            "verdict": judged.verdict,
            "condition": _finite(judged.condition),
            "noise_gain": _finite(judged.noise_gain),
        },
        "error_bound": {
            "nrmse": _finite(plan.bound.nrmse),
            "statement": plan.bound.statement,
            "certified": plan.bound.certified,
        },
        "coverage": _coverage(plan.coverage),
    }


def _coverage(found: Coverage) -> dict[str, Any]:
    return {
        "radius_mm": found.radius_mm,
        "median_spacing_mm": _finite(found.spacing_mm),
        "density_per_cm2": found.density_per_cm2,
        "area_share_within_mm": {f"{radius:g}": share for radius, share in found.within.items()},
    }


def _bracket(found: Bracket) -> dict[str, Any]:
    return {
        "share": found.share,
        "nrmse": math.sqrt(1 - found.share),
        "lower_n_modes": found.lower,
        "upper_n_modes": found.upper,
    }


def _next(point: NextPoint, error: float) -> dict[str, Any]:
    return {
        "position_mm": point.position.tolist(),
        "vertex": point.vertex,
        "expected_drop_of_mean_variance": point.expected_drop,
        "predicted_nrmse": error,
    }


def _finite(value: float) -> float | None:
    """The number, or None where JSON has none: infinite, or not a number."""
    return value if math.isfinite(value) else None
