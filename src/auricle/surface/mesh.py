"""A triangle mesh: the surface everything else lives on."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from auricle.arrays import Faces, Floats, PerFace, Points, read_only
from auricle.errors import SurfaceError


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles in space, checked on entry and never changed after.

    Parameters
    ----------
    vertices
        Positions, shape (n, 3), mm; copied and frozen.
    faces
        Vertex indices, shape (f, 3), counter-clockwise seen from outside; copied and frozen.

    Raises
    ------
    SurfaceError
        If there are no faces, a position is not finite, an index is out of range, or a face
        names a vertex twice.

    Examples
    --------
    >>> from auricle.surface.shapes import icosphere
    >>> sphere = icosphere(radius=10.0, subdivisions=4)
    >>> bool(abs(sphere.area / (4 * np.pi * 10**2) - 1) < 0.003)
    True
    """

    vertices: Points
    faces: Faces

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices", read_only(self.vertices, np.float64))
        object.__setattr__(self, "faces", read_only(self.faces, np.int64))
        if self.vertices.ndim != 2 or self.vertices.shape[1] != 3:
            raise SurfaceError(f"vertices have shape {self.vertices.shape}: give (n, 3)")
        if self.faces.ndim != 2 or self.faces.shape[1] != 3 or not len(self.faces):
            raise SurfaceError(f"faces have shape {self.faces.shape}: give (f, 3) with f > 0")
        if not np.isfinite(self.vertices).all():
            raise SurfaceError("a vertex is NaN or infinite: remove it and its faces")
        if self.faces.min() < 0 or self.faces.max() >= len(self.vertices):
            raise SurfaceError(
                f"a face names vertex {self.faces.min()}…{self.faces.max()} "
                f"of {len(self.vertices)}: indices count from 0"
            )
        if (self.faces == np.roll(self.faces, 1, axis=1)).any():
            raise SurfaceError("a face names one vertex twice: remove it")

    @property
    def n_vertices(self) -> int:
        """Number of vertices."""
        return len(self.vertices)

    @property
    def n_faces(self) -> int:
        """Number of triangles."""
        return len(self.faces)

    @cached_property
    def face_normals(self) -> Floats:
        """Cross products of the edges, shape (f, 3), mm²: twice the area along the normal."""
        corners = np.take(self.vertices, self.faces, axis=0)
        normals: Floats = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        return normals

    @cached_property
    def face_areas(self) -> PerFace:
        """Area of each triangle, shape (f,), mm²."""
        areas: PerFace = 0.5 * np.linalg.norm(self.face_normals, axis=1)
        return areas

    @cached_property
    def area(self) -> float:
        """Total area, mm²."""
        return float(self.face_areas.sum())
