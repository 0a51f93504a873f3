"""Simple points: a region grown voxel by voxel that never closes a ring or a bubble.

A voxel is simple if adding it changes neither the number of pieces, nor of handles, nor of
cavities. A region grown from one voxel by simple points only is a ball in the sense of topology.
"""

from heapq import heappop, heappush

import numpy as np
from numpy.typing import NDArray

from auricle.arrays import Integers, Truths
from auricle.compiled import compiled

_CUBE = np.array([(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)])
_STEPS = np.abs(_CUBE[:, None] - _CUBE[None]).sum(axis=2) == 1
"""Which two cells of the 3×3×3 block share a face, shape (27, 27)."""
_TOUCH = np.abs(_CUBE[:, None] - _CUBE[None]).max(axis=2) == 1
"""Which two share a face, an edge or a corner."""
_DOMAINS = np.array(
    [np.abs(_CUBE).sum(axis=1) == 1, np.isin(np.abs(_CUBE).sum(axis=1), (1, 2)), _CUBE.any(axis=1)]
)
"""The cells beside the middle by a face; by a face or an edge; all but the middle, (3, 27)."""


def ball_like(region: Truths, depth: NDArray[np.floating]) -> Truths:
    """The region without the voxels that close its handles and cavities, grown from the deepest.

    Deep voxels come first, so that a handle is opened where it is thinnest. The region is joined
    by faces, what lies outside by faces, edges or corners (Bertrand and Malandain 1994).

    Parameters
    ----------
    region
        Shape (nx, ny, nz).
    depth
        Distance to the region's edge, same shape.

    Examples
    --------
    >>> ring = np.zeros((5, 5, 3), bool)
    >>> ring[1:4, 1:4, 1] = True; ring[2, 2, 1] = False
    >>> int(ring.sum() - ball_like(ring, ring.astype(float)).sum())
    1
    """
    padded = np.pad(region, 1)
    depths = np.pad(np.asarray(depth, dtype=np.float64), 1)
    offsets = _CUBE @ (np.array(padded.strides) // padded.itemsize)
    start = int(np.argmax(np.where(padded, depths, -np.inf)))
    grown = _grown(padded.ravel(), depths.ravel(), start, offsets, (_STEPS, _TOUCH, _DOMAINS))
    return grown.reshape(padded.shape)[1:-1, 1:-1, 1:-1].copy()


@compiled
def _pieces_beside(inside: Truths, joined: Truths, domain: Truths, faces: Truths) -> int:
    """How many pieces of the cells in `domain` and `inside` hold a cell of `faces`."""
    seen = np.zeros(27, dtype=np.bool_)
    stack = np.empty(27, dtype=np.int64)
    pieces = 0
    for start in range(27):
        if seen[start] or not (inside[start] and domain[start] and faces[start]):
            continue
        pieces += 1
        top = 1
        stack[0] = start
        seen[start] = True
        while top > 0:
            top -= 1
            cell = stack[top]
            for other in range(27):
                if joined[cell, other] and domain[other] and inside[other] and not seen[other]:
                    seen[other] = True
                    stack[top] = other
                    top += 1
    return pieces


@compiled
def _grown(
    region: Truths,
    depths: NDArray[np.float64],
    start: int,
    offsets: Integers,
    tables: tuple[Truths, Truths, Truths],
) -> Truths:
    grown = np.zeros(len(region), dtype=np.bool_)
    queued = np.zeros(len(region), dtype=np.bool_)
    steps, touch, domains = tables
    beside, near, around = domains[0], domains[1], domains[2]
    inside = np.empty(27, dtype=np.bool_)
    grown[start] = True
    heap = [(-depths[start], start)]
    while len(heap) > 0:
        voxel = heappop(heap)[1]
        queued[voxel] = False
        for cell in range(27):
            inside[cell] = grown[voxel + offsets[cell]]
        if voxel != start and (
            _pieces_beside(inside, steps, near, beside) != 1
            or _pieces_beside(~inside, touch, around, around) != 1
        ):
            continue
        grown[voxel] = True
        for offset in offsets:
            other = voxel + offset
            if region[other] and not grown[other] and not queued[other]:
                heappush(heap, (-depths[other], other))
                queued[other] = True
    return grown
