"""The mitral valve: the plane that parts the left atrium from the ventricle."""

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from auricle.arrays import Floats, Points, Truths
from auricle.imaging.chambers import ATRIUM, VENTRICLE
from auricle.imaging.growing import pieces_by_size

LEAST_FACES = 30
"""Voxel faces between the chambers below which no plane is fitted."""
_TRIMMING_ROUNDS = 3
_TRIMMED = 2.5
_RIM_MM = 3.0
_DEPTH_MM = 30.0
"""How far beyond the plane voxels go to the ventricle, mm: an open leaflet's length and more."""
_BEFORE_MM = 2.5
"""How far before it they go to the atrium, mm: more would fill the outflow tract."""
_SECTORS = 16
_HINGE_ASIDE_MM = (4.0, 24.0)
_HINGE_MM = 30.0
_COPLANAR_MM = 2.0
_LEAST_COSINE = 0.64
_LEAST_SECTORS = 7
_UNSEEN_MM = 3.0
"""Before the hinge the gap between leaflet and wall is too narrow to be seen, mm."""


@dataclass(frozen=True, eq=False)
class MitralPlane:
    """A disc across the mitral orifice.

    Attributes
    ----------
    centre
        Shape (3,), mm.
    normal
        Unit vector from the atrium to the ventricle, shape (3,).
    radius
        Within which the plane cuts, mm.
    deviation
        Root mean square distance of the watershed's interface from the plane, mm.
    """

    centre: Points
    normal: Floats
    radius: float
    deviation: float


def mitral_plane(labels: NDArray[np.integer], *, step: float) -> MitralPlane | None:
    """The plane nearest to the interface of atrium and ventricle; None if they hardly touch.

    A watershed's face is ragged where the distance to the wall is flat, so a plane is fitted to
    it by least squares, stragglers left out. Its radius is limited: beyond the orifice it would
    reach into the outflow tract.

    Parameters
    ----------
    labels
        As `Chambers.labels`.
    step
        Spacing, mm; positions are index times step.
    """
    places, across = _interface(labels, step)
    if len(places) < LEAST_FACES:
        return None
    kept = np.ones(len(places), dtype=bool)
    for _ in range(_TRIMMING_ROUNDS):
        centre = places[kept].mean(axis=0)
        normal = np.linalg.svd(places[kept] - centre, full_matrices=False)[2][2]
        height = (places - centre) @ normal
        deviation = float(np.sqrt(np.mean(height[kept] ** 2)))
        kept = np.abs(height) <= max(_TRIMMED * deviation, step)
    normal = normal * np.sign(across.sum(axis=0) @ normal or 1.0)
    aside = np.linalg.norm((places - centre)[kept] - np.outer(height[kept], normal), axis=1)
    return MitralPlane(centre, normal, float(np.percentile(aside, 98)) + _RIM_MM, deviation)


def hinge_plane(
    labels: NDArray[np.integer], orifice: MitralPlane, *, middle: Points, step: float
) -> MitralPlane:
    """The plane through the leaflets' hinges: the annulus, where the orifice is between their tips.

    Behind an open leaflet there is blood of the ventricle nearly up to its hinge. In each sector
    around the axis the ventricle's voxel furthest toward the atrium marks it, and the plane on
    which most of these lie is taken (all triples tried); the outflow tract, which reaches higher,
    is left out by that. The orifice itself comes back where too few sectors agree.

    Parameters
    ----------
    labels
        As `Chambers.labels`.
    orifice
        From `mitral_plane`; of it only the place counts, for its tilt is a small opening's.
    middle
        Of the atrium, shape (3,), mm; the axis runs from there to the orifice.
    step
        Spacing, mm; positions are index times step.
    """
    axis = (orifice.centre - middle) / np.linalg.norm(orifice.centre - middle)
    plane = replace(orifice, normal=axis)
    for _ in range(2):
        hinges = _hinges(labels, plane, step)
        if len(hinges) < _LEAST_SECTORS:
            return orifice
        agreeing, normal = _most_coplanar(hinges, axis)
        if agreeing.sum() < _LEAST_SECTORS:
            return orifice
        centre = hinges[agreeing].mean(axis=0)
        height = (hinges[agreeing] - centre) @ normal
        aside = np.linalg.norm(hinges[agreeing] - centre - np.outer(height, normal), axis=1)
        radius = float(np.percentile(aside, 75)) + _RIM_MM
        plane = MitralPlane(centre, normal, radius, float(np.sqrt(np.mean(height**2))))
    return replace(plane, centre=plane.centre - _UNSEEN_MM * plane.normal)


