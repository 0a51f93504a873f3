"""The intrinsic Delaunay triangulation of a closed surface: its lengths and corners.

Edges are flipped along the surface until no two triangles beside one have opposite angles of more
than π together. The surface and its vertices stay; cotangent weights are then never negative.
"""

from dataclasses import dataclass

import numpy as np

from auricle.arrays import Faces, Floats, Integers, Points
from auricle.compiled import compiled

_MOLLIFIED = 1e-5
"""Of the mean edge: what two edges of a triangle are longer than the third, together, at least."""
_FLAT = 1e-12
"""Cotangents that add up to more than minus this are not worth a flip."""


@dataclass(frozen=True, eq=False)
class IntrinsicTriangles:
    """Triangles that lie in a surface, not in space.

    Half-edge 3·f + c leads from corner c of triangle f to the next.

    Attributes
    ----------
    origins
        Vertex that each half-edge begins at, shape (f, 3).
    lengths
        Of each half-edge, shape (f, 3), mm.
    """

    origins: Integers
    lengths: Floats

    @property
    def areas(self) -> Floats:
        """Of each triangle, shape (f,), mm²."""
        return np.asarray(_areas(self.lengths))


def intrinsic_delaunay(vertices: Points, faces: Faces) -> IntrinsicTriangles | None:
    """The intrinsic Delaunay triangulation of a closed, oriented surface; None of any other.

    Triangles next to a line are mollified first: every edge is made longer by what it takes.

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
    >>> bool(abs(triangles.areas.sum() / long.area - 1) < 1e-12)
    True
    """
    twins = _twins(faces)
    if twins is None:
        return None
    ends = np.roll(faces, -1, axis=1)
    lengths = np.linalg.norm(vertices[faces] - vertices[ends], axis=2)
    spare = np.roll(lengths, -1, axis=1) + np.roll(lengths, 1, axis=1) - lengths
    lengths = lengths + max(_MOLLIFIED * lengths.mean() - spare.min(), 0.0)
    origins = faces.astype(np.int64)
    _flip_all(origins.reshape(-1), lengths.reshape(-1), twins)
    return IntrinsicTriangles(origins, lengths)


def _twins(faces: Faces) -> Integers | None:
    """Of each half-edge the one that leads back; None unless there is exactly one of each."""
    start, end = faces.ravel().astype(np.int64), np.roll(faces, -1, axis=1).ravel()
    n = int(faces.max()) + 1
    there, back = start * n + end, end * n + start
    order = np.argsort(there, kind="stable")
    places = np.searchsorted(there[order], back)
    found = order[np.minimum(places, len(order) - 1)]
    if np.any(np.diff(there[order]) == 0) or np.any(there[found] != back):
        return None
    return np.asarray(found, np.int64)


@compiled
def _areas(lengths: Floats) -> Floats:
    areas = np.empty(len(lengths))
    for f in range(len(lengths)):
        areas[f] = _area(lengths[f, 0], lengths[f, 1], lengths[f, 2])
    return areas


@compiled
def _area(a: float, b: float, c: float) -> float:
    """Heron's formula as Kahan writes it, right to rounding for needles too."""
    longest, shortest = max(a, b, c), min(a, b, c)
    middle = a + b + c - longest - shortest
    if longest == a:
        middle = max(b, c)
    elif longest == b:
        middle = max(a, c)
    else:
        middle = max(a, b)
    inside = (longest + (middle + shortest)) * (shortest - (longest - middle))
    inside *= (shortest + (longest - middle)) * (longest + (middle - shortest))
    return float(np.sqrt(max(inside, 0.0)) / 4)


@compiled
def _flip_all(origins: Integers, lengths: Floats, twins: Integers) -> None:
    """Flip edges, in place, until all are Delaunay."""
    waiting = np.arange(len(twins))
    queued = np.ones(len(twins), np.bool_)
    count = len(waiting)
    while count > 0:
        count -= 1
        h = waiting[count]
        queued[h] = False
        if h // 3 == twins[h] // 3:
            continue
        if _cotangent(lengths, h) + _cotangent(lengths, twins[h]) >= -_FLAT:
            continue
        t = twins[h]
        _flip(origins, lengths, twins, h)
        for corner in range(3):
            for face in (h // 3, t // 3):
                edge = 3 * face + corner
                if not (queued[edge] or queued[twins[edge]]):
                    waiting[count] = edge
                    queued[edge] = True
                    count += 1


@compiled
def _next(h: int) -> int:
    return h + 1 if h % 3 < 2 else h - 2


@compiled
def _cotangent(lengths: Floats, h: int) -> float:
    """Of the angle opposite a half-edge."""
    a, b, c = lengths[h], lengths[_next(h)], lengths[_next(_next(h))]
    return float((b * b + c * c - a * a) / (4 * _area(a, b, c)))


@compiled
def _flip(origins: Integers, lengths: Floats, twins: Integers, h: int) -> None:
    """Put the other diagonal of the two triangles beside an edge in its place.

    Of a→b→c and b→a→d they become c→a→d, whose last edge is new, and d→b→c.
    """
    t = twins[h]
    hn, tn = _next(h), _next(t)
    hp, tp = _next(hn), _next(tn)
    length = _other_diagonal(lengths[h], (lengths[hn], lengths[hp]), (lengths[tn], lengths[tp]))
    old = (hp, tn, tp, hn)
    corner = (origins[hp], origins[tn], origins[tp], origins[hn])
    sides = (lengths[hp], lengths[tn], lengths[tp], lengths[hn])
    beyond = (twins[hp], twins[tn], twins[tp], twins[hn])
    first, second = 3 * (h // 3), 3 * (t // 3)
    new = (first, first + 1, second, second + 1)
    for i in range(4):
        origins[new[i]], lengths[new[i]] = corner[i], sides[i]
    for i in range(4):
        twin = beyond[i]
        for j in range(4):
            if beyond[i] == old[j]:
                twin = new[j]
        twins[new[i]], twins[twin] = twin, new[i]
    origins[first + 2], origins[second + 2] = corner[2], corner[0]
    lengths[first + 2] = lengths[second + 2] = length
    twins[first + 2], twins[second + 2] = second + 2, first + 2


@compiled
def _other_diagonal(edge: float, one: tuple[float, float], other: tuple[float, float]) -> float:
    """Between the tips of two triangles laid flat beside an edge a→b.

    `one` has the sides from b and to a, `other` those from a and to b.
    """
    x = (edge * edge + one[1] * one[1] - one[0] * one[0]) / (2 * edge)
    y = 2 * _area(edge, one[0], one[1]) / edge
    u = (edge * edge + other[0] * other[0] - other[1] * other[1]) / (2 * edge)
    v = 2 * _area(edge, other[0], other[1]) / edge
    return float(np.sqrt((x - u) ** 2 + (y + v) ** 2))
