"""Quadrics: squared distance to the planes of faces, in a space of positions and features.

A vertex is a point in d dimensions, three of them its position and one for each feature. The
quadric of a triangle is the squared distance to the plane that holds it (Garland and Heckbert,
*Simplifying surfaces with color and texture using quadric error metrics*, Visualization 1998,
section 3): for orthonormal e₁, e₂ along the triangle and a point p of it, with I the identity,

    (x - p)ᵀ (I - e₁e₁ᵀ - e₂e₂ᵀ) (x - p).

Quadrics are kept about the place where their vertex is, so that a far origin costs no digits.
"""

from typing import NamedTuple

import numpy as np

from auricle.arrays import Faces, Floats
from auricle.compiled import compiled, compiled_in_place
from auricle.surface.quadric_in_space import (
    FARTHEST,
    SMALLEST_PIVOT,
    add_faces_in_space,
    move_in_space,
    optimum_in_space,
)

POSITION = 3
"""Dimensions without features."""


class Quadrics(NamedTuple):
    """What there is to know of n vertices in d dimensions, changed in place by `unite`.

    With y = x - place, the quadric of a vertex is yᵀAy + 2bᵀy + c, and the squared distance to
    the points it stands for, which is part of it, m|y|² + 2sᵀy + t.

    Attributes
    ----------
    places
        Where the vertices are, shape (n, d), mm.
    planes
        A row a vertex: the lower triangle of A row by row, then b, then c; mm² to mm⁴.
    points
        A row a vertex: m, then s, then t; mm² to mm⁴.
    """

    places: Floats
    planes: Floats
    points: Floats


def vertex_quadrics(
    places: Floats, faces: Faces, boundary: Faces, *, boundary_weight: float, evenness: float
) -> Quadrics:
    """Quadrics of vertices from the faces around them.

    Each face adds its quadric times a third of its area to each corner. Each boundary edge adds,
    to both ends, the squared distance along the face at right angles to the edge, weighted by
    `boundary_weight` times its squared length. The squared distance to the vertex itself, times
    `evenness` times its area, makes the optimum unique on flat and straight parts.

    Parameters
    ----------
    places
        Shape (n, d), d ≥ 3, positions in the first three columns, mm.
    faces
        Shape (f, 3).
    boundary
        Shape (b, 3): the two ends of each boundary edge, and the corner opposite.
    boundary_weight, evenness
        Plain numbers, not negative.

    Examples
    --------
    >>> from auricle.surface.shapes import rectangle
    >>> plate = rectangle(width=2.0, height=2.0, n_x=3, n_y=3)
    >>> none = np.empty((0, 3), dtype=np.int64)
    >>> found = vertex_quadrics(
    ...     plate.vertices, plate.faces.copy(), none, boundary_weight=0.0, evenness=0.0
    ... )
    >>> round(float(found.planes[:, 5].sum()), 12)  # A's share across the plane: all of the area
    4.0
    """
    dimension = places.shape[1]
    n_columns = dimension * (dimension + 1) // 2 + dimension + 1
    found = Quadrics(
        places.copy(),
        np.zeros((len(places), n_columns)),
        np.zeros((len(places), dimension + 2)),
    )
    add_faces = add_faces_in_space if dimension == POSITION else _add_faces
    add_faces(*found, faces, evenness)
    _add_boundary(found.places, found.planes, boundary, boundary_weight)
    _add_points(found.planes, found.points)
    return found


def workspace(dimension: int) -> Floats:
    """Room for `optimum`: a matrix, two vectors, and in the last row the place found."""
    return np.zeros((dimension + 3, dimension))


@compiled_in_place
def optimum(places: Floats, planes: Floats, one: int, other: int, room: Floats) -> float:
    """Least sum of the quadrics of two vertices, mm⁴; where it is goes into ``room[-1]``.

    Where the optimum is not unique to rounding, or further from the middle of the two than
    `FARTHEST` times their distance, the best of the two and their middle is taken instead.
    """
    if room.shape[1] == POSITION:
        cost = optimum_in_space(places, planes, one, other, room)
    else:
        cost = _optimum_in_features(places, planes, one, other, room)
    if cost < 0.0:
        cost = _best_of_three(places, planes, one, other, room)
    return cost


