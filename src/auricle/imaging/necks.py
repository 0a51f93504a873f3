"""Necks: a region parted into its chambers where it is narrowest.

The distance to the wall has a peak in every chamber and a pass in every opening between two: the
radius of the opening. A watershed of the distance finds both; chambers that a wide neck joins are
lobes of one, and what is left is given to the chamber it opens into most widely.
"""

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from auricle.arrays import Floats, Integers, Truths
from auricle.compiled import compiled
from auricle.errors import ImageError


@dataclass(frozen=True, eq=False)
class Basins:
    """The parts of a region around each peak of the distance to its wall.

    Attributes
    ----------
    labels
        Shape (nx, ny, nz): 0 outside, basin b marked b + 1.
    peaks
        Radius of the largest ball inside each basin, shape (b,), mm.
    centres
        Index of that ball's centre, shape (b, 3).
    n_voxels
        Size of each basin, shape (b,).
    pairs
        Basins that touch, shape (p, 2), the smaller first.
    necks
        Radius of the opening between them, shape (p,), mm.
    """

    labels: NDArray[np.int32]
    peaks: Floats
    centres: Integers
    n_voxels: Integers
    pairs: Integers
    necks: Floats


def wall_distance(region: Truths, *, step: float) -> NDArray[np.float32]:
    """Distance of each voxel inside to the face of the nearest outside, about, mm; 0 outside.

    What lies beyond the lattice counts as outside. Half a step is taken off the distance
    between the voxels' centres.
    """
    distance = distance_transform_edt(np.pad(region, 1), sampling=step)[1:-1, 1:-1, 1:-1]
    inside: NDArray[np.float32] = np.where(region, distance - 0.5 * step, 0.0).astype(np.float32)
    return inside


def distance_basins(region: Truths, *, step: float, depth: float = 0.5) -> Basins:
    """The basins of a region, by watershed of the distance to its wall.

    Voxels are visited from the deepest inward-lying to the wall (Vincent and Soille 1991); each
    joins the basin of its deepest neighbour, and where basins meet the shallow ones are merged,
    so that what remains is as prominent as asked.

    Parameters
    ----------
    region
        Shape (nx, ny, nz).
    step
        Spacing of the lattice, mm.
    depth
        Peaks less than this above the pass to a higher one are no peaks of their own, mm.

    Raises
    ------
    ImageError
        If the region is empty.

    Examples
    --------
    >>> x, y, z = np.indices((45, 25, 25))
    >>> balls = [(x - c) ** 2 + (y - 12) ** 2 + (z - 12) ** 2 < 11**2 for c in (12, 32)]
    >>> found = distance_basins(balls[0] | balls[1], step=1.0)
    >>> found.peaks.round().tolist(), found.necks.round().tolist()
    ([10.0, 10.0], [4.0])
    """
    if not region.any():
        raise ImageError("the region is empty: lower the threshold or move the seed")
    distance = wall_distance(region, step=step)
    padded = np.pad(distance, 1)
    depths = padded.ravel()
    inside = np.flatnonzero(depths)
    order = inside[np.argsort(-depths[inside], kind="stable")]
    offsets = np.array(padded.strides) // padded.itemsize
    marks, parent = _flooded(order, depths, np.concatenate([offsets, -offsets]), depth)
    basin = parent[marks[inside]]
    labels = np.zeros(padded.size, dtype=np.int32)
    labels[inside] = np.unique(basin, return_inverse=True)[1] + 1
    return _measured(labels.reshape(padded.shape)[1:-1, 1:-1, 1:-1].copy(), distance)


@compiled
def _root(parent: Integers, mark: int) -> int:
    """The basin a mark has ended up in so far."""
    while parent[mark] != mark:
        parent[mark] = parent[parent[mark]]
        mark = parent[mark]
    return mark


@compiled
def _deepest(voxel: int, marks: Integers, depths: NDArray[np.float32], offsets: Integers) -> int:
    """The deepest marked neighbour; −1 if none is marked."""
    deepest = -1
    for offset in offsets:
        beside = voxel + offset
        if marks[beside] >= 0 and (deepest < 0 or depths[beside] > depths[deepest]):
            deepest = beside
    return deepest


@compiled
def _flooded(
    order: Integers, depths: NDArray[np.float32], offsets: Integers, prominence: float
) -> tuple[Integers, Integers]:
    """A mark for each voxel visited (−1 elsewhere), and the basin each mark ended up in."""
    marks = np.full(len(depths), -1, dtype=np.int64)
    parent = np.empty(len(order), dtype=np.int64)
    peaks = np.empty(len(order), dtype=np.float64)
    n_marks = 0
    for voxel in order:
        deepest = _deepest(voxel, marks, depths, offsets)
        if deepest < 0:
            marks[voxel] = parent[n_marks] = n_marks
            peaks[n_marks] = depths[voxel]
            n_marks += 1
            continue
        marks[voxel] = marks[deepest]
        home = _root(parent, marks[deepest])
        for offset in offsets:
            if marks[voxel + offset] < 0:
                continue
            other = _root(parent, marks[voxel + offset])
            high, low = (other, home) if peaks[other] > peaks[home] else (home, other)
            if high != low and peaks[low] - depths[voxel] < prominence:
                parent[low] = high
                home = high
    for mark in range(n_marks):
        parent[mark] = _root(parent, mark)
    return marks, parent[:n_marks]


