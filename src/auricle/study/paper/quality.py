"""Quality: how far a surface rebuilt from harmonics, or thinned out, lies from the original."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from auricle.arrays import Floats
from auricle.errors import InputError
from auricle.sampling.decay import fit_decay
from auricle.surface.collapse_sequence import CollapseSequence
from auricle.surface.distance import (
    geometric_distance,
    nearest_vertex_mean_square,
    vertexwise_mean_square,
)
from auricle.surface.mesh import Mesh

METHODS = ("mha", "qslim")
ERRORS = (
    "gd_from_original_mm",
    "gd_to_original_mm",
    "mse_mm2",
    "mse_nearest_from_original_mm2",
    "mse_nearest_to_original_mm2",
)
"""Readings of the paper's two errors: GD of the original's vertices from the rebuilt surface, GD
of the rebuilt's from the original; MSE, and mean squared distances to the nearest vertex."""

RANGES = ("even", "even from 50", "even from 100", "geometric")
"""Which counts τ is fitted to: those of the parameters, all or from a count on, or of all those
near a geometric row. The paper states none, and a curve that falls as a power has no τ of its own:
the fit then follows the counts."""
_NEXT = 1.3
_FEWEST = 4

Curves = dict[str, list[float]]


def quality_of_harmonics(surface: Mesh, rebuilt: Mapping[int, Mesh]) -> Curves:
    """Errors of surfaces of the original's connectivity, by number of harmonics.

    MSE (``mse_mm2``) compares positions vertex by vertex.

    Parameters
    ----------
    surface
        The original.
    rebuilt
        By number of harmonics; its vertices are the original's, moved.

    Returns
    -------
    dict
        ``counts`` and, for each of `ERRORS`, one number a count.
    """
    return _curves(
        (count, mesh, vertexwise_mean_square(mesh.vertices, surface.vertices), surface)
        for count, mesh in rebuilt.items()
    )


def quality_of_points(sequence: CollapseSequence, counts: Sequence[int]) -> Curves:
    """Errors of the surface thinned out by Qslim, by number of points.

    MSE (``mse_mm2``) takes the squared distance of the original's vertices to the nearest vertex
    left: "MSE operates with the distance to the nearest point". Counts that the surface's holes
    and handles do not allow are left out.

    Returns
    -------
    dict
        As `quality_of_harmonics`.
    """
    surface = sequence.mesh
    levels = (
        (count, sequence.mesh_at(count))
        for count in counts
        if sequence.n_least <= count <= surface.n_vertices
    )
    return _curves(
        (count, mesh, nearest_vertex_mean_square(surface.vertices, mesh.vertices), surface)
        for count, mesh in levels
    )


def decays(quality: Mapping[str, Curves], fitted: Sequence[int]) -> list[dict[str, Any]]:
    """Exponentials fitted to every error of every method, with and without floor.

    Parameters
    ----------
    quality
        Curves by method.
    fitted
        Counts of the ranges called even.

    Returns
    -------
    list of dict
        Method, error, range and floor; and τ with its interval, height, floor and residual, or
        None for τ and the reason.
    """
    return [
        {"method": method, "error": error, "range": counts, "with_floor": floor}
        | _decay(curves, error, _chosen(curves["counts"], counts, fitted), floor)
        for method, curves in quality.items()
        for error in ERRORS
        for counts in RANGES
        for floor in (False, True)
    ]


def power_laws(quality: Mapping[str, Curves]) -> list[dict[str, Any]]:
    """How well a power of the count describes each error, beside an exponential without floor.

    Both are straight lines fitted to the logarithm of the error, over all counts: against the
    logarithm of the count, or the count.

    Returns
    -------
    list of dict
        Method, error; ``exponent`` b of error ∝ countᵇ; ``power_misfit`` and
        ``exponential_misfit``, root mean squares of the logarithm's residuals. Errors that reach 0
        are left out.
    """
    found: list[dict[str, Any]] = []
    for method, curves in quality.items():
        counts = np.array(curves["counts"], dtype=np.float64)
        for error in ERRORS:
            if len(counts) < _FEWEST or min(curves[error]) <= 0.0:
                continue
            logs = np.log(curves[error])
            slope, power_misfit = _line(np.log(counts), logs)
            found.append(
                {
                    "method": method,
                    "error": error,
                    "exponent": slope,
                    "power_misfit": power_misfit,
                    "exponential_misfit": _line(counts, logs)[1],
                }
            )
    return found


def _line(places: Floats, heights: Floats) -> tuple[float, float]:
    """Slope of the straight line through some points, and the root mean square of its residuals."""
    slope, offset = np.polyfit(places, heights, 1)
    misfit = np.sqrt(np.mean((heights - slope * places - offset) ** 2))
    return float(slope), float(misfit)


def _curves(levels: Iterator[tuple[int, Mesh, float, Mesh]]) -> Curves:
    curves: Curves = {name: [] for name in ("counts", *ERRORS, "hausdorff_mm")}
    for count, mesh, mean_square, surface in levels:
        there, back = geometric_distance(surface, mesh), geometric_distance(mesh, surface)
        row = (
            count,
            there.mean,
            back.mean,
            mean_square,
            nearest_vertex_mean_square(surface.vertices, mesh.vertices),
            nearest_vertex_mean_square(mesh.vertices, surface.vertices),
            max(there.hausdorff, back.hausdorff),
        )
        for name, value in zip(curves, row, strict=True):
            curves[name].append(value)
    return curves


def _chosen(counts: Sequence[float], which: str, fitted: Sequence[int]) -> list[int]:
    """Places of the counts to fit."""
    if which != "geometric":
        least = float(which.rpartition(" from ")[2]) if " from " in which else 0.0
        return [place for place, count in enumerate(counts) if count in fitted and count >= least]
    chosen: list[int] = []
    for place, count in enumerate(counts):
        if not chosen or count >= _NEXT * counts[chosen[-1]]:
            chosen.append(place)
    return chosen


def _decay(curves: Curves, error: str, places: list[int], floor: bool) -> dict[str, Any]:
    counts, errors = (np.array(curves[name])[places] for name in ("counts", error))
    try:
        found = fit_decay(counts, errors, floor=floor)
    except InputError as fault:
        return {"tau": None, "reason": str(fault)}
    return {
        "tau": found.tau,
        "tau_low": found.tau_low,
        "tau_high": found.tau_high if np.isfinite(found.tau_high) else None,
        "initial": found.initial,
        "floor": found.floor,
        "residual": found.residual,
    }
