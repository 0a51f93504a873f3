"""The operators the paper's Eq. 1 can be read as, each as a symmetric matrix of one surface.

Two readings of the matrix and two of the dual cell |vᵢ| make four; how vertices are weighted when
a map is projected is the other half of a convention and lies in `transforms.py`.
"""

from dataclasses import dataclass
from typing import Literal, cast, get_args

import numpy as np
from scipy import sparse

from auricle.arrays import Floats, PerVertex
from auricle.errors import SurfaceError
from auricle.spectral.factorization import factorize
from auricle.spectral.laplacian import Laplacian, intrinsic_delaunay_laplacian, laplacian
from auricle.surface.mesh import Mesh

OperatorName = Literal["as_printed", "symmetrised"]
DualCell = Literal["third", "voronoi"]
OPERATORS: tuple[OperatorName, ...] = get_args(OperatorName)
DUAL_CELLS: tuple[DualCell, ...] = get_args(DualCell)

_BELOW_ZERO = 1e-3
"""Depth under zero, in spacings of eigenvalues (Weyl: 4π / area), from which one is negative."""


@dataclass(frozen=True, eq=False)
class Operator:
    """One reading of Eq. 1 on one surface.

    Attributes
    ----------
    name
        ``as_printed``: off the diagonal −wᵢⱼ/√(|vᵢ||vⱼ|), on it minus the row's sum of these.
        ``symmetrised``: |v|^-½ · W · |v|^-½ throughout, the area-weighted operator's own form,
        whose diagonal is Wᵢᵢ/|vᵢ| and whose rows do not sum to zero. w and W are the cotangent
        weights with the factor ½ that Eq. 1 leaves out; it scales eigenvalues only.
    dual_cell
        ``third`` of each triangle around a vertex, or ``voronoi``: the mixed cell, the vertex's
        Voronoi part where triangles are not obtuse.
    areas
        Of the dual cells, shape (n,), mm².
    pair
        The eigenproblem in the form the solver takes; times √pair.areas its modes are orthonormal
        without areas.
    n_negative
        Negative eigenvalues of Eq. 1 to the letter with cotangent weights, which make it no
        Laplacian; where there are any, `pair` has intrinsic Delaunay weights instead.
    """

    name: OperatorName
    dual_cell: DualCell
    areas: PerVertex
    pair: Laplacian
    n_negative: int = 0

    @property
    def matrix(self) -> sparse.csc_array:
        """The symmetric matrix whose eigenvectors are meant, shape (n, n), 1/mm²."""
        return _scaled(self.pair.stiffness, self.pair.areas)


def operator_of(mesh: Mesh, name: OperatorName, dual_cell: DualCell) -> Operator:
    """The operator of that name on `mesh`.

    Where triangles are too poor for cotangents the intrinsic Delaunay weights take their place,
    as everywhere in auricle; in Eq. 1 as printed also where cotangents leave negative eigenvalues.
    Where the angles opposite an edge exceed 180° together its weight is negative: the symmetrised
    operator stays positive semi-definite, the printed one, whose weights are divided by other
    cells each, need not. Intrinsic Delaunay weights are never negative.

    Raises
    ------
    SurfaceError
        If a vertex has no area.

    Examples
    --------
    Both have the constant's eigenvalue 0, but only as printed is the eigenvector constant itself:

    >>> from auricle.surface.shapes import ellipsoid
    >>> from auricle.surface.soundness import vertex_areas
    >>> mesh = ellipsoid(semi_axes=(10.0, 20.0, 30.0), subdivisions=2)
    >>> printed, symmetrised = (operator_of(mesh, name, "third").matrix for name in OPERATORS)
    >>> one, root = np.ones(mesh.n_vertices), np.sqrt(vertex_areas(mesh))
    >>> [bool(abs(m @ u).max() < 1e-12) for m in (printed, symmetrised) for u in (one, root)]
    [True, False, False, True]
    """
    sound = laplacian(mesh)
    areas = sound.areas if dual_cell == "third" else voronoi_areas(mesh)
    if not areas.min() > 0:
        raise SurfaceError("a vertex has no area: remove zero-area faces")
    if name == "symmetrised":
        return Operator(name, dual_cell, areas, Laplacian(sound.stiffness, areas, sound.kind))
    pair = _as_printed(sound, areas)
    n_negative = _n_negative(pair)
    if n_negative:
        pair = _as_printed(intrinsic_delaunay_laplacian(mesh), areas)
    return Operator(name, dual_cell, areas, pair, n_negative)


def voronoi_areas(mesh: Mesh) -> PerVertex:
    """Mixed Voronoi area of each vertex, shape (n,), mm²; they sum to the surface's area.

    In a triangle without an obtuse angle each corner owns what is nearest to it; in an obtuse one
    the obtuse corner owns a half and the others a quarter each.

    References
    ----------
    Meyer, Desbrun, Schröder & Barr 2003, "Discrete differential-geometry operators …", § 3.3.

    Examples
    --------
    A right angle owns half of its triangle:

    >>> voronoi_areas(Mesh([[0, 0, 0], [2, 0, 0], [0, 2, 0]], [[0, 1, 2]])).tolist()
    [1.0, 0.5, 0.5]
    """
    corners = mesh.vertices[mesh.faces]
    ahead, behind = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    dots = np.einsum("fci,fci->fc", ahead, behind)
    doubled = 2.0 * mesh.face_areas[:, None]
    cotangents = np.divide(dots, doubled, out=np.zeros_like(dots), where=doubled > 0)
    # A corner's Voronoi part: an eighth of each of its two edges' squares times the cotangent
    # opposite to the edge.
    squares_ahead, squares_behind = (ahead**2).sum(axis=2), (behind**2).sum(axis=2)
    shares = 0.125 * (
        squares_ahead * np.roll(cotangents, 1, axis=1)
        + squares_behind * np.roll(cotangents, -1, axis=1)
    )
    obtuse = (dots < 0).any(axis=1)
    halves = np.where(dots < 0, 0.5, 0.25) * mesh.face_areas[:, None]
    shares = np.where(obtuse[:, None], halves, shares)
    totals = np.bincount(mesh.faces.ravel(), weights=shares.ravel(), minlength=mesh.n_vertices)
    return totals.astype(np.float64)


def _as_printed(sound: Laplacian, areas: PerVertex) -> Laplacian:
    """Eq. 1 to the letter; equal masses make the standard eigenproblem of it, in 1/mm²."""
    scaled = _scaled(sound.stiffness, areas)
    off_diagonal = scaled - sparse.diags_array(scaled.diagonal())
    sums = np.asarray(off_diagonal.sum(axis=1)).ravel()
    matrix = off_diagonal - sparse.diags_array(sums)
    mass = float(areas.mean())
    stiffness = cast(sparse.csr_array, sparse.csr_array(matrix) * mass)
    return Laplacian(stiffness, np.full(len(areas), mass), sound.kind)


def _n_negative(pair: Laplacian) -> int:
    """Number of negative eigenvalues, by Sylvester's law of inertia."""
    spacing = 4 * np.pi / pair.areas.sum()
    return factorize(_scaled(pair.stiffness, pair.areas), -_BELOW_ZERO * spacing).n_below


def _scaled(matrix: sparse.csr_array, areas: Floats) -> sparse.csc_array:
    roots = sparse.diags_array(1 / np.sqrt(areas))
    return sparse.csc_array(roots @ matrix @ roots)
