"""A locator: the place of a surface nearest to one point, in a millisecond or two."""

import numpy as np
from scipy.spatial import cKDTree

from auricle.arrays import Floats
from auricle.sampling.sites import Sites
from auricle.surface.mesh import Mesh


class Locator:
    """Nearest places one at a time; for many at once `Sites.nearest` is quicker.

    Only the triangles that a sphere about the point can touch are searched, its radius the
    distance to the nearest vertex: the result is exact.

    Examples
    --------
    >>> from auricle.surface.shapes import icosphere
    >>> sphere = icosphere(radius=10.0, subdivisions=3)
    >>> point = np.array([3.0, 4.0, 12.0])
    >>> site, distance = Locator(sphere).nearest(point)
    >>> bool(distance == Sites.nearest(sphere, point[None, :])[1][0])
    True
    """

    def __init__(self, mesh: Mesh) -> None:
        corners = mesh.vertices[mesh.faces]
        centroids = corners.mean(axis=1)
        self._mesh = mesh
        self._reach = float(np.linalg.norm(corners - centroids[:, None], axis=2).max())
        self._centroids = cKDTree(centroids)
        self._corners = cKDTree(mesh.vertices[np.unique(mesh.faces)])

    def nearest(self, position: Floats) -> tuple[Sites, float]:
        """The nearest place, one site, and how far off `position`, shape (3,), lies, mm."""
        bound = float(self._corners.query(position)[0])
        radius = (bound + self._reach) * (1 + 1e-9)
        faces = self._mesh.faces[self._centroids.query_ball_point(position, radius)]
        used, local = np.unique(faces, return_inverse=True)
        part = Mesh(self._mesh.vertices[used], local.reshape(faces.shape))
        sites, distances = Sites.nearest(part, position[None, :])
        return Sites(used[sites.corners], sites.weights), float(distances[0])
