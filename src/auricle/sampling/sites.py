"""Sites: places on a surface, anywhere in its triangles."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from auricle.arrays import Floats, Integers, Points, read_only
from auricle.errors import InputError
from auricle.surface.mesh import Mesh
from auricle.surface.transfer import barycentric_at


@dataclass(frozen=True, eq=False)
class Sites:
    """Places on one mesh, each the mean of three of its vertices.

    Attributes
    ----------
    corners
        The vertices of the triangle that holds each place, shape (m, 3).
    weights
        Barycentric weights of those vertices, shape (m, 3), not negative, of sum 1.
    """

    corners: Integers
    weights: Floats

    def __post_init__(self) -> None:
        object.__setattr__(self, "corners", read_only(self.corners, np.int64).reshape(-1, 3))
        object.__setattr__(self, "weights", read_only(self.weights, np.float64).reshape(-1, 3))
        if self.corners.shape != self.weights.shape:
            raise InputError(
                f"{len(self.corners)} triangles and {len(self.weights)} sets of weights: "
                "give one a site"
            )

    @classmethod
    def at_vertices(cls, indices: ArrayLike) -> Self:
        """The vertices with these indices."""
        corners = np.repeat(np.asarray(indices, dtype=np.int64).reshape(-1, 1), 3, axis=1)
        return cls(corners, np.tile([1.0, 0.0, 0.0], (len(corners), 1)))

    @classmethod
    def nearest(cls, mesh: Mesh, positions: Points) -> tuple[Self, Floats]:
        """The places of `mesh` nearest to the positions, and how far off these lay, mm.

        Examples
        --------
        >>> triangle = Mesh([[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> sites, distances = Sites.nearest(triangle, np.array([[1.0, 2.0, 5.0]]))
        >>> sites.positions(triangle).tolist(), distances.tolist()
        ([[1.0, 2.0, 0.0]], [5.0])
        """
        faces, weights, distances = barycentric_at(mesh, positions)
        return cls(mesh.faces[faces], weights), distances

    def __len__(self) -> int:
        return len(self.corners)

    def __getitem__(self, chosen: ArrayLike) -> "Sites":
        """The sites with these indices, or those that are true."""
        index = np.asarray(chosen)
        index = index if index.size else index.astype(np.int64)
        return Sites(self.corners[index], self.weights[index])

    def of(self, values: Floats) -> Floats:
        """What a map with these values at the vertices, shape (n,) or (n, c), is at the sites.

        Linear in each triangle; shape (m,) or (m, c).
        """
        at_corners = values[self.corners]
        weights = self.weights.reshape(*self.weights.shape, *[1] * (values.ndim - 1))
        interpolated: Floats = (weights * at_corners).sum(axis=1)
        return interpolated

    def positions(self, mesh: Mesh) -> Points:
        """Where the sites lie, shape (m, 3), mm."""
        return self.of(mesh.vertices)

    @property
    def nearest_vertices(self) -> Integers:
        """The vertex of largest weight of each site, shape (m,)."""
        chosen: Integers = np.take_along_axis(
            self.corners, self.weights.argmax(axis=1)[:, None], axis=1
        )[:, 0]
        return chosen
