"""Safety of a collapse: whether the surface stays what it is.

The link condition keeps pieces, holes and handles (Dey, Edelsbrunner, Guha and Nekhayev, *Topology
preserving edge contraction*, 1999); no face around may turn far, nor become a sliver.
"""

from typing import NamedTuple

import numpy as np

from auricle.arrays import Floats
from auricle.compiled import compiled_in_place
from auricle.surface.halfedges import Indices
from auricle.surface.volume_preservation import preserve_volume

LIMITS = ((0.2, 0.1), (-1.0, 0.1), (-1.0, 0.0))
"""By laxity: cosine of the angle by which a face may turn in one collapse, 78° or any, and the
quality 4√3·area / Σ edge² below which no face may come that was better."""

FINE, THIN, TURNED = 2, 1, 0
TWICE_ROOT_3 = 2.0 * 3.0**0.5


class Rings(NamedTuple):
    """An edge's ends, how many faces each has, and their neighbours as `neighbours` has them."""

    one: int
    other: int
    size: int
    other_size: int
    ring: Indices
    other_ring: Indices


@compiled_in_place
def is_safe(places: Floats, rings: Rings, room: Floats, is_inside: bool, laxity: int) -> bool:
    """Whether the surface stays what it is if an edge collapses to ``room[-1]``.

    Inside the surface that place is first moved so that the volume stays the same too.

    Parameters
    ----------
    places
        Vertices, positions first.
    rings
        The edge and what is around it.
    room
        Workspace whose last row is the place.
    is_inside
        Whether the edge has two faces.
    laxity
        Which of `LIMITS` counts.
    """
    one, other, size, other_size, ring, other_ring = rings
    one_inside, other_inside = ring[0] == ring[size], other_ring[0] == other_ring[other_size]
    if not _keeps_topology(rings, is_inside, one_inside, other_inside):
        return False
    if one_inside and other_inside:
        preserve_volume(places, ring, other_ring, (one, other, size, other_size), room)
    worst = _after(places, (one, other), ring, size, room, laxity)
    if worst != TURNED:
        worst = min(worst, _after(places, (other, one), other_ring, other_size, room, laxity))
    if worst != THIN:
        return worst == FINE
    before = min(_worst(places, one, ring, size), _worst(places, other, other_ring, other_size))
    after = min(
        _worst_after(places, (one, other), ring, size, room),
        _worst_after(places, (other, one), other_ring, other_size, room),
    )
    return after >= before


@compiled_in_place
def _keeps_topology(rings: Rings, is_inside: bool, one_inside: bool, other_inside: bool) -> bool:
    """Whether the ends share no neighbours but the corners opposite their edge.

    An edge inside may not join two boundary vertices, and a tetrahedron or a lone triangle stays.
    """
    _, _, size, other_size, ring, other_ring = rings
    n_one, n_other = size + (not one_inside), other_size + (not other_inside)
    n_shared = 0
    for i in range(n_one):
        for j in range(n_other):
            n_shared += ring[i] == other_ring[j]
    is_chord = is_inside and not (one_inside or other_inside)
    n_least = 3 if is_inside else 2
    is_least = n_one == n_least and n_other == n_least
    return n_shared == 1 + is_inside and not is_chord and not is_least


@compiled_in_place
def _after(
    places: Floats, ends: tuple[int, int], ring: Indices, size: int, room: Floats, laxity: int
) -> int:
    """Judge the faces around the first end that stay when it moves to ``room[-1]``.

    Turned if one of them turns too far; a sliver has no normal to speak of and may turn.
    """
    vertex, partner = ends
    cosine, quality = LIMITS[laxity]
    worst = FINE
    for i in range(size):
        second, third = ring[i], ring[i + 1]
        if second == partner or third == partner:
            continue
        u, v, w = _side(places, second, third)
        x, y, z = _side(places, vertex, second)
        a, b, c, before, spread = _shape(x, y, z, u, v, w)
        x = places[second, 0] - room[-1, 0]
        y = places[second, 1] - room[-1, 1]
        z = places[second, 2] - room[-1, 2]
        p, q, r, after, new_spread = _shape(x, y, z, u, v, w)
        aligned = a * p + b * q + c * r
        is_far = aligned < 0.0 or aligned * aligned < cosine * cosine * before * after
        if is_far and cosine >= 0.0 and _quality(before, spread) >= quality:
            return TURNED
        if 12.0 * after < (quality * new_spread) ** 2 or (new_spread == 0.0 and quality > 0.0):
            worst = THIN
    return worst


@compiled_in_place
def _worst_after(
    places: Floats, ends: tuple[int, int], ring: Indices, size: int, room: Floats
) -> float:
    """Least quality of the faces around the first end that stay when it moves to ``room[-1]``."""
    _, partner = ends
    least = 1.0
    for i in range(size):
        second, third = ring[i], ring[i + 1]
        if second != partner and third != partner:
            u, v, w = _side(places, second, third)
            x = places[second, 0] - room[-1, 0]
            y = places[second, 1] - room[-1, 1]
            z = places[second, 2] - room[-1, 2]
            _, _, _, squared, spread = _shape(x, y, z, u, v, w)
            least = min(least, _quality(squared, spread))
    return least


@compiled_in_place
def _worst(places: Floats, vertex: int, ring: Indices, size: int) -> float:
    """Least quality of the faces around a vertex."""
    least = 1.0
    for i in range(size):
        u, v, w = _side(places, ring[i], ring[i + 1])
        x, y, z = _side(places, vertex, ring[i])
        _, _, _, squared, spread = _shape(x, y, z, u, v, w)
        least = min(least, _quality(squared, spread))
    return least


@compiled_in_place
def _side(places: Floats, one: int, other: int) -> tuple[float, float, float]:
    x, y, z = places[other, 0], places[other, 1], places[other, 2]
    return x - places[one, 0], y - places[one, 1], z - places[one, 2]


@compiled_in_place
def _shape(
    x: float, y: float, z: float, u: float, v: float, w: float
) -> tuple[float, float, float, float, float]:
    """Cross product of two sides in turn, its squared length, and all sides' squared lengths."""
    a, b, c = y * w - z * v, z * u - x * w, x * v - y * u
    third = (x + u) ** 2 + (y + v) ** 2 + (z + w) ** 2
    spread = x * x + y * y + z * z + u * u + v * v + w * w + third
    return a, b, c, a * a + b * b + c * c, spread


@compiled_in_place
def _quality(squared: float, spread: float) -> float:
    """Quality of a triangle of such a cross product and such sides."""
    return float(TWICE_ROOT_3 * np.sqrt(squared) / spread) if spread > 0.0 else 0.0
