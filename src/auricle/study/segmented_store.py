"""A segmented atrium as JSON: units in the key names, nothing of the patient, no timings."""

from dataclasses import asdict
from typing import Any

from auricle.imaging.mitral import MitralPlane
from auricle.imaging.segmentation import Segmentation
from auricle.imaging.veins import Branch
from auricle.imaging.verdict import Reason
from auricle.study.segmented import SegmentedCase


def segmentation_document(case: SegmentedCase) -> dict[str, Any]:
    """A segmentation for JSON: the same input, version and parameters give the same document."""
    found = case.segmentation
    return {
        "format": "auricle segmentation 1",
        "notice": "Research software, not a medical device.",
        "source": asdict(case.source),
        "labels": None if case.labels_source is None else asdict(case.labels_source),
        "parameters": asdict(case.config),
        "versions": dict(case.versions),
        "remarks": list(case.remarks),
        "shape": list(case.shape),
        "spacing_mm": list(case.spacing_mm),
        "space": "LPS",
        "verdict": case.verdict.value,
        "reasons": [reason_document(each) for each in case.reasons],
        "volume_ml": case.volume_ml,
        "mask_volume_ml": case.mask.volume_ml,
        "found": None if found is None else found_document(found),
        "surface": asdict(case.endocardium.soundness),
        "surface_spacing_mm": case.endocardium.spacing,
        "repairs": [asdict(repair) for repair in case.endocardium.repairs],
    }


def reason_document(reason: Reason) -> dict[str, Any]:
    """A reason for JSON: code, cause, remedy, whether it stops, and its place in mm, LPS."""
    return {
        "code": reason.code,
        "cause": reason.cause,
        "remedy": reason.remedy,
        "stops": reason.stops,
        "position_mm": None if reason.position is None else list(reason.position),
    }


def found_document(found: Segmentation) -> dict[str, Any]:
    """Seed, thresholds, measurements, mitral plane and branches for JSON."""
    seed = found.seed
    return {
        "seed": {"position_mm": seed.position.tolist(), "given": seed.given},
        "thresholds_hu": asdict(found.thresholds),
        "measurements": {
            name: value if abs(value) != float("inf") else None
            for name, value in found.measurements.items()
        },
        "mitral": None if found.mitral is None else _plane(found.mitral),
        "branches": [_branch(each) for each in found.branches],
    }


def _plane(plane: MitralPlane) -> dict[str, Any]:
    return {
        "centre_mm": plane.centre.tolist(),
        "normal": plane.normal.tolist(),
        "radius_mm": plane.radius,
        "deviation_mm": plane.deviation,
    }


def _branch(branch: Branch) -> dict[str, Any]:
    return {
        "kind": branch.kind,
        "ostium_mm": branch.ostium.tolist(),
        "radius_mm": branch.radius,
        "length_mm": branch.length,
        "volume_ml": branch.volume_ml,
    }
