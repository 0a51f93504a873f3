"""Filling: values where none were sampled, by the smoothest continuation of those that were.

The continuation is harmonic: it minimises the Dirichlet energy ∫|∇u|² with the sampled values
held, so it never leaves their range (maximum principle), which the discrete Laplacian keeps since
all its weights are positive (intrinsic Delaunay: Sharp and Crane, *A Laplacian for nonmanifold
triangle meshes*, SGP 2020).
"""

import numpy as np
import robust_laplacian
from scipy.sparse import csc_array
from scipy.sparse.csgraph import connected_components

from auricle.arrays import PerVertex, Truths
from auricle.errors import InputError
from auricle.surface.capping import CappedSurface, harmonic_extension
from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh
from auricle.surface.soundness import vertex_areas


def fill_unsampled(field: FieldMap, *, largest_share: float = 0.5) -> FieldMap:
    """Give a field a value everywhere; sampled values stay as they are.

    Parameters
    ----------
    field
        Values with NaN where not sampled, shape (n,) or (n, c); columns are filled one by one.
    largest_share
        Most of the surface's area that may lack a value.

    Raises
    ------
    InputError
        If more of the area lacks a value, or a piece of the surface has none.
    SolverError
        If the system is not solved to 1e-8.

    Examples
    --------
    >>> from auricle.surface.shapes import rectangle
    >>> strip = rectangle(width=6.0, height=2.0, n_x=7, n_y=3)
    >>> x = strip.vertices[:, 0].copy()
    >>> inside = (x > 0) & (x < 6)
    >>> x[inside] = np.nan
    >>> filled = fill_unsampled(FieldMap(strip, x, "x", "mm"), largest_share=0.9)
    >>> bool(np.abs(filled.values - strip.vertices[:, 0]).max() < 1e-12)
    True
    """
    _refuse_sparse(field, largest_share)
    return _filled(field.mesh, field)


def extend_over_caps(
    capped: CappedSurface, field: FieldMap, *, largest_share: float = 0.5
) -> FieldMap:
    """Continue the field of an open surface over the caps that close it.

    Parameters
    ----------
    capped
        The closed surface.
    field
        Values on the original surface, whose vertices come first in the closed one; what lacks
        a value there is filled as well.
    largest_share
        Most of the original surface's area that may lack a value.

    Raises
    ------
    InputError
        If the field has not as many vertices as the original surface, or as `fill_unsampled`.
    SolverError
        As `fill_unsampled`.
    """
    if field.mesh.n_vertices != capped.n_original_vertices:
        raise InputError(
            f"field {field.name!r} has {field.mesh.n_vertices} vertices and the surface had "
            f"{capped.n_original_vertices} before its holes were closed: transfer it first"
        )
    _refuse_sparse(field, largest_share)
    values = np.full((capped.mesh.n_vertices, *field.values.shape[1:]), np.nan)
    values[: capped.n_original_vertices] = field.values
    return _filled(capped.mesh, FieldMap(capped.mesh, values, field.name, field.unit))


def _refuse_sparse(field: FieldMap, largest_share: float) -> None:
    lacking = np.isnan(field.values.reshape(field.mesh.n_vertices, -1))
    if lacking.all(axis=0).any():
        raise InputError(f"field {field.name!r} has no values: choose a field that was sampled")
    share = float((vertex_areas(field.mesh) @ lacking).max() / field.mesh.area)
    if share > largest_share:
        raise InputError(
            f"field {field.name!r} lacks values on {share:.0%} of the surface, more than "
            f"{largest_share:.0%}: sample more of it, or raise largest_share"
        )


def _filled(mesh: Mesh, field: FieldMap) -> FieldMap:
    if field.sampled.all():
        return field
    stiffness = _positive_stiffness(mesh)
    columns = field.values.reshape(mesh.n_vertices, -1).T
    filled = np.column_stack([_harmonic(stiffness, column, field.name) for column in columns])
    return FieldMap(mesh, filled.reshape(field.values.shape), field.name, field.unit)


def _positive_stiffness(mesh: Mesh) -> csc_array:
    """Cotangent stiffness of the intrinsic Delaunay triangulation, shape (n, n)."""
    centred = mesh.vertices - mesh.vertices.mean(axis=0)
    stiffness, _ = robust_laplacian.mesh_laplacian(centred, mesh.faces)
    return csc_array(stiffness)


def _harmonic(stiffness: csc_array, values: PerVertex, name: str) -> PerVertex:
    known = np.isfinite(values)
    if known.all():
        return values
    _refuse_unreached(stiffness, known, name)
    return harmonic_extension(stiffness, values, known)


def _refuse_unreached(stiffness: csc_array, known: Truths, name: str) -> None:
    _, piece = connected_components(stiffness, directed=False)
    n_unreached = int(np.isin(piece, piece[known], invert=True).sum())
    if n_unreached:
        raise InputError(
            f"field {name!r} has no values on a piece of {n_unreached} vertices: "
            "clean the surface first"
        )
