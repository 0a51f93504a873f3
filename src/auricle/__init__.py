"""auricle: how many points a cardiac map needs, where, and how sure one can be.

The names most programs need stand here and are loaded when first used; everything else is in the
rooms they come from.
"""

from importlib import import_module
from typing import Any

__version__ = "0.1.0"

_ROOM_OF = {
    "AnalysisConfig": "study.config",
    "AuricleError": "errors",
    "CaseResult": "study.result",
    "Criterion": "sampling.criteria",
    "FieldMap": "surface.field",
    "Harmonics": "spectral.harmonics",
    "Mesh": "surface.mesh",
    "Shell": "sampling.criteria",
    "Spectrum": "spectral.power",
    "analyze_surface": "study.case",
    "cap_holes": "surface.capping",
    "clean": "surface.cleaning",
    "criteria": "sampling.criteria",
    "focal_map": "simulation.foci",
    "geometric_distance": "surface.distance",
    "manifold_harmonics": "spectral.harmonics",
    "read_surface": "surface.reading",
    "simplification_sequence": "surface.simplification",
    "simplify": "surface.simplification",
    "simplify_with_fields": "surface.simplification",
    "soundness": "surface.soundness",
    "write_report": "report.bundle",
    "write_surface": "surface.writing",
}

__all__ = ["__version__", *_ROOM_OF]


def __getattr__(name: str) -> Any:
    if name not in _ROOM_OF:
        raise AttributeError(f"module 'auricle' has no attribute {name!r}")
    return getattr(import_module(f"auricle.{_ROOM_OF[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
