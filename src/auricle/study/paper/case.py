"""One case of the paper's study: from a CT or a surface to all its numbers."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from auricle.errors import InputError
from auricle.progress import Progress, silent
from auricle.simulation.phantom import truth_surface
from auricle.spectral.harmonics import manifold_harmonics
from auricle.study.clock import Clock
from auricle.study.paper.beyond import (
    class_records,
    main_counts,
    recovered,
    resolved,
    width_curve,
)
from auricle.study.paper.conventions import convention_counts
from auricle.study.paper.features import (
    Stage,
    feature_records,
    marched_foci,
    modes_holding,
    places_of,
    significant,
)
from auricle.study.paper.parameters import PaperParameters
from auricle.study.paper.quality import decays, power_laws, quality_of_harmonics, quality_of_points
from auricle.study.paper.source import OriginalSurface, original_surface
from auricle.study.paper.surfaces import kept_surfaces
from auricle.study.paper.thinned_features import thinned_records
from auricle.study.provenance import versions
from auricle.surface.capping import cap_holes
from auricle.surface.distance import geometric_distance
from auricle.surface.mesh import Mesh
from auricle.surface.simplification import simplification_sequence, simplify
from auricle.surface.soundness import soundness

CASE_FORMAT = "auricle paper case 1"
FURTHER_SHARES = (0.95, 0.99, 0.999)
"""Of the geometry's power, which its first few harmonics hold almost all of."""


@dataclass(frozen=True, eq=False)
class CaseDocument:
    """All that is known of one case.

    Attributes
    ----------
    values
        Ready for JSON; the same input, parameters and version give the same to the byte.
    timings
        Wall time by stage, s; apart, since it is never the same.
    """

    values: dict[str, Any]
    timings: dict[str, float]


def run_case(
    source: Path,
    *,
    parameters: PaperParameters | None = None,
    progress: Progress = silent,
) -> CaseDocument:
    """The paper's procedure on one atrium, and what goes beyond it.

    Surface → Qslim → harmonics → spectra of x, y and z, error of the surface rebuilt from
    harmonics and of the one thinned out, τ, focal maps at many places, harmonics for shares of
    their power, Qslim with the map in the fourth component; further widths and classes of maps;
    the conventions of the paper's numbers. Holes
    are closed by caps first: harmonics, both rebuilt surfaces and their errors are of the closed
    surface, as the paper's are; foci are placed on the real part of it.

    Parameters
    ----------
    source
        A surface file, a contrast CT, or a text as ``phantom:seed=3,preset=medium``.
    parameters
        Of the study.
    progress
        Told the stages.

    Raises
    ------
    InputError
        If the input cannot be used.
    SolverError
        If the harmonics miss their certificate.
    """
    parameters = parameters or PaperParameters()
    clock = Clock(progress)
    with clock.stage("surface"):
        original = original_surface(source, accept_check=parameters.accept_check, progress=progress)
        _require_size(original.cleaned.mesh, parameters)
    with clock.stage("simplify"):
        stage_surface = simplify(original.cleaned.mesh, parameters.n_vertices)
        capped = cap_holes(stage_surface)
    with clock.stage("harmonics"):
        basis = manifold_harmonics(
            capped.mesh, parameters.n_modes, seed=parameters.seed, threads=1, progress=progress
        )
    stage = Stage(stage_surface, capped, basis)
    with clock.stage("reconstruction"):
        rebuilt = _rebuilt(stage, parameters)
        measured = {
            count: mesh for count, mesh in rebuilt.items() if count in parameters.coefficient_counts
        }
        mha = quality_of_harmonics(capped.mesh, measured)
    with clock.stage("qslim"):
        sequence = simplification_sequence(capped.mesh)
        qslim = quality_of_points(sequence, parameters.point_counts)
    quality = {"mha": mha, "qslim": qslim}
    with clock.stage("decay"):
        fitted = decays(quality, parameters.fitted_counts)
    with clock.stage("features"):
        places = places_of(stage.surface, parameters)
        widest = max((*parameters.focus_widths_mm, *parameters.curve_widths_mm), default=1.0)
        foci = marched_foci(stage, places, widest_mm=widest)
        features = feature_records(stage, foci, parameters)
    with clock.stage("qslim of features"):
        thinned = thinned_records(stage, foci, sequence, parameters)
    with clock.stage("further maps"):
        beyond: dict[str, Any] = {
            "width_curve": width_curve(stage, foci, parameters),
            "classes": class_records(stage, parameters),
            "recovered": recovered(stage, rebuilt, foci, parameters),
        }
    with clock.stage("resolution"):
        beyond["resolution"] = [
            resolved(original.cleaned.mesh, count, places, parameters)
            for count in parameters.finer_vertices
            if count <= original.cleaned.mesh.n_vertices
        ]
    with clock.stage("segmentation error"):
        beyond["segmentation_error"] = _segmentation_error(original, stage, places, parameters)
    conventions: dict[str, Any] = {}
    if parameters.convention_vertices:
        with clock.stage("conventions"):
            conventions = convention_counts(
                capped.mesh,
                parameters=parameters,
                harmonics=basis,
                places=places,
                progress=progress,
            )
    with clock.stage("surfaces"):
        surfaces = kept_surfaces(stage, rebuilt, sequence, foci, parameters)
    values = {
        "format": CASE_FORMAT,
        "notice": "Research software, not a medical device.",
        **_provenance(original, parameters),
        **_surface_values(original, stage),
        "geometry": _geometry(stage, parameters),
        "quality": quality,
        "decay": fitted,
        "power_laws": power_laws(quality),
        "features": features,
        "thinned_features": thinned,
        "beyond": beyond,
        "conventions": conventions,
        "surfaces": surfaces,
    }
    return CaseDocument(values, dict(clock.seconds))


