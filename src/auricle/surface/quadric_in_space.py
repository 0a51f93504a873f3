"""Quadrics without features: what `auricle.surface.quadric` does, written out for three dimensions.

Most of a simplification's time goes here. Numbers are kept in variables instead of small arrays,
and no step waits for a branch.
"""

import numpy as np

from auricle.arrays import Faces, Floats
from auricle.compiled import compiled_in_place

FARTHEST = 2.0
"""How far from the middle of an edge its collapse may lead, in lengths of the edge."""
SMALLEST_PIVOT = 1e-12
"""Share of a diagonal entry below which elimination leaves nothing but rounding."""
TINY = 1e-300
"""Divisor in place of 0, where the quotient is not used."""


@compiled_in_place
def optimum_in_space(places: Floats, planes: Floats, one: int, other: int, room: Floats) -> float:
    """Do as `optimum` without features, but return -1 where there is no unique optimum nearby."""
    u = places[one, 0] - places[other, 0]
    v = places[one, 1] - places[other, 1]
    w = places[one, 2] - places[other, 2]
    xx, xy, yy = planes[other, 0], planes[other, 1], planes[other, 2]
    xz, yz, zz = planes[other, 3], planes[other, 4], planes[other, 5]
    x, y, z = xx * u + xy * v + xz * w, xy * u + yy * v + yz * w, xz * u + yz * v + zz * w
    p, q, r = planes[other, 6], planes[other, 7], planes[other, 8]
    constant = planes[one, 9] + planes[other, 9]
    constant += u * (2.0 * p + x) + v * (2.0 * q + y) + w * (2.0 * r + z)
    x, y, z = x + p + planes[one, 6], y + q + planes[one, 7], z + r + planes[one, 8]
    xx, xy, yy = xx + planes[one, 0], xy + planes[one, 1], yy + planes[one, 2]
    xz, yz, zz = xz + planes[one, 3], yz + planes[one, 4], zz + planes[one, 5]
    pivot = max(xx, TINY)
    xy_x, xz_x = xy / pivot, xz / pivot
    second, mixed = yy - xy_x * xy, yz - xy_x * xz
    is_regular = (xx > 0.0) & (second > SMALLEST_PIVOT * yy)
    second = max(second, TINY)
    yz_y = mixed / second
    third = zz - xz_x * xz - yz_y * mixed
    is_regular &= third > SMALLEST_PIVOT * zz
    p, q = -x, xy_x * x - y
    r = (-z - xz_x * p - yz_y * q) / max(third, TINY)
    q = q / second - yz_y * r
    p = p / pivot - xy_x * q - xz_x * r
    room[-1, 0] = places[one, 0] + p
    room[-1, 1] = places[one, 1] + q
    room[-1, 2] = places[one, 2] + r
    distance = (p + 0.5 * u) ** 2 + (q + 0.5 * v) ** 2 + (r + 0.5 * w) ** 2
    is_near = distance <= FARTHEST**2 * (u * u + v * v + w * w)
    cost = max(constant + x * p + y * q + z * r, 0.0)
    return float(cost if is_regular & is_near else -1.0)


@compiled_in_place
def move_in_space(
    places: Floats, planes: Floats, points: Floats, vertex: int, room: Floats
) -> None:
    """Express the quadric of a vertex about ``room[-1]``, and put the vertex there."""
    u = room[-1, 0] - places[vertex, 0]
    v = room[-1, 1] - places[vertex, 1]
    w = room[-1, 2] - places[vertex, 2]
    x = planes[vertex, 0] * u + planes[vertex, 1] * v + planes[vertex, 3] * w
    y = planes[vertex, 1] * u + planes[vertex, 2] * v + planes[vertex, 4] * w
    z = planes[vertex, 3] * u + planes[vertex, 4] * v + planes[vertex, 5] * w
    p, q, r = planes[vertex, 6], planes[vertex, 7], planes[vertex, 8]
    constant = planes[vertex, 9] + u * (2.0 * p + x) + v * (2.0 * q + y) + w * (2.0 * r + z)
    planes[vertex, 6], planes[vertex, 7], planes[vertex, 8] = p + x, q + y, r + z
    planes[vertex, 9] = max(constant, 0.0)
    mass = points[vertex, 0]
    p, q, r = points[vertex, 1], points[vertex, 2], points[vertex, 3]
    points[vertex, 4] += u * (mass * u + 2.0 * p) + v * (mass * v + 2.0 * q)
    points[vertex, 4] += w * (mass * w + 2.0 * r)
    points[vertex, 1], points[vertex, 2] = p + mass * u, q + mass * v
    points[vertex, 3] = r + mass * w
    for i in range(3):
        places[vertex, i] = room[-1, i]


@compiled_in_place
def add_faces_in_space(
    places: Floats, planes: Floats, points: Floats, faces: Faces, evenness: float
) -> None:
    """Add to each corner a third of the area times nnᵀ, n the normal; the corner lies on it."""
    for face in range(len(faces)):
        one, two, three = faces[face, 0], faces[face, 1], faces[face, 2]
        x, y, z = places[one, 0], places[one, 1], places[one, 2]
        p, q, r = places[two, 0] - x, places[two, 1] - y, places[two, 2] - z
        u, v, w = places[three, 0] - x, places[three, 1] - y, places[three, 2] - z
        x, y, z = q * w - r * v, r * u - p * w, p * v - q * u
        size = np.sqrt(x * x + y * y + z * z)
        scale = 1.0 / (6.0 * max(size, TINY))  # a third of half the size, by the size squared
        for corner in (one, two, three):
            points[corner, 0] += evenness * size / 6.0
            planes[corner, 0] += scale * x * x
            planes[corner, 1] += scale * x * y
            planes[corner, 2] += scale * y * y
            planes[corner, 3] += scale * x * z
            planes[corner, 4] += scale * y * z
            planes[corner, 5] += scale * z * z
