"""Fast marching: geodesic distances that grow outwards from a source and stop where it is in vain.

As fast marching (Kimmel and Sethian 1998) the front takes in the nearest vertex first. Within a
triangle two known distances place a virtual source in its plane, as if the triangles behind it
were unfolded, and the third distance is the straight line from there (as Novotni and Klein 2002);
where that line leaves the triangle, distances run along edges. A vertex whose distance still
shrinks after it was taken in is taken in again, so that obtuse triangles need no special care.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from auricle.arrays import Faces, Floats, Integers, PerVertex, read_only
from auricle.compiled import compiled
from auricle.errors import InputError
from auricle.surface.mesh import Mesh

_LEAST_GAIN = 1e-9
"""A distance is revised only if it shrinks by more than this share: the march must end."""


class _Fans(NamedTuple):
    """Triangles around each vertex: those of v are rows starts[v] to starts[v + 1].

    `others` holds the other two corners p, q; `lengths` those of the sides vp, vq and pq.
    """

    starts: Integers
    others: Integers
    lengths: Floats


class _Front(NamedTuple):
    """A march under way: distances so far and the vertices to take in, nearest on top."""

    distance: Floats
    heap: Integers
    place: Integers
    touched: Integers
    counts: Integers


class FastMarching:
    """Distances along one mesh, from the triangles around each vertex, gathered once.

    Measured against `exact_geodesic_distances`: relative error 0.2 % in the median, 0.7 % at the
    95th percentile and at most 1.8 % on generated atria (2,400 and 3,300 vertices), likewise on a
    sphere (2,562), where the greatest is at the far side. The heat method's: 1 %, 3 % and 27 %.
    One object serves one thread.

    Parameters
    ----------
    mesh
        Any surface; holes and several pieces are allowed.

    Examples
    --------
    >>> from auricle.surface.shapes import icosphere
    >>> sphere = icosphere(radius=10.0, subdivisions=4)
    >>> far = FastMarching(sphere).from_source([0]).max()  # half-way round: 10π
    >>> bool(abs(far / (10 * np.pi) - 1) < 0.02)
    True
    """

    def __init__(self, mesh: Mesh) -> None:
        n = mesh.n_vertices
        self.n_vertices = n
        self._fans = _fans(mesh)
        self._front = _Front(
            np.full(n, np.inf),
            np.empty(n, np.int64),
            np.full(n, -1),
            np.empty(n, np.int64),
            np.zeros(2, np.int64),
        )

    def from_source(
        self, vertices: ArrayLike, offsets: ArrayLike | None = None, *, reach: float = np.inf
    ) -> PerVertex:
        """Distance from one source, shape (n,), mm.

        Parameters
        ----------
        vertices
            Where the source is: one vertex, or the corners of the triangle that holds it.
        offsets
            Distances from the source to these vertices, mm; 0 by default.
        reach
            Distance up to which the answer matters, mm: beyond it infinite.

        Raises
        ------
        InputError
            If there is no vertex, one is out of range, or an offset is negative or NaN.
        """
        cells = VoronoiCells(self, reach=reach)
        cells.add(vertices, offsets)
        return cells.distances

    def _march(self, vertices: Integers, offsets: Floats, known: PerVertex, reach: float) -> int:
        """Number of vertices that now hold a distance in the front."""
        return _march(self._fans, self._front, (vertices, offsets), (known, reach))


class VoronoiCells:
    """The nearest of a growing number of sources, and its distance, at every vertex.

    A new source is marched only as far as it is nearer than those before it, and an edge or two
    on, so that n vertices and N sources, spread evenly, cost some n·log N visits, not n·N.

    Parameters
    ----------
    marching
        Of the mesh.
    reach
        Distance beyond which a source is of no interest, mm.

    Attributes
    ----------
    distances
        To the nearest source, shape (n,), mm; infinite where no path leads.
    owners
        Number of that source in the order added, shape (n,); -1 where no path leads.
    n_sources
        How many were added.
    n_visits
        How many vertices were measured for all of them together.
    """

    def __init__(self, marching: FastMarching, *, reach: float = np.inf) -> None:
        self._marching = marching
        self._reach = reach
        self.distances: PerVertex = np.full(marching.n_vertices, np.inf)
        self.owners: Integers = np.full(marching.n_vertices, -1)
        self.n_sources = 0
        self.n_visits = 0

    def add(self, vertices: ArrayLike, offsets: ArrayLike | None = None) -> Integers:
        """Add one source, as `FastMarching.from_source` has it; the vertices it is nearest to.

        A vertex as near to an earlier source stays with that.
        """
        corners = np.asarray(vertices, dtype=np.int64).reshape(-1)
        away = np.zeros(len(corners)) if offsets is None else np.asarray(offsets, dtype=np.float64)
        _require_source(corners, away, self._marching.n_vertices)
        front = self._marching._front
        count = self._marching._march(corners, away, self.distances, self._reach)
        touched = front.touched[:count]
        reached = front.distance[touched]
        front.distance[touched] = np.inf
        nearer = (reached < self.distances[touched]) & (reached <= self._reach)
        won = touched[nearer]
        self.distances[won] = reached[nearer]
        self.owners[won] = self.n_sources
        self.n_sources += 1
        self.n_visits += count
        return won


def _require_source(corners: Integers, offsets: Floats, n_vertices: int) -> None:
    if not len(corners) or offsets.shape != corners.shape:
        raise InputError(
            f"{len(corners)} vertices and {offsets.size} offsets of a source: give one or more, "
            "and as many offsets"
        )
    if corners.min() < 0 or corners.max() >= n_vertices:
        raise InputError(
            f"source vertices {corners.min()}…{corners.max()} of {n_vertices}: indices count from 0"
        )
    if not (offsets >= 0).all():
        raise InputError("a source's offset is negative or NaN: give distances in mm")


def _fans(mesh: Mesh) -> _Fans:
    faces: Faces = mesh.faces
    order = np.argsort(faces.ravel(), kind="stable")
    starts = np.zeros(mesh.n_vertices + 1, dtype=np.int64)
    np.cumsum(np.bincount(faces.ravel(), minlength=mesh.n_vertices), out=starts[1:])
    others = np.stack([np.roll(faces, -1, axis=1), np.roll(faces, -2, axis=1)], axis=-1)
    others = others.reshape(-1, 2)[order]
    apex, p, q = mesh.vertices[faces.ravel()[order]], *mesh.vertices[others.T]
    lengths = np.linalg.norm(np.stack([apex - p, apex - q, p - q], axis=1), axis=2)
    return _Fans(read_only(starts, np.int64), read_only(others, np.int64), lengths)


@compiled
def _march(
    fans: _Fans, front: _Front, source: tuple[Integers, Floats], limits: tuple[Floats, float]
) -> int:
    """March from a source; returns how many vertices hold a distance.

    A vertex is left only if its distance is below what is known there. Others are still measured
    where they touch such vertices, since triangles with one corner beyond need all three.
    """
    vertices, offsets = source
    known, reach = limits
    front.counts[:] = 0
    for i in range(len(vertices)):
        _offer(front, vertices[i], offsets[i])
    while front.counts[0] > 0:
        v = _nearest(front)
        here = front.distance[v]
        inside = here < known[v] and here <= reach
        for row in range(fans.starts[v], fans.starts[v + 1]):
            p, q = fans.others[row, 0], fans.others[row, 1]
            vp, vq, pq = fans.lengths[row, 0], fans.lengths[row, 1], fans.lengths[row, 2]
            at_p, at_q = front.distance[p], front.distance[q]
            if inside:
                _offer(front, p, here + vp)
                _offer(front, q, here + vq)
            if inside or (at_q < known[q] and at_q <= reach):
                _offer(front, p, _across(here, at_q, vq, vp, pq))
            if inside or (at_p < known[p] and at_p <= reach):
                _offer(front, q, _across(here, at_p, vp, vq, pq))
    return int(front.counts[1])


@compiled
def _across(at_a: float, at_b: float, ab: float, ac: float, bc: float) -> float:
    """Distance at c by the straight line through side ab from where a and b are right, or inf."""
    if not at_b < np.inf or ab <= 0.0:
        return np.inf
    source_x = (at_a * at_a - at_b * at_b + ab * ab) / (2.0 * ab)
    source_depth = at_a * at_a - source_x * source_x
    if source_depth < 0.0:
        return np.inf
    source_depth = np.sqrt(source_depth)
    x = (ac * ac - bc * bc + ab * ab) / (2.0 * ab)
    height = np.sqrt(max(ac * ac - x * x, 0.0))
    total = source_depth + height
    if total <= 0.0:
        return np.inf
    crossing = source_x + (x - source_x) * source_depth / total
    if crossing < 0.0 or crossing > ab:
        return np.inf
    return float(np.sqrt((x - source_x) * (x - source_x) + total * total))


@compiled
def _offer(front: _Front, vertex: int, distance: float) -> None:
    """Take a distance if it is smaller, and have its vertex taken in (again)."""
    old = front.distance[vertex]
    if not distance < old * (1.0 - _LEAST_GAIN):
        return
    if old == np.inf:
        if not distance < np.inf:
            return
        front.touched[front.counts[1]] = vertex
        front.counts[1] += 1
    front.distance[vertex] = distance
    if front.place[vertex] < 0:
        front.place[vertex] = front.counts[0]
        front.heap[front.counts[0]] = vertex
        front.counts[0] += 1
    _rise(front, front.place[vertex])


@compiled
def _nearest(front: _Front) -> int:
    """Take the nearest vertex off the heap."""
    top = int(front.heap[0])
    front.place[top] = -1
    front.counts[0] -= 1
    if front.counts[0] > 0:
        last = front.heap[front.counts[0]]
        front.heap[0] = last
        front.place[last] = 0
        _sink(front, 0)
    return top


@compiled
def _rise(front: _Front, place: int) -> None:
    vertex = front.heap[place]
    while place > 0:
        parent = (place - 1) // 2
        above = front.heap[parent]
        if front.distance[above] <= front.distance[vertex]:
            break
        front.heap[place] = above
        front.place[above] = place
        place = parent
    front.heap[place] = vertex
    front.place[vertex] = place


@compiled
def _sink(front: _Front, place: int) -> None:
    vertex = front.heap[place]
    size = front.counts[0]
    while 2 * place + 1 < size:
        child = 2 * place + 1
        if child + 1 < size:
            right = front.distance[front.heap[child + 1]]
            child += int(right < front.distance[front.heap[child]])
        below = front.heap[child]
        if front.distance[vertex] <= front.distance[below]:
            break
        front.heap[place] = below
        front.place[below] = place
        place = child
    front.heap[place] = vertex
    front.place[vertex] = place
