"""The Laplacian of a triangle mesh: cotangent stiffness and vertex areas.

Where triangles are too poor for cotangents, the intrinsic Delaunay Laplacian takes their place.
"""

from dataclasses import dataclass
from typing import cast

import numpy as np
import robust_laplacian
from scipy import sparse

from auricle.arrays import Floats, PerVertex
from auricle.errors import SurfaceError
from auricle.spectral.intrinsic_delaunay import intrinsic_delaunay
from auricle.surface.mesh import Mesh
from auricle.surface.soundness import triangle_quality, vertex_areas

POOREST_QUALITY = 0.02
"""Below this shape quality (1 = equilateral) the plain cotangents are not used.

The quality is 4√3·area over the sum of squared edge lengths; 0.02 is an angle of about 1°, where
a cotangent exceeds 50 and a step of rounding in a vertex starts to show in the operator.
"""


@dataclass(frozen=True, eq=False)
class Laplacian:
    """The pair of matrices of the eigenproblem  stiffness · u = λ · areas · u.

    Attributes
    ----------
    stiffness
        Sparse, symmetric, positive semi-definite, shape (n, n), no unit; rows sum to zero.
    areas
        Area that belongs to each vertex, shape (n,), mm²; they sum to the surface's area.
    kind
        ``cotangent`` or ``intrinsic Delaunay``.
    """

    stiffness: sparse.csr_array
    areas: PerVertex
    kind: str


def laplacian(mesh: Mesh) -> Laplacian:
    """The Laplacian of `mesh`: cotangents where they are sound, intrinsic Delaunay otherwise.

    Eigenvalues are physical, l(l+1)/R² on a sphere, in 1/mm².

    References
    ----------
    Pinkall & Polthier 1993 (cotangents, with the factor ½ the paper's Eq. 1 leaves out);
    Sharp & Crane 2020 (intrinsic Delaunay triangulation with mollification).

    Examples
    --------
    >>> from auricle.surface.shapes import icosphere
    >>> operator = laplacian(icosphere(radius=10.0, subdivisions=3))
    >>> operator.kind
    'cotangent'
    >>> bool(abs(operator.stiffness.sum(axis=1)).max() < 1e-12)
    True
    """
    if triangle_quality(mesh).min() >= POOREST_QUALITY:
        return cotangent_laplacian(mesh)
    return intrinsic_delaunay_laplacian(mesh)


def cotangent_laplacian(mesh: Mesh) -> Laplacian:
    """Linear finite elements with lumped areas: each vertex owns a third of its triangles."""
    a, b, c = np.take(mesh.vertices, mesh.faces.T, axis=0)
    sides = (b - c, c - a, a - b)
    # The cotangent at a corner is the dot product of its two edges over twice the area.
    dots = [-np.einsum("fi,fi->f", sides[k - 2], sides[k - 1]) for k in range(3)]
    weights = 0.25 * np.stack(dots, axis=1) / mesh.face_areas[:, None]
    start, end = mesh.faces[:, [1, 2, 0]].ravel(), mesh.faces[:, [2, 0, 1]].ravel()
    return _assembled(start, end, weights.ravel(), vertex_areas(mesh), "cotangent")


def intrinsic_delaunay_laplacian(mesh: Mesh) -> Laplacian:
    """The Laplacian of the intrinsic Delaunay triangulation, with needles mollified.

    Surfaces that are open, not manifold or in pieces are covered twice first, by a library.
    """
    triangles = intrinsic_delaunay(mesh.vertices, mesh.faces)
    if triangles is None or not triangles.areas.min() > 0:
        return _of_the_cover(mesh)
    weights = triangles.doubled_dots / (8 * triangles.areas)
    shares = np.bincount(triangles.origins, triangles.areas / 3, len(mesh.vertices))
    areas = np.asarray(shares, np.float64)
    return _assembled(triangles.origins, triangles.ends, weights, areas, "intrinsic Delaunay")


def _of_the_cover(mesh: Mesh) -> Laplacian:
    centred = mesh.vertices - mesh.vertices.mean(axis=0)
    matrix, masses = robust_laplacian.mesh_laplacian(centred, mesh.faces)
    areas = np.asarray(masses.diagonal(), dtype=np.float64)
    if not (np.isfinite(matrix.data).all() and np.isfinite(areas).all() and areas.min() > 0):
        raise SurfaceError(
            "a vertex has no area even after repair of the triangles: remove zero-area faces"
        )
    upper = sparse.coo_array(sparse.triu(matrix, k=1))
    return _assembled(upper.coords[0], upper.coords[1], -upper.data, areas, "intrinsic Delaunay")


def _assembled(
    start: np.ndarray, end: np.ndarray, weights: Floats, areas: PerVertex, kind: str
) -> Laplacian:
    """Stiffness from edge weights: symmetric and with zero row sums by construction."""
    n = len(areas)
    adjacency = sparse.coo_array((weights, (start, end)), shape=(n, n)).tocsr()
    adjacency = cast(sparse.csr_array, adjacency + adjacency.T)
    stiffness = sparse.diags_array(adjacency.sum(axis=1)) - adjacency
    return Laplacian(cast(sparse.csr_array, stiffness.tocsr()), areas, kind)
