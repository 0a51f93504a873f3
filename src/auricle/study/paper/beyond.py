"""Beyond the paper: counts against width, other classes of maps, finer meshes, the true surface."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from auricle.arrays import Points
from auricle.errors import InputError, SolverError, SurfaceError
from auricle.sampling.bandwidth import closed_form_modes
from auricle.simulation.foci import gaussian_modes_for_power
from auricle.simulation.map_classes import MAP_CLASSES, MapClass
from auricle.spectral.harmonics import manifold_harmonics
from auricle.study.paper.features import Stage, counts_by_share, marched_foci, modes_holding
from auricle.study.paper.foci import Foci
from auricle.study.paper.parameters import PaperParameters
from auricle.surface.capping import cap_holes
from auricle.surface.mesh import Mesh
from auricle.surface.simplification import simplify

CLASSES = ("disc", "activation", "macro_reentry", "scar")
"""Classes of maps beside Gaussian foci, as `MAP_CLASSES` has them."""

COMPARED_MODES = 400
"""Harmonics where two meshes of one atrium are compared: enough for small foci at 90 %."""


def width_curve(
    stage: Stage, foci: Sequence[Foci], parameters: PaperParameters
) -> list[dict[str, Any]]:
    """Counts of harmonics for one focus against its width, beside the closed form.

    Returns
    -------
    list of dict
        ``sigma_mm``; ``counts`` by share, one a placement, the constant counted; ``closed_form``
        by share, -A·ln(1 - p)/(4πσ²), the constant not counted.
    """
    records = []
    for width in parameters.curve_widths_mm:
        maps = np.column_stack([each.map_of(1, width) for each in foci])
        records.append(
            {
                "sigma_mm": width,
                "counts": counts_by_share(stage.basis, maps, parameters.shares),
                "closed_form": {
                    f"{share:g}": gaussian_modes_for_power(
                        area=stage.basis.area, width=width, share=share
                    )
                    for share in parameters.shares
                },
            }
        )
    return records


def class_records(stage: Stage, parameters: PaperParameters) -> list[dict[str, Any]]:
    """Counts of harmonics for maps of other classes at their default parameters.

    Returns
    -------
    list of dict
        ``class``, ``title``, ``parameters``, ``tail_exponent``; ``counts`` by share, one a map;
        ``closed_form`` by share where theory has one; ``reason`` where no map could be drawn.
    """
    if not parameters.class_draws:
        return []
    return [
        _class_record(stage, MAP_CLASSES[name], number, parameters)
        for number, name in enumerate(CLASSES)
    ]


def resolved(
    mesh: Mesh, n_vertices: int, places: Sequence[Points], parameters: PaperParameters
) -> dict[str, Any]:
    """What the main counts are on a mesh of so many vertices, with foci at the same places.

    Returns
    -------
    dict
        ``n_vertices``; ``geometry`` by share; ``features``, for one focus of each width the
        counts by share, one a placement.
    """
    surface = simplify(mesh, n_vertices)
    capped = cap_holes(surface)
    n_modes = min(COMPARED_MODES, parameters.n_modes)
    basis = manifold_harmonics(capped.mesh, n_modes, seed=parameters.seed, threads=1)
    return main_counts(Stage(surface, capped, basis), places, parameters)


def recovered(
    stage: Stage, rebuilt: Mapping[int, Mesh], foci: Sequence[Foci], parameters: PaperParameters
) -> list[dict[str, Any]]:
    """What the counts of one focus are on the surface rebuilt from few harmonics.

    The maps go with the vertices, as the fourth component does; the harmonics are those of the
    rebuilt surface.

    Returns
    -------
    list of dict
        ``count``, the number of harmonics of the surface; ``area_mm2``; ``features`` as
        `main_counts` has them, or the ``reason`` why the surface has no harmonics.
    """
    return [
        {"count": count} | _on_recovered(stage, rebuilt[count], foci, parameters)
        for count in parameters.recovered_counts
        if count in rebuilt
    ]


def main_counts(
    stage: Stage, places: Sequence[Points], parameters: PaperParameters
) -> dict[str, Any]:
    """As `resolved`, of a surface whose harmonics are known."""
    spectrum = stage.basis.power_spectrum(stage.capped.mesh.vertices)
    single = [place[:1] for place in places]
    foci = marched_foci(stage, single, widest_mm=max(parameters.focus_widths_mm, default=1.0))
    return {
        "n_vertices": stage.surface.n_vertices,
        "geometry": {
            f"{share:g}": modes_holding(spectrum, share)
            for share in sorted({*parameters.shares, 0.95, 0.99})
        },
        "features": _single_foci(stage, foci, parameters),
    }


def _single_foci(
    stage: Stage, foci: Sequence[Foci], parameters: PaperParameters
) -> list[dict[str, Any]]:
    return [
        {
            "size": size,
            "sigma_mm": width,
            "counts": counts_by_share(
                stage.basis,
                np.column_stack([each.map_of(1, width) for each in foci]),
                parameters.shares,
            ),
        }
        for size, width in zip(parameters.sizes, parameters.focus_widths_mm, strict=True)
    ]


def _on_recovered(
    stage: Stage, surface: Mesh, foci: Sequence[Foci], parameters: PaperParameters
) -> dict[str, Any]:
    n_modes = min(COMPARED_MODES, parameters.n_modes)
    try:
        basis = manifold_harmonics(surface, n_modes, seed=parameters.seed, threads=1)
    except (SurfaceError, SolverError) as fault:  # few harmonics may fold a surface flat
        return {"area_mm2": surface.area, "features": [], "reason": str(fault)}
    features = _single_foci(replace(stage, basis=basis), foci, parameters)
    return {"area_mm2": surface.area, "features": features}


def _class_record(
    stage: Stage, map_class: MapClass, number: int, parameters: PaperParameters
) -> dict[str, Any]:
    rng = np.random.default_rng([parameters.seed, 1_000 + number])
    mesh, original = stage.capped.mesh, stage.capped.original
    record: dict[str, Any] = {
        "class": map_class.name,
        "title": map_class.title,
        "parameters": dict(map_class.parameters),
        "tail_exponent": map_class.tail_exponent,
    }
    found = []
    for _ in range(parameters.class_draws):
        try:
            drawn = map_class.draw(mesh, rng, allowed=original)
        except InputError as fault:  # a small atrium may not hold two obstacles 50 mm apart
            return record | {"counts": {}, "closed_form": {}, "reason": str(fault)}
        found.append(stage.basis.power_spectrum(map_class.columns(drawn)))
    closed = {
        share: closed_form_modes(map_class, area=stage.basis.area, share=share)
        for share in parameters.shares
    }
    return record | {
        "counts": {
            f"{share:g}": [modes_holding(each, share) for each in found]
            for share in parameters.shares
        },
        "closed_form": {f"{share:g}": modes for share, modes in closed.items()},
    }