def owners(basins: Basins, chambers: Collection[int]) -> Integers:
    """The chamber each basin opens into most widely, shape (b,); −1 where there is no way.

    Necks are opened from the widest down (Kruskal's maximum spanning tree); two trees that both
    hold a chamber are not joined.

    Examples
    --------
    >>> row = Basins(labels=np.zeros((1, 1, 1), np.int32), peaks=np.array([9.0, 3.0, 8.0]),
    ...              centres=np.zeros((3, 3), int), n_voxels=np.ones(3, int),
    ...              pairs=np.array([[0, 1], [1, 2]]), necks=np.array([1.5, 2.5]))
    >>> owners(row, [0, 2]).tolist()
    [0, 2, 2]
    """
    parent = list(range(len(basins.peaks)))
    owner = {chamber: chamber for chamber in chambers}

    def root(basin: int) -> int:
        while parent[basin] != basin:
            parent[basin] = parent[parent[basin]]
            basin = parent[basin]
        return basin

    for row in np.argsort(-basins.necks, kind="stable"):
        one, other = (root(int(basin)) for basin in basins.pairs[row])
        if one == other or (one in owner and other in owner):
            continue
        parent[other] = one
        if other in owner:
            owner[one] = owner.pop(other)
    return np.array([owner.get(root(b), -1) for b in range(len(parent))], dtype=np.int64)


def widest_ways(basins: Basins, home: int) -> tuple[Floats, Integers]:
    """The widest way from `home` to each basin.

    Returns
    -------
    width
        Radius of the narrowest neck on it, shape (b,), mm; 0 where there is no way.
    limb
        The first basin on it, shape (b,), which is a neighbour of `home`; −1 where there is none.
    """
    width = np.zeros(len(basins.peaks))
    width[home] = basins.peaks[home]
    limb = np.full(len(width), -1, dtype=np.int64)
    reached = np.zeros(len(width), dtype=bool)
    for _ in range(len(width)):
        basin = int(np.argmax(np.where(reached, -1.0, width)))
        reached[basin] = True
        for side in (0, 1):
            rows = basins.pairs[:, side] == basin
            others, through = basins.pairs[rows, 1 - side], basins.necks[rows]
            wider = np.minimum(width[basin], through) > width[others]
            limb[others[wider]] = others[wider] if basin == home else limb[basin]
            np.maximum.at(width, others, np.minimum(width[basin], through))
    return width, limb


def _measured(labels: NDArray[np.int32], distance: NDArray[np.float32]) -> Basins:
    inside = np.flatnonzero(labels)
    basin = labels.ravel()[inside] - 1
    depth = distance.ravel()[inside]
    n_basins = int(basin.max()) + 1
    order = np.lexsort((-depth, basin))
    first = np.searchsorted(basin[order], np.arange(n_basins))
    summit = inside[order[first]]
    centres = np.stack(np.unravel_index(summit, labels.shape), axis=1)
    pairs, necks = _necks(labels, distance)
    return Basins(
        labels,
        distance.ravel()[summit].astype(np.float64),
        centres.astype(np.int64),
        np.bincount(basin, minlength=n_basins),
        pairs,
        necks,
    )


def _necks(labels: NDArray[np.int32], distance: NDArray[np.float32]) -> tuple[Integers, Floats]:
    """Touching basins, and the largest distance to the wall on the face between them."""
    n_basins = int(labels.max())
    keys, radii = [], []
    for axis in range(3):
        lower = np.moveaxis(labels, axis, 0)[:-1], np.moveaxis(distance, axis, 0)[:-1]
        upper = np.moveaxis(labels, axis, 0)[1:], np.moveaxis(distance, axis, 0)[1:]
        meet = (lower[0] != upper[0]) & (lower[0] > 0) & (upper[0] > 0)
        one, other = lower[0][meet] - 1, upper[0][meet] - 1
        keys.append(np.minimum(one, other).astype(np.int64) * n_basins + np.maximum(one, other))
        radii.append(np.minimum(lower[1][meet], upper[1][meet]))
    key, place = np.unique(np.concatenate(keys), return_inverse=True)
    widest = np.zeros(len(key))
    np.maximum.at(widest, place, np.concatenate(radii))
    return np.stack(np.divmod(key, n_basins), axis=1).reshape(-1, 2), widest
