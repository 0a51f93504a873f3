"""Features thinned out by Qslim: focal maps in the quadric's fourth component, beside harmonics.

The paper: Qslim extends to R^n, "the first three components of v are given by its spatial
coordinates and the remaining components are given by the property values". A map recovered from
so many points is what they hold, linear over the triangles between them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from auricle.arrays import Floats, Integers, PerVertex
from auricle.study.paper.features import Stage, rebuilt_maps, relative_errors, significant
from auricle.study.paper.foci import Foci
from auricle.study.paper.parameters import PaperParameters
from auricle.surface.collapse_sequence import FEWEST_VERTICES, CollapseSequence
from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh
from auricle.surface.simplification import simplification_sequence
from auricle.surface.transfer import barycentric_at, transfer

WAYS = ("harmonics", "points", "points_with_feature")
"""A map from its first harmonics; from the points of Qslim that knows the geometry only, with the
map's values there; from the points of Qslim with the map in the fourth component."""

PLACEMENTS = 2
"""How many placements of the foci are thinned out, at most; the case's own first ones."""


def thinned_records(
    stage: Stage, foci: Sequence[Foci], sequence: CollapseSequence, parameters: PaperParameters
) -> list[dict[str, Any]]:
    """Errors of focal maps from so many harmonics and from so many points.

    Parameters
    ----------
    stage, foci
        The surface and the foci on it.
    sequence
        The closed surface thinned out by its geometry.
    parameters
        Of the study.

    Returns
    -------
    list of dict
        For every width and number of foci ``size``, ``sigma_mm``, ``n_foci``; ``counts``;
        ``nrmse`` by each of `WAYS`, on the real surface; and ``gd_mm`` by the last two, mean
        distance of the real surface's vertices from the thinned-out one, mm. Means over
        placements, one number a count; counts that a surface's handles do not allow are left out.
    """
    counts = [count for count in parameters.feature_counts if count <= stage.basis.n_modes]
    # The surface thinned out by its geometry alone is the same for every map.
    plain = {count: _Level.of(mesh, stage) for count, mesh in _levels(sequence, counts).items()}
    records = []
    for size, width in zip(parameters.sizes, parameters.focus_widths_mm, strict=True):
        for n_foci in parameters.focus_counts:
            maps = [each.map_of(n_foci, width) for each in foci[:PLACEMENTS]]
            found = [_errors(stage, values, plain, parameters.feature_weight_mm) for values in maps]
            common = [count for count in counts if all(count in each for each in found)]
            means = np.mean([[each[count] for count in common] for each in found], axis=0)
            columns = [significant(column) for column in means.T]
            records.append(
                {
                    "size": size,
                    "sigma_mm": width,
                    "n_foci": n_foci,
                    "counts": common,
                    "nrmse": dict(zip(WAYS, columns[: len(WAYS)], strict=True)),
                    "gd_mm": dict(zip(WAYS[1:], columns[len(WAYS) :], strict=True)),
                }
            )
    return records


def thinned_maps(
    stage: Stage, values: PerVertex, counts: Sequence[int], *, weight_mm: float
) -> dict[int, FieldMap]:
    """A map on its surface thinned out by Qslim in R⁴, by the number of points.

    Parameters
    ----------
    stage
        The closed surface.
    values
        The map on it, shape (n,).
    counts
        Numbers of points; those that the surface's size or handles do not allow are left out.
    weight_mm
        How many mm one standard deviation of the map counts for in the quadric.
    """
    mesh = stage.capped.mesh
    sequence = simplification_sequence(mesh, fields=[_field(mesh, values)], weight=weight_mm)
    return {count: sequence.fields_at(count)[0] for count in _possible(sequence, counts)}


@dataclass(frozen=True, eq=False)
class _Level:
    """A thinned-out surface, and where on it the real vertices lie.

    Attributes
    ----------
    mesh
        The thinned-out surface.
    corners, weights
        Of the triangle nearest to each real vertex: shapes (n, 3), the weights of sum 1.
    gd_mm
        Mean distance of the real vertices from it, weighted by area, mm.
    """

    mesh: Mesh
    corners: Integers
    weights: Floats
    gd_mm: float

    @classmethod
    def of(cls, mesh: Mesh, stage: Stage) -> "_Level":
        n = stage.surface.n_vertices
        faces, weights, distances = barycentric_at(mesh, stage.surface.vertices)
        areas = stage.basis.areas[:n]
        gd_mm = float(areas @ distances / areas.sum())
        return cls(mesh, mesh.faces[faces], weights, gd_mm)

    def error(self, stage: Stage, values: PerVertex, left: PerVertex) -> float:
        """Relative error of a map of which the values `left` at the points are known."""
        recovered = (left[self.corners] * self.weights).sum(axis=1)
        real = values[: stage.surface.n_vertices]
        return float(relative_errors(stage, real[:, None], recovered[:, None])[0])


def _errors(
    stage: Stage, values: PerVertex, plain: Mapping[int, _Level], weight_mm: float
) -> dict[int, tuple[float, ...]]:
    """Errors of one map by each way, then both mean distances, by count."""
    field = _field(stage.capped.mesh, values)
    maps = values[:, None]
    rebuilt = rebuilt_maps(stage.basis, maps, list(plain))
    found: dict[int, tuple[float, ...]] = {}
    for count, thinned in thinned_maps(stage, values, list(plain), weight_mm=weight_mm).items():
        geometry, with_feature = plain[count], _Level.of(thinned.mesh, stage)
        found[count] = (
            float(relative_errors(stage, maps, rebuilt[count])[0]),
            geometry.error(stage, values, transfer(field, geometry.mesh).values),
            with_feature.error(stage, values, thinned.values),
            geometry.gd_mm,
            with_feature.gd_mm,
        )
    return found


def _field(mesh: Mesh, values: PerVertex) -> FieldMap:
    return FieldMap(mesh, values, "simulated focus")


def _levels(sequence: CollapseSequence, counts: Sequence[int]) -> dict[int, Mesh]:
    return {count: sequence.mesh_at(count) for count in _possible(sequence, counts)}


def _possible(sequence: CollapseSequence, counts: Sequence[int]) -> list[int]:
    least = max(sequence.n_least, FEWEST_VERTICES)
    return [count for count in counts if least <= count <= sequence.mesh.n_vertices]
