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
from auricle.study.plan_result import PlanConfig, PlanResult
from auricle.study.preparation import PreparedSurface

NOTICE = "Research software, not a medical device."


def plan_document(result: PlanResult) -> dict[str, Any]:
    """A plan for JSON: the same input, version and parameters give the same document.

    ``n_samples`` is ``n_existing`` + ``n_planned``, what the map would rest on; null where there is
    no plan, since no number suffices. ``recommendation`` says how many there should be in all.
    """
    plan, placements = result.plan, result.placements
    return {
        "format": "auricle plan 1",
        "notice": NOTICE,
        **_origin(result.prepared),
        "parameters": _parameters(result.config),
        "versions": dict(result.versions),
        "remarks": [*result.prepared.remarks, *result.remarks],
        "wanted": result.wanted,
        "n_samples": None if plan is None else plan.n,
        "n_existing": len(result.existing),
        "n_planned": len(result.positions),
        "recommendation": asdict(result.recommendation),
        "by_target": [
            {"target_nrmse": target, "acquisition": how, **asdict(each)}
            for (target, how), each in result.by_target.items()
        ],
        "n_placements": None if placements is None else len(placements.centres),
        "plan": None if plan is None else _plan(plan),
    }


def mapping_document(result: MappingResult) -> dict[str, Any]:
    """A reconstruction for JSON: the same input, version and parameters give the same document.

    Amplitude, noise and error of samples left out are in ``unit``, as the values are; those of a
    re-entry's cosine and sine have none. What rests on a guess, as the samples say nothing, is
    null or absent.
    """
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
        "n_samples_merged": int(result.placed.counts.sum()),
        "knows_nothing": result.knows_nothing,
        "enough": result.verdict.enough,
        "reasons": list(result.verdict.reasons),
        "predicted_nrmse": _finite(result.predicted_nrmse),
        "predicted_nrmse_if_all_noise": _finite(result.smooth_nrmse),
        "noise_fitted": _finite(result.noise_fitted),
        "noise_stated": result.noise_stated,
        "hyperparameters": _hyperparameters(result),
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


def _hyperparameters(result: MappingResult) -> dict[str, Any] | None:
    found = result.hyperparameters
    if found is None:
        return None
    return {
        "length_mm": found.length,
        "amplitude": found.amplitude,
        "noise": found.noise,
        "smoothness": found.smoothness,
        "terms": [
            {"length_mm": term.length, "smoothness": term.smoothness, "share": term.share}
            for term in found.terms
        ],
        "splines": [
            {"power": term.power, "share": term.share, "smoothing": term.smoothing}
            for term in found.splines
        ],
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
        "vertices": plan.planned.tolist(),
        "n_modes": plan.n_modes,
        "predicted_nrmse_least_squares": plan.predicted_nrmse,
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
        "predicted_nrmse": _finite(error),
    }


def _finite(value: float) -> float | None:
    """The number, or None where JSON has none: infinite, or not a number."""
    return value if math.isfinite(value) else None