def _hinges(labels: NDArray[np.integer], plane: MitralPlane, step: float) -> Points:
    """In each sector around the axis, the ventricle's voxel furthest before the plane, mm."""
    place, height, aside, angle = _around(labels.shape, plane, step)
    behind = (labels[place] == VENTRICLE) & (np.abs(height) <= _HINGE_MM)
    behind &= (aside >= _HINGE_ASIDE_MM[0]) & (aside <= _HINGE_ASIDE_MM[1])
    sector = ((angle[behind] + np.pi) / (2 * np.pi) * _SECTORS).astype(int) % _SECTORS
    index = np.argwhere(behind) + [part.start for part in place]
    order = np.lexsort((height[behind], sector))
    _, first = np.unique(sector[order], return_index=True)
    furthest: Points = index[order[first]] * step
    return furthest


def _most_coplanar(points: Points, toward: Floats) -> tuple[Truths, Floats]:
    """Which points lie on the plane that most of them lie on, and its normal along `toward`.

    Planes turned from `toward` by more than 50° do not count.
    """
    triples = np.array(list(combinations(range(len(points)), 3)))
    one, two, three = (points[triples[:, corner]] for corner in range(3))
    normals = np.cross(two - one, three - one)
    lengths = np.linalg.norm(normals, axis=1)
    normals = normals / np.maximum(lengths, 1e-9)[:, None]
    normals *= np.sign(normals @ toward)[:, None]
    heights = np.abs((points[None] - one[:, None]) @ normals[:, :, None])[:, :, 0]
    counts = (heights <= _COPLANAR_MM).sum(axis=1)
    counts[(lengths < 1.0) | (normals @ toward < _LEAST_COSINE)] = 0
    agreeing: Truths = heights[int(np.argmax(counts))] <= _COPLANAR_MM
    centre = points[agreeing].mean(axis=0)
    normal = np.linalg.svd(points[agreeing] - centre)[2][2]
    return agreeing, normal * np.sign(normal @ toward)


def cut_at_mitral(labels: NDArray[np.int8], plane: MitralPlane, *, step: float) -> NDArray[np.int8]:
    """Labels with the voxels near the plane given to the chamber on whose side they lie.

    What lies beyond the plane but does not touch the ventricle (the appendage beside it) stays.
    Pieces of the atrium that this leaves without a way to its largest part go to the ventricle.
    """
    place, beyond, before = _near(labels.shape, plane, step)
    block = labels[place].copy()
    block[_joined_to(block == VENTRICLE, beyond & (block == ATRIUM))] = VENTRICLE
    block[before & (block == VENTRICLE)] = ATRIUM
    cut = labels.copy()
    cut[place] = block
    pieces, _ = pieces_by_size(cut == ATRIUM)
    cut[(pieces > 1) & (cut == ATRIUM)] = VENTRICLE
    return cut


def _near(
    shape: tuple[int, ...], plane: MitralPlane, step: float
) -> tuple[tuple[slice, ...], Truths, Truths]:
    """A block around the disc, and its voxels shortly beyond the plane and before it."""
    place, height, aside, _ = _around(shape, plane, step)
    within = aside <= plane.radius
    beyond = within & (height > 0) & (height <= _DEPTH_MM)
    return place, beyond, within & (height <= 0) & (height >= -_BEFORE_MM)


def _around(
    shape: tuple[int, ...], plane: MitralPlane, step: float
) -> tuple[tuple[slice, ...], Floats, Floats, Floats]:
    """A block around the disc, and its voxels' height over it, distance to its axis and angle."""
    reach = max(plane.radius, _HINGE_ASIDE_MM[1]) + _DEPTH_MM
    low = np.clip(np.floor((plane.centre - reach) / step).astype(int), 0, shape)
    high = np.clip(np.ceil((plane.centre + reach) / step).astype(int) + 1, 0, shape)
    place = tuple(slice(a, b) for a, b in zip(low.tolist(), high.tolist(), strict=True))
    offset = np.moveaxis(np.mgrid[place], 0, -1) * step - plane.centre
    axes = np.linalg.svd(plane.normal[None])[2]
    u, v, height = offset @ axes[1], offset @ axes[2], offset @ plane.normal
    return place, height, np.hypot(u, v), np.arctan2(v, u)


def _joined_to(goal: Truths, region: Truths) -> Truths:
    """The pieces of `region` that touch `goal`."""
    pieces, _ = pieces_by_size(region)
    touching = np.unique(pieces[binary_dilation(goal)])
    joined: Truths = np.isin(pieces, touching[touching > 0])
    return joined


def _interface(labels: NDArray[np.integer], step: float) -> tuple[Points, Floats]:
    """Middles of the faces between the chambers, mm, and their normals to the ventricle."""
    places, normals = [], []
    for axis in range(3):
        lower = np.moveaxis(labels, axis, 0)[:-1]
        upper = np.moveaxis(labels, axis, 0)[1:]
        for first, second, sign in ((ATRIUM, VENTRICLE, 1.0), (VENTRICLE, ATRIUM, -1.0)):
            index = np.argwhere((lower == first) & (upper == second)).astype(float)
            index[:, 0] += 0.5
            places.append(np.insert(index[:, 1:], axis, index[:, 0], axis=1))
            normals.append(np.tile(sign * np.eye(3)[axis], (len(index), 1)))
    return np.concatenate(places) * step, np.concatenate(normals)