@compiled_in_place
def unite(
    places: Floats, planes: Floats, points: Floats, kept: int, gone: int, room: Floats
) -> float:
    """Move two vertices to ``room[-1]`` and add their quadrics; return the growth of the planes'.

    The growth is in mm⁴ and leaves out the squared distances to the points.
    """
    before = planes[kept, -1] + planes[gone, -1] - points[kept, -1] - points[gone, -1]
    for vertex in (kept, gone):
        if room.shape[1] == POSITION:
            move_in_space(places, planes, points, vertex, room)
        else:
            _move(places, planes, points, vertex, room)
    for column in range(planes.shape[1]):
        planes[kept, column] += planes[gone, column]
    for column in range(points.shape[1]):
        points[kept, column] += points[gone, column]
    return float(planes[kept, -1] - points[kept, -1] - before)


@compiled_in_place
def _optimum_in_features(
    places: Floats, planes: Floats, one: int, other: int, room: Floats
) -> float:
    """Least sum of two quadrics, its place into ``room[-1]``; below 0 where there is none."""
    dimension = room.shape[1]
    vector, offset, place = room[-3], room[-2], room[-1]
    constant = _sum_about_first(places, planes, one, other, room)
    if not _factored(room):
        return -1.0
    _substitute(room)
    distance, length = 0.0, 0.0
    for i in range(dimension):
        distance += (place[i] + 0.5 * offset[i]) ** 2
        length += offset[i] ** 2
        constant += vector[i] * place[i]
        place[i] += places[one, i]
    if not distance <= FARTHEST**2 * length:
        return -1.0
    return max(constant, 0.0)


@compiled_in_place
def _sum_about_first(places: Floats, planes: Floats, one: int, other: int, room: Floats) -> float:
    """Sum two quadrics about the first vertex: A and b into `room`, c returned."""
    dimension = room.shape[1]
    vector, offset = room[-3], room[-2]
    for i in range(dimension):
        offset[i] = places[one, i] - places[other, i]
        vector[i] = 0.0
    k = 0
    for i in range(dimension):
        for j in range(i):
            room[i, j] = planes[one, k] + planes[other, k]
            vector[i] += planes[other, k] * offset[j]
            vector[j] += planes[other, k] * offset[i]
            k += 1
        room[i, i] = planes[one, k] + planes[other, k]
        vector[i] += planes[other, k] * offset[i]
        k += 1
    constant = planes[one, -1] + planes[other, -1]
    for i in range(dimension):
        constant += offset[i] * (2.0 * planes[other, k + i] + vector[i])
        vector[i] += planes[one, k + i] + planes[other, k + i]
    return float(constant)


@compiled_in_place
def _factored(room: Floats) -> bool:
    """Factor A in place by Cholesky's method; whether it is regular."""
    for j in range(room.shape[1]):
        whole = room[j, j]
        for k in range(j):
            room[j, j] -= room[j, k] ** 2
        if not room[j, j] > SMALLEST_PIVOT * whole:
            return False
        room[j, j] = np.sqrt(room[j, j])
        for i in range(j + 1, room.shape[1]):
            for k in range(j):
                room[i, j] -= room[i, k] * room[j, k]
            room[i, j] /= room[j, j]
    return True


@compiled_in_place
def _substitute(room: Floats) -> None:
    """Solve A y = -b with the factors of A; y into ``room[-1]``."""
    dimension = room.shape[1]
    for i in range(dimension):
        room[-1, i] = -room[-3, i]
        for k in range(i):
            room[-1, i] -= room[i, k] * room[-1, k]
        room[-1, i] /= room[i, i]
    for i in range(dimension - 1, -1, -1):
        for k in range(i + 1, dimension):
            room[-1, i] -= room[k, i] * room[-1, k]
        room[-1, i] /= room[i, i]


@compiled_in_place
def _best_of_three(places: Floats, planes: Floats, one: int, other: int, room: Floats) -> float:
    """Least sum at the two vertices and at their middle, into ``room[-1]``."""
    least, best = np.inf, 0.5
    for share in (0.5, 0.0, 1.0):
        _between(places, one, other, share, room)
        cost = _value(places, planes, one, room) + _value(places, planes, other, room)
        if cost < least:
            least, best = cost, share
    _between(places, one, other, best, room)
    return max(least, 0.0)


@compiled_in_place
def _between(places: Floats, one: int, other: int, share: float, room: Floats) -> None:
    for i in range(room.shape[1]):
        room[-1, i] = (1.0 - share) * places[one, i] + share * places[other, i]


