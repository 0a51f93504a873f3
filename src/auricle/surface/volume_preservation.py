"""Volume preservation: where to collapse an edge to so that the surface encloses as much as before.

Of all vertices that keep the enclosed volume, a plane full (Lindstrom and Turk, *Fast and memory
efficient polygonal simplification*, Visualization 1998, section 4.2.1), the one nearest to the
quadrics' optimum is taken. The optimum by itself leaves the triangles inside a convex surface,
and the volume shrinks step by step.
"""

from auricle.arrays import Floats
from auricle.compiled import compiled_in_place
from auricle.surface.halfedges import Indices

FARTHEST = 0.5
"""How far the optimum may be moved, in lengths of the edge."""


@compiled_in_place
def preserve_volume(
    places: Floats,
    near_one: Indices,
    near_other: Indices,
    sizes: tuple[int, int, int, int],
    room: Floats,
) -> None:
    """Move the place in ``room[-1]`` so that collapsing an edge to it leaves the volume as it is.

    The faces around both ends span, with a vertex x about the first end, six times the volume
    g·x. That is to be what the faces of the second end span with that end itself.

    Parameters
    ----------
    places
        Vertices, positions first.
    near_one, near_other
        Neighbours of the two ends in turn, the first one again at the end.
    sizes
        The two ends, and how many faces each has.
    room
        Workspace whose last row is the place; it stays where it is if it would move too far.
    """
    one, other, n_one, n_other = sizes
    x = places[other, 0] - places[one, 0]
    y = places[other, 1] - places[one, 1]
    z = places[other, 2] - places[one, 2]
    p, q, r = _facing(places, one, near_one, n_one, other)
    u, v, w = _facing(places, one, near_other, n_other, one)
    missing = u * x + v * y + w * z
    p, q, r = p + u, q + v, r + w
    missing -= p * (room[-1, 0] - places[one, 0])
    missing -= q * (room[-1, 1] - places[one, 1])
    missing -= r * (room[-1, 2] - places[one, 2])
    squared = p * p + q * q + r * r
    if missing * missing < FARTHEST**2 * (x * x + y * y + z * z) * squared:
        room[-1, 0] += p * missing / squared
        room[-1, 1] += q * missing / squared
        room[-1, 2] += r * missing / squared


@compiled_in_place
def _facing(
    places: Floats, origin: int, ring: Indices, n_faces: int, partner: int
) -> tuple[float, float, float]:
    """Sum of the cross products of neighbours about an origin, over faces without the partner."""
    x, y, z = 0.0, 0.0, 0.0
    for i in range(n_faces):
        second, third = ring[i], ring[i + 1]
        if second != partner and third != partner:
            p = places[second, 0] - places[origin, 0]
            q = places[second, 1] - places[origin, 1]
            r = places[second, 2] - places[origin, 2]
            u = places[third, 0] - places[origin, 0]
            v = places[third, 1] - places[origin, 1]
            w = places[third, 2] - places[origin, 2]
            x, y, z = x + q * w - r * v, y + r * u - p * w, z + p * v - q * u
    return x, y, z
