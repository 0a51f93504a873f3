"""Shapes of closed form: meshes whose area, volume and harmonics are known."""

from collections.abc import Sequence

import numpy as np

from auricle.arrays import Faces, Integers, Points
from auricle.errors import InputError
from auricle.surface.mesh import Mesh


def icosphere(*, radius: float, subdivisions: int) -> Mesh:
    """Sphere about the origin: an icosahedron whose faces are split in four, over and over.

    Parameters
    ----------
    radius
        Distance of every vertex from the origin, mm.
    subdivisions
        How often each face is split; 0 gives the icosahedron itself.

    Returns
    -------
    Mesh
        10·4^s + 2 vertices, all on the sphere; 20·4^s faces, outward.

    Raises
    ------
    InputError
        If the radius is not positive or the number of subdivisions is negative.

    Examples
    --------
    >>> sphere = icosphere(radius=30.0, subdivisions=3)
    >>> sphere.n_vertices, sphere.n_faces
    (642, 1280)
    >>> bool(np.allclose(np.linalg.norm(sphere.vertices, axis=1), 30.0))
    True
    """
    return ellipsoid(semi_axes=(radius, radius, radius), subdivisions=subdivisions)


def ellipsoid(*, semi_axes: tuple[float, float, float], subdivisions: int) -> Mesh:
    """Ellipsoid about the origin: the icosphere stretched along x, y and z.

    Parameters
    ----------
    semi_axes
        Half the extent along x, y and z, mm.
    subdivisions
        As in `icosphere`.

    Returns
    -------
    Mesh
        10·4^s + 2 vertices, all on the ellipsoid; 20·4^s faces, outward.

    Raises
    ------
    InputError
        If a semi-axis is not positive or the number of subdivisions is negative.

    Examples
    --------
    >>> x, y, z = ellipsoid(semi_axes=(3.0, 4.0, 5.0), subdivisions=2).vertices.T
    >>> bool(np.allclose((x / 3) ** 2 + (y / 4) ** 2 + (z / 5) ** 2, 1.0))
    True
    """
    _demand_positive(semi_axes, "semi-axes")
    _demand_at_least(subdivisions, 0, "subdivisions")
    vertices, faces = _icosahedron()
    for _ in range(subdivisions):
        vertices, faces = _split_in_four(vertices, faces)
        vertices = vertices / np.linalg.norm(vertices, axis=1, keepdims=True)
    return Mesh(vertices * np.asarray(semi_axes), faces)


def rectangle(*, width: float, height: float, n_x: int, n_y: int) -> Mesh:
    """Flat rectangle [0, width] × [0, height] in the plane z = 0, normal +z, one boundary loop.

    The cells' diagonals alternate as on a chessboard, so that neither is preferred.

    Parameters
    ----------
    width, height
        Extent along x and y, mm.
    n_x, n_y
        Number of vertices along x and y; vertex ``j * n_x + i`` is the i-th along x and the
        j-th along y.

    Returns
    -------
    Mesh
        n_x·n_y vertices, 2(n_x - 1)(n_y - 1) faces.

    Raises
    ------
    InputError
        If an extent is not positive or there are fewer than two vertices along an axis.

    Examples
    --------
    >>> round(rectangle(width=4.0, height=2.5, n_x=7, n_y=5).area, 12)
    10.0
    """
    _demand_positive((width, height), "extents")
    _demand_at_least(min(n_x, n_y), 2, "vertices along an axis")
    x, y = np.meshgrid(np.linspace(0.0, width, n_x), np.linspace(0.0, height, n_y))
    vertices = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    return Mesh(vertices, _triangles(np.arange(n_x * n_y).reshape(n_y, n_x)))


def torus(*, major: float, minor: float, n_major: int, n_minor: int) -> Mesh:
    """Torus about the z axis: area 4π²·major·minor, volume 2π²·major·minor².

    Parameters
    ----------
    major
        Distance from the axis to the middle of the tube, mm.
    minor
        Radius of the tube, mm.
    n_major, n_minor
        Number of vertices around the axis and around the tube; even numbers keep the
        diagonals alternating all the way round.

    Returns
    -------
    Mesh
        n_major·n_minor vertices, all on the torus; twice as many faces, outward.

    Raises
    ------
    InputError
        If the tube is not narrower than the ring, or there are fewer than three vertices
        around.

    Examples
    --------
    >>> ring = torus(major=20.0, minor=5.0, n_major=16, n_minor=8)
    >>> bool(np.allclose((np.hypot(*ring.vertices.T[:2]) - 20) ** 2 + ring.vertices[:, 2] ** 2, 25))
    True
    """
    _demand_positive((major, minor, major - minor), "radii of a torus and their difference")
    _demand_at_least(min(n_major, n_minor), 3, "vertices around a torus")
    around = 2.0 * np.pi * np.arange(n_major)[:, None] / n_major
    tube = 2.0 * np.pi * np.arange(n_minor)[None, :] / n_minor
    distance = major + minor * np.cos(tube)
    vertices = np.stack(
        [
            distance * np.cos(around),
            distance * np.sin(around),
            np.broadcast_to(minor * np.sin(tube), (n_major, n_minor)),
        ],
        axis=-1,
    )
    index = np.arange(n_major * n_minor).reshape(n_major, n_minor)
    wrapped = np.pad(index, ((0, 1), (0, 1)), mode="wrap")
    return Mesh(vertices.reshape(-1, 3), _triangles(wrapped.T))