def _require_size(mesh: Mesh, parameters: PaperParameters) -> None:
    n_left = min(mesh.n_vertices, parameters.n_vertices)
    if parameters.n_modes >= n_left:
        raise InputError(
            f"{parameters.n_modes} harmonics of {n_left} vertices: ask for fewer harmonics or give "
            "a finer surface"
        )


def _provenance(original: OriginalSurface, parameters: PaperParameters) -> dict[str, Any]:
    return {
        "name": original.name,
        "kind": original.kind,
        "source": asdict(original.source),
        "parameters": _listed(asdict(parameters)),
        "versions": versions(),
        "remarks": list(original.remarks),
        "repairs": [asdict(repair) for repair in original.cleaned.repairs],
        "scan": original.scan,
    }


def _surface_values(original: OriginalSurface, stage: Stage) -> dict[str, Any]:
    mesh, basis = original.cleaned.mesh, stage.basis
    return {
        "surface_as_read": asdict(original.cleaned.soundness),
        "surface_analyzed": asdict(soundness(stage.surface)),
        "simplification_gd_mm": geometric_distance(mesh, stage.surface).mean,
        "shell": {
            "area_mm2": basis.area,
            "n_vertices": stage.capped.mesh.n_vertices,
            "cap_areas_mm2": list(stage.capped.cap_areas),
            "laplacian": basis.laplacian,
        },
        "certificate": _listed(asdict(basis.certificate)),
    }


def _geometry(stage: Stage, parameters: PaperParameters) -> dict[str, Any]:
    """Figure 1 of one case: coefficients of x, y and z as mm of root mean square, and shares."""
    basis, positions = stage.basis, stage.capped.mesh.vertices
    centred = positions - basis.areas @ positions / basis.area
    coefficients = basis.transform(centred) / np.sqrt(basis.area)
    spectrum = basis.power_spectrum(positions)
    return {
        "coefficients_mm": {
            axis: significant(column) for axis, column in zip("xyz", coefficients.T, strict=True)
        },
        "accumulated_share": significant(spectrum.cumulative(), digits=8),
        "spread_mm": float(np.sqrt(spectrum.varying_total / basis.area)),
        "counts": {
            f"{share:g}": modes_holding(spectrum, share)
            for share in sorted({*parameters.shares, *FURTHER_SHARES})
        },
    }


def _rebuilt(stage: Stage, parameters: PaperParameters) -> dict[int, Mesh]:
    """The closed surface rebuilt from the first harmonics, by their number."""
    basis, closed = stage.basis, stage.capped.mesh
    counts = {
        *parameters.coefficient_counts,
        *parameters.pictured_counts,
        *parameters.recovered_counts,
    }
    centre = closed.vertices.mean(axis=0)
    coefficients = basis.transform(closed.vertices - centre)
    return {
        count: Mesh(basis.inverse(coefficients[:count]) + centre, closed.faces)
        for count in sorted(counts)
        if count <= basis.n_modes
    }


def _segmentation_error(
    original: OriginalSurface,
    stage: Stage,
    places: list[np.ndarray],
    parameters: PaperParameters,
) -> dict[str, Any] | None:
    """How far the segmented surface of a generated CT lies from the truth, and what that does."""
    if original.truth is None:
        return None
    truth, segmented = truth_surface(original.truth), original.cleaned.mesh
    there = geometric_distance(segmented, truth)
    both = geometric_distance(segmented, truth, symmetric=True)
    n_vertices = stage.surface.n_vertices
    return {
        "gd_mm": there.mean,
        "rms_mm": both.rms,
        "hausdorff_mm": both.hausdorff,
        "truth": resolved(truth, n_vertices, places, parameters),
        "segmented": main_counts(stage, places, parameters),
    }


def _listed(values: Mapping[str, Any]) -> dict[str, Any]:
    """The same with lists for tuples, as JSON gives them back."""
    return {
        key: list(value) if isinstance(value, tuple) else value for key, value in values.items()
    }
