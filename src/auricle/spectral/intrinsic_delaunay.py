"""The intrinsic Delaunay triangulation of a closed surface.

Edges are flipped along the surface until no two triangles beside one have opposite angles of more
than π together. The surface and its vertices stay; cotangent weights are then never negative.
"""

from dataclasses import dataclass

import numpy as np

from auricle.arrays import Faces, Floats, Integers, Points
from auricle.compiled import compiled
from auricle.errors import SurfaceError
from auricle.surface.halfedges import AFTER, BEFORE, NONE, ORIGIN, Indices, flip, half_edges

_MOLLIFIED = 1e-5
"""Of the mean edge: what two sides of a triangle are longer than the third, together, at least."""
_FLAT = 1e-9
"""Two cotangents of opposite sign that differ by less than this share of them are not worth a
flip, which rounding might ask to be taken back."""
_MOST_FLIPS = 100
"""For each half-edge: more are no end in sight."""


@dataclass(frozen=True, eq=False)
class IntrinsicTriangles:
    """Triangles that lie in a surface, not in space, told by their half-edges.

    Attributes
    ----------
    origins, ends
        Vertices that each half-edge leads from and to, shape (h,).
    doubled_dots
        Twice the product of the other two sides of its triangle and the cosine between them,
        shape (h,), mm²: the cotangent of that angle times four areas.
    areas
        Of its triangle, shape (h,), mm².
    """

    origins: Integers
    ends: Integers
    doubled_dots: Floats
    areas: Floats


def intrinsic_delaunay(vertices: Points, faces: Faces) -> IntrinsicTriangles | None:
    """The intrinsic Delaunay triangulation of a closed, oriented surface in one piece.

    None of any other surface, and where rounding lets flips not come to an end. Triangles next to
    a line are mollified first: every edge is made longer by what it takes.

    References
    ----------
    Bobenko & Springborn 2007, "A discrete Laplace-Beltrami operator for simplicial surfaces";
    Sharp & Crane 2020, "A Laplacian for nonmanifold triangle meshes", § 4.

    Examples
    --------
    A sphere pulled long keeps its area, and loses its obtuse pairs of angles:

    >>> from dataclasses import replace
    >>> from auricle.surface.shapes import icosphere
    >>> sphere = icosphere(radius=10.0, subdivisions=2)
    >>> long = replace(sphere, vertices=sphere.vertices * np.array([1, 1, 5]))
    >>> triangles = intrinsic_delaunay(long.vertices, long.faces)
    >>> bool(abs(triangles.areas.sum() / 3 / long.area - 1) < 1e-12)
    True
    """
    try:
        table = half_edges(faces, len(vertices)).half_edges
    except SurfaceError:
        return None
    if (table[:, AFTER] == NONE).any():
        return None
    ends = vertices[table[:, ORIGIN]]
    lengths = np.linalg.norm(ends[::2] - ends[1::2], axis=1)
    lengths += max(_MOLLIFIED * lengths.mean() - _least_spare(table, lengths), 0.0)
    if not _flip_all(table, lengths):
        return None
    doubled_dots, areas = _measured(table, lengths)
    origins = table[:, ORIGIN].astype(np.int64)
    return IntrinsicTriangles(origins, origins[np.arange(len(table)) ^ 1], doubled_dots, areas)


@compiled
def _sides(table: Indices, lengths: Floats, half_edge: int) -> tuple[float, float, float]:
    """Lengths of a half-edge and of the two that follow it around its triangle."""
    return (
        lengths[half_edge // 2],
        lengths[table[half_edge, AFTER] // 2],
        lengths[table[half_edge, BEFORE] // 2],
    )


@compiled
def _least_spare(table: Indices, lengths: Floats) -> float:
    """By how much two sides of a triangle are longer than the third, at least."""
    least = np.inf
    for half_edge in range(len(table)):
        a, b, c = _sides(table, lengths, half_edge)
        least = min(least, b + c - a)
    return least


@compiled
def _area(a: float, b: float, c: float) -> float:
    """Heron's formula as Kahan writes it, right to rounding for needles too."""
    longest, shortest = max(a, b, c), min(a, b, c)
    middle = max(min(a, b), min(max(a, b), c))
    inside = (longest + (middle + shortest)) * (shortest - (longest - middle))
    inside *= (shortest + (longest - middle)) * (longest + (middle - shortest))
    return float(np.sqrt(max(inside, 0.0)) / 4)


@compiled
def _opposite(table: Indices, lengths: Floats, half_edge: int) -> tuple[float, float]:
    """Of the angle opposite a half-edge: the doubled dot product of its sides; and the area."""
    a, b, c = _sides(table, lengths, half_edge)
    return b * b + c * c - a * a, _area(a, b, c)


@compiled
def _measured(table: Indices, lengths: Floats) -> tuple[Floats, Floats]:
    doubled_dots, areas = np.empty(len(table)), np.empty(len(table))
    for half_edge in range(len(table)):
        doubled_dots[half_edge], areas[half_edge] = _opposite(table, lengths, half_edge)
    return doubled_dots, areas


@compiled
def _is_delaunay(table: Indices, lengths: Floats, half_edge: int) -> bool:
    """Whether the cotangents opposite an edge add up to no less than 0."""
    one, area = _opposite(table, lengths, half_edge)
    other, other_area = _opposite(table, lengths, half_edge ^ 1)
    one, other = one * other_area, other * area
    return bool(one + other >= -_FLAT * (abs(one) + abs(other)))


@compiled
def _flip_all(table: Indices, lengths: Floats) -> bool:
    """Flip edges, in place, until all are Delaunay; whether that came to an end."""
    waiting, queued = np.arange(len(lengths)), np.ones(len(lengths), np.bool_)
    count, n_flips = len(lengths), 0
    while count > 0:
        count -= 1
        edge = waiting[count]
        queued[edge] = False
        if _is_delaunay(table, lengths, 2 * edge):
            continue
        lengths[edge] = _other_diagonal(table, lengths, 2 * edge)
        flip(table, 2 * edge)
        n_flips += 1
        if n_flips > _MOST_FLIPS * len(table):
            return False
        for half_edge in (2 * edge, 2 * edge + 1):
            for side in (table[half_edge, AFTER] // 2, table[half_edge, BEFORE] // 2):
                if not queued[side]:
                    waiting[count] = side
                    queued[side] = True
                    count += 1
    return True


@compiled
def _other_diagonal(table: Indices, lengths: Floats, half_edge: int) -> float:
    """Between the tips of the two triangles beside an edge, laid flat."""
    edge, from_end, to_origin = _sides(table, lengths, half_edge)
    _, from_origin, to_end = _sides(table, lengths, half_edge ^ 1)
    x = (edge * edge + to_origin * to_origin - from_end * from_end) / (2 * edge)
    y = 2 * _area(edge, from_end, to_origin) / edge
    u = (edge * edge + from_origin * from_origin - to_end * to_end) / (2 * edge)
    v = 2 * _area(edge, from_origin, to_end) / edge
    return float(np.sqrt((x - u) ** 2 + (y + v) ** 2))