def cube(*, side: float, n: int) -> Mesh:
    """Cube about the origin, each side cut into n × n squares of two triangles.

    Parameters
    ----------
    side
        Length of an edge, mm.
    n
        Number of squares along an edge.

    Returns
    -------
    Mesh
        6n² + 2 vertices, shared along the edges; 12n² faces, outward.

    Raises
    ------
    InputError
        If the side is not positive or n is less than 1.

    Examples
    --------
    >>> box = cube(side=2.0, n=3)
    >>> box.n_vertices, box.n_faces, round(box.area, 12)
    (56, 108, 24.0)
    """
    _demand_positive((side,), "sides")
    _demand_at_least(n, 1, "squares along an edge")
    first, second = np.meshgrid(np.arange(n + 1), np.arange(n + 1))
    near, far = np.zeros_like(first), np.full_like(first, n)
    lattice = np.concatenate(
        [
            np.roll(np.stack(plane, axis=-1).reshape(-1, 3), axis, axis=1)
            for plane in ((first, second, far), (second, first, near))
            for axis in range(3)
        ]
    )
    corners, index = np.unique(lattice, axis=0, return_inverse=True)
    sides = index.reshape(6, n + 1, n + 1)
    return Mesh(side * (corners / n - 0.5), np.concatenate([_triangles(grid) for grid in sides]))


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """Disjoint union: all vertices and faces of the meshes, in their order, none merged.

    Raises
    ------
    InputError
        If there is no mesh.

    Examples
    --------
    >>> ball = icosphere(radius=1.0, subdivisions=0)
    >>> joined([ball, ball]).n_faces
    40
    """
    _demand_at_least(len(meshes), 1, "meshes to join")
    starts = np.cumsum([0, *(mesh.n_vertices for mesh in meshes[:-1])])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.faces + start for mesh, start in zip(meshes, starts, strict=True)]),
    )


def _icosahedron() -> tuple[Points, Faces]:
    """Vertices on the unit sphere (a pole, two rings of five, a pole) and outward faces."""
    turn = 2.0 * np.pi * np.arange(5) / 5.0
    height = 1.0 / np.sqrt(5.0)
    upper = np.column_stack([2 * height * np.cos(turn), 2 * height * np.sin(turn), [height] * 5])
    lower = -upper[[3, 4, 0, 1, 2]]  # starts half a turn of a side after the upper ring
    vertices = np.concatenate([[(0.0, 0.0, 1.0)], upper, lower, [(0.0, 0.0, -1.0)]])
    here, after = np.arange(5), (np.arange(5) + 1) % 5
    faces = np.concatenate(
        [
            np.column_stack([np.zeros(5, dtype=np.int64), 1 + here, 1 + after]),
            np.column_stack([1 + here, 6 + here, 1 + after]),
            np.column_stack([1 + after, 6 + here, 6 + after]),
            np.column_stack([np.full(5, 11), 6 + after, 6 + here]),
        ]
    )
    return vertices, faces


def _split_in_four(vertices: Points, faces: Faces) -> tuple[Points, Faces]:
    """Add the middle of every edge and cut each face along them."""
    edges = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    unique, index = np.unique(edges, axis=0, return_inverse=True)
    ab, bc, ca = (len(vertices) + index.reshape(-1, 3)).T
    a, b, c = faces.T
    corners = [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    split = np.concatenate([np.column_stack(corner) for corner in corners])
    return np.concatenate([vertices, vertices[unique].mean(axis=1)]), split


def _triangles(index: Integers) -> Faces:
    """Two triangles for each cell of a grid of vertex indices, diagonals alternating.

    The second axis of the grid comes before the first in the right-hand sense of the faces.
    """
    a, b = index[:-1, :-1].ravel(), index[:-1, 1:].ravel()
    d, c = index[1:, :-1].ravel(), index[1:, 1:].ravel()
    even = (np.indices(index[1:, 1:].shape).sum(axis=0) % 2 == 0).ravel()
    first = np.where(even, (a, b, c), (a, b, d))
    second = np.where(even, (a, c, d), (b, c, d))
    faces: Faces = np.concatenate([first.T, second.T])
    return faces


def _demand_positive(values: Sequence[float], name: str) -> None:
    if not (np.asarray(values) > 0).all():
        raise InputError(f"{name} {tuple(values)}: give positive numbers (mm)")


def _demand_at_least(count: int, least: int, name: str) -> None:
    if count < least:
        raise InputError(f"{count} {name}: give at least {least}")