@compiled_in_place
def _value(places: Floats, planes: Floats, vertex: int, room: Floats) -> float:
    """Quadric of a vertex at ``room[-1]``."""
    dimension = room.shape[1]
    k, linear = 0, planes.shape[1] - 1 - dimension
    value = planes[vertex, -1]
    for i in range(dimension):
        step = room[-1, i] - places[vertex, i]
        for j in range(i):
            value += 2.0 * planes[vertex, k] * step * (room[-1, j] - places[vertex, j])
            k += 1
        value += step * (planes[vertex, k] * step + 2.0 * planes[vertex, linear + i])
        k += 1
    return float(value)


@compiled_in_place
def _move(places: Floats, planes: Floats, points: Floats, vertex: int, room: Floats) -> None:
    """Express the quadric of a vertex about ``room[-1]``, and put the vertex there."""
    dimension = room.shape[1]
    k, linear = 0, planes.shape[1] - 1 - dimension
    constant, spread, mass = planes[vertex, -1], points[vertex, -1], points[vertex, 0]
    for i in range(dimension):
        constant += (room[-1, i] - places[vertex, i]) * planes[vertex, linear + i]
    for i in range(dimension):
        step = room[-1, i] - places[vertex, i]
        for j in range(i):
            planes[vertex, linear + i] += planes[vertex, k] * (room[-1, j] - places[vertex, j])
            planes[vertex, linear + j] += planes[vertex, k] * step
            k += 1
        planes[vertex, linear + i] += planes[vertex, k] * step
        k += 1
        spread += step * (mass * step + 2.0 * points[vertex, 1 + i])
        points[vertex, 1 + i] += mass * step
    for i in range(dimension):
        constant += (room[-1, i] - places[vertex, i]) * planes[vertex, linear + i]
        places[vertex, i] = room[-1, i]
    planes[vertex, -1] = max(constant, 0.0)
    points[vertex, -1] = spread


@compiled
def _add_faces(
    places: Floats, planes: Floats, points: Floats, faces: Faces, evenness: float
) -> None:
    """Add to each corner a third of the area times (I - e₁e₁ᵀ - e₂e₂ᵀ); the corner lies on it."""
    dimension = places.shape[1]
    along, across = np.empty(dimension), np.empty(dimension)
    for face in range(len(faces)):
        third = _frame(places, faces, face, along, across) / 3.0
        for c in range(3):
            corner, k = faces[face, c], 0
            points[corner, 0] += evenness * third
            for i in range(dimension):
                for j in range(i + 1):
                    planes[corner, k] -= third * (along[i] * along[j] + across[i] * across[j])
                    k += 1
                planes[corner, k - 1] += third


@compiled
def _add_boundary(places: Floats, planes: Floats, boundary: Faces, weight: float) -> None:
    """Add to the ends of each boundary edge its weight times e₂e₂ᵀ, e₂ at right angles to it."""
    dimension = places.shape[1]
    along, across = np.empty(dimension), np.empty(dimension)
    for edge in range(len(boundary)):
        _frame(places, boundary, edge, along, across)
        length = 0.0
        for i in range(dimension):
            length += (places[boundary[edge, 1], i] - places[boundary[edge, 0], i]) ** 2
        for c in range(2):
            end, k = boundary[edge, c], 0
            for i in range(dimension):
                for j in range(i + 1):
                    planes[end, k] += weight * length * across[i] * across[j]
                    k += 1


@compiled_in_place
def _add_points(planes: Floats, points: Floats) -> None:
    """Add the squared distance to the vertex itself."""
    for vertex in range(len(planes)):
        k = -1
        for i in range(points.shape[1] - 2):
            k += i + 1
            planes[vertex, k] += points[vertex, 0]


@compiled_in_place
def _frame(places: Floats, faces: Faces, face: int, along: Floats, across: Floats) -> float:
    """Orthonormal vectors along a triangle, the first along its first side, and its area.

    They are 0 where the triangle has no extent in their direction.
    """
    dimension = len(along)
    for i in range(dimension):
        along[i] = places[faces[face, 1], i] - places[faces[face, 0], i]
        across[i] = places[faces[face, 2], i] - places[faces[face, 0], i]
    base = _normalised(along)
    shift = 0.0
    for i in range(dimension):
        shift += along[i] * across[i]
    for i in range(dimension):
        across[i] -= shift * along[i]
    return 0.5 * base * _normalised(across)


@compiled_in_place
def _normalised(vector: Floats) -> float:
    """Divide a vector by its length, unless that is 0; return the length."""
    squared = 0.0
    for i in range(len(vector)):
        squared += vector[i] ** 2
    length = np.sqrt(squared)
    if length > 0.0:
        for i in range(len(vector)):
            vector[i] /= length
    return float(length)
