"""Feature scaling: field values as lengths, so that a quadric can weigh them against positions."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from auricle.arrays import Floats
from auricle.errors import InputError
from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh
from auricle.surface.soundness import vertex_areas


@dataclass(frozen=True)
class FeatureScale:
    """How a field's values become millimetres: (value - mean) · mm_per_unit.

    Attributes
    ----------
    mean
        Of each component, shape (c,), weighted by vertex area, in the field's unit.
    mm_per_unit
        What a standard deviation is to count for, over the standard deviation; 1 where all
        values are equal.
    """

    mean: Floats
    mm_per_unit: float

    def lengths(self, values: Floats) -> Floats:
        """Values of shape (n,) or (n, c) as lengths, shape (n, c), mm."""
        scaled: Floats = (values.reshape(len(values), -1) - self.mean) * self.mm_per_unit
        return scaled

    def values(self, lengths: Floats) -> Floats:
        """Undo `lengths`, shape (n, c)."""
        restored: Floats = lengths / self.mm_per_unit + self.mean
        return restored


def feature_scale(field: FieldMap, weight: float) -> FeatureScale:
    """Scale at which one standard deviation of a field counts as much as `weight` mm.

    The standard deviation is weighted by vertex area. At 1 mm a map with a sharp border keeps it
    several times better than the geometry alone would, for a geometric distance larger by a
    fifth at most, on left atria of 500 vertices.

    Raises
    ------
    InputError
        If the weight is not a positive number.

    Examples
    --------
    >>> from auricle.surface.shapes import icosphere
    >>> sphere = icosphere(radius=30.0, subdivisions=2)
    >>> height = FieldMap(sphere, 5.0 * sphere.vertices[:, 2], "height")
    >>> scale = feature_scale(height, 2.0)
    >>> round(float(scale.lengths(height.values).std()), 1)
    2.0
    """
    if not 0.0 < weight < np.inf:
        raise InputError(f"a feature weight of {weight}: give a positive number")
    known = field.sampled
    areas = vertex_areas(field.mesh)
    values = field.values.reshape(len(known), -1)
    if not areas[known].sum() > 0.0:
        return FeatureScale(np.zeros(values.shape[1]), 1.0)
    mean = np.average(values[known], axis=0, weights=areas[known])
    squares = ((values[known] - mean) ** 2).sum(axis=1)
    deviation = float(np.sqrt(np.average(squares, weights=areas[known])))
    return FeatureScale(mean, weight / deviation if deviation > 0.0 else 1.0)


def feature_lengths(
    mesh: Mesh, fields: Sequence[FieldMap], scales: Sequence[FeatureScale]
) -> Floats:
    """Scaled values of all fields side by side, shape (n, d), mm; unsampled as the nearest sampled.

    A field without any value counts as 0.

    Raises
    ------
    InputError
        If a field lives on another mesh.
    """
    columns = [np.empty((mesh.n_vertices, 0))]
    for field, scale in zip(fields, scales, strict=True):
        if field.mesh is not mesh:
            raise InputError(f"field {field.name!r} is on another mesh: transfer it first")
        columns.append(scale.lengths(_filled(field)))
    lengths: Floats = np.concatenate(columns, axis=1)
    return lengths


def _filled(field: FieldMap) -> Floats:
    known = field.sampled
    if known.all():
        return field.values
    if not known.any():
        return np.zeros_like(field.values)
    vertices = field.mesh.vertices
    filled: Floats = field.values.copy()
    filled[~known] = field.values[known][cKDTree(vertices[known]).query(vertices[~known])[1]]
    return filled
