"""Pulmonary veins and the appendage: what leaves the atrium's body, and where veins are cut.

The convention: the body is the union of all balls of two thirds of the atrium's largest radius
that fit into the chamber (a morphological opening); an ostium is where a branch leaves it; a vein
is kept for a stated length from its ostium, measured inside the blood; the appendage, which is a
dead end to the left and the front, is kept whole. A leak into another structure is cut at the
body; what is too short for a vein and touches a leak or another chamber, the neck to that or a part
of it where contrast is unevenly mixed, is cut 3 mm from the body.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, distance_transform_edt
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra

from auricle.arrays import Integers, Points, Truths
from auricle.imaging.chambers import OTHER, VENTRICLE
from auricle.imaging.growing import pieces_by_size
from auricle.imaging.necks import wall_distance

BODY_SHARE = 0.65
"""Radius of the opening over the atrium's largest radius."""
OPENING_RANGE = (5.0, 15.0)
"""mm."""
LEAST_LENGTH_MM = 13.0
"""What sticks out less is the body's own shape, or a stub cut by someone before."""
SHELL_MM = (8.0, 10.0)
"""Distance from the body at which branches are told apart and counted, mm."""
LEAST_RADIUS_MM = 1.5
"""A thinner branch is no vein but a coronary artery, or noise."""
TOUCHING_MM = 3.0
"""Nearer to the body than this, a branch is the body's own skin, which others may touch, mm."""
LEAK_ML = 40.0
"""A branch that holds more is no vein but another structure."""
APPENDAGE_ML = (1.0, 30.0)
APPENDAGE_MM = (15.0, 60.0)
_LEFT = 0.2
_FRONT = 0.1


@dataclass(frozen=True, eq=False)
class Branch:
    """A vein, the appendage, or a way into another structure.

    Attributes
    ----------
    kind
        ``vein``, ``appendage`` or ``leak``; a leak is cut where it leaves the body.
    ostium
        Middle of its cross-section 8 to 10 mm from the body, shape (3,), mm.
    radius
        Of a disc as large as that, mm.
    length
        From the body to the far end, before cutting, mm.
    volume_ml
        Before cutting.
    """

    kind: str
    ostium: Points
    radius: float
    length: float
    volume_ml: float


@dataclass(frozen=True, eq=False)
class Trimmed:
    """An atrium whose veins are cut.

    Attributes
    ----------
    atrium
        Body, appendage and vein stubs, shape of the lattice.
    beyond
        The veins cut off.
    branches
        Appendage first, then veins, the largest first.
    """

    atrium: Truths
    beyond: Truths
    branches: tuple[Branch, ...]


def trim_veins(
    atrium: Truths,
    labels: NDArray[np.integer],
    *,
    radius: float,
    step: float,
    stub: float = 12.0,
    oriented: bool = True,
) -> Trimmed:
    """Cut the veins `stub` mm from their ostia and keep the appendage.

    Parameters
    ----------
    atrium
        Shape of the lattice (axes left, back, head).
    labels
        Territories as `Chambers.labels`, same shape: the mitral cut counts as no wall, and what is
        short and touches another structure is the neck to that.
    radius
        Of the largest ball in the atrium, mm.
    step
        Spacing, mm; positions are index times step.
    stub
        Length of vein kept, mm.
    oriented
        Whether the lattice's axes are known; if not, no branch is taken for the appendage.
    """
    opening = float(np.clip(BODY_SHARE * radius, *OPENING_RANGE))
    body = _body(atrium, labels == VENTRICLE, opening, step)
    ways, marks = _ways_and_branches(body, atrium & ~body, step)
    middle = np.argwhere(body).mean(axis=0) * step
    found = [_branch(marks == mark, ways, step) for mark in range(1, int(marks.max()) + 1)]
    chosen = _appendage(found, middle) if oriented else -1
    beyond = atrium & ~body & (ways > stub)
    necks = _necks(found, marks, ways, labels == OTHER)
    for number, branch in enumerate(found):
        if branch.kind == "leak":
            beyond |= marks == number + 1
        elif number in necks:
            beyond |= (marks == number + 1) & (ways > TOUCHING_MM)
        elif number == chosen:
            found[number] = replace(branch, kind="appendage")
            beyond &= marks != number + 1
    ranked = sorted(found, key=lambda branch: (branch.kind != "appendage", -branch.volume_ml))
    branches = tuple(branch for branch in ranked if branch.length >= LEAST_LENGTH_MM)
    return Trimmed(atrium & ~beyond, beyond, branches)


def _body(atrium: Truths, ventricle: Truths, radius: float, step: float) -> Truths:
    """The opening of the atrium by a ball, of which only the largest part counts."""
    core = atrium & (wall_distance(atrium | ventricle, step=step) >= radius)
    marks, sizes = pieces_by_size(core)
    if not len(sizes):
        return atrium
    away: Truths = distance_transform_edt(marks != 1, sampling=step) <= radius
    return atrium & away


def _ways_and_branches(
    body: Truths, outside: Truths, step: float
) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """Distance of each voxel from the body inside the blood, mm, and the branch it belongs to.

    A branch is a piece of the shell some way from the body; each voxel belongs to the branch
    nearest to it inside the blood, so that two branches that touch further out are told apart.
    """
    ways = np.where(body, 0.0, np.inf).astype(np.float32)
    marks = np.zeros(body.shape, dtype=np.int32)
    node = np.flatnonzero(outside | _rim(body, outside))
    if not len(node):
        return ways, marks
    graph = _neighbour_graph(node, body.shape, step)
    from_body = np.flatnonzero(body.ravel()[node])
    way = dijkstra(graph, directed=False, indices=from_body, min_only=True)
    ways.ravel()[node] = way
    shell = outside & (ways > SHELL_MM[0]) & (ways <= SHELL_MM[1])
    least = np.pi * LEAST_RADIUS_MM**2 * (SHELL_MM[1] - SHELL_MM[0]) / step**3
    pieces, sizes = pieces_by_size(shell, smallest=max(int(least), 1))
    if len(sizes):
        piece = pieces.ravel()[node]
        starts = np.flatnonzero(piece)
        _, _, source = dijkstra(
            graph, directed=False, indices=starts, min_only=True, return_predecessors=True
        )
        reached = (source >= 0) & outside.ravel()[node]
        marks.ravel()[node[reached]] = piece[source[reached]]
    return ways, marks


def _rim(body: Truths, outside: Truths) -> Truths:
    """Voxels of the body beside those outside it."""
    rim: Truths = body & binary_dilation(outside, np.ones((3, 3, 3), dtype=bool))
    return rim


def _neighbour_graph(node: Integers, shape: tuple[int, ...], step: float) -> csr_array:
    """Distances between the voxels `node` (flat indices, ascending) and their 26 neighbours."""
    index = np.stack(np.unravel_index(node, shape), axis=1)
    starts, ends, lengths = [], [], []
    for offset in np.argwhere(np.ones((3, 3, 3)))[14:] - 1:
        beside = index + offset
        flat = np.ravel_multi_index(tuple(beside.T), shape, mode="clip")
        place = np.minimum(np.searchsorted(node, flat), len(node) - 1)
        joined = (node[place] == flat) & (beside >= 0).all(axis=1) & (beside < shape).all(axis=1)
        starts.append(np.flatnonzero(joined))
        ends.append(place[joined])
        lengths.append(np.full(int(joined.sum()), step * float(np.linalg.norm(offset))))
    pairs = (np.concatenate(starts), np.concatenate(ends))
    return csr_array(coo_array((np.concatenate(lengths), pairs), shape=(len(node), len(node))))


def _branch(branch: Truths, ways: NDArray[np.float32], step: float) -> Branch:
    """The measures of a branch: a leak if it holds too much, else a vein until told otherwise."""
    way = ways[branch]
    in_shell = branch & (ways > SHELL_MM[0]) & (ways <= SHELL_MM[1])
    area = in_shell.sum() * step**3 / (SHELL_MM[1] - SHELL_MM[0])
    volume_ml = float(branch.sum() * step**3 / 1000)
    return Branch(
        "vein" if volume_ml <= LEAK_ML else "leak",
        np.argwhere(in_shell).mean(axis=0) * step,
        float(np.sqrt(area / np.pi)),
        float(way.max()),
        volume_ml,
    )


def _necks(
    branches: list[Branch], marks: NDArray[np.int32], ways: NDArray[np.float32], others: Truths
) -> set[int]:
    """Which branches, too short for a vein, touch a leak or others away from the body."""
    outer = np.where(ways > TOUCHING_MM, marks, 0)
    leaks = [number for number, branch in enumerate(branches) if branch.kind == "leak"]
    elsewhere = others | np.isin(outer, [leak + 1 for leak in leaks])
    touching = outer[binary_dilation(elsewhere, np.ones((3, 3, 3), dtype=bool))]
    return {
        mark - 1
        for mark in np.unique(touching).tolist()
        if mark and branches[mark - 1].length < LEAST_LENGTH_MM
    }


def _appendage(branches: list[Branch], middle: Points) -> int:
    """Which branch is the appendage: the furthest in front of those to the left; −1 for none."""
    best, furthest = -1, -np.inf
    for number, branch in enumerate(branches):
        direction = (branch.ostium - middle) / np.linalg.norm(branch.ostium - middle)
        is_one = (
            direction[0] > _LEFT
            and direction[1] < _FRONT
            and APPENDAGE_ML[0] <= branch.volume_ml <= APPENDAGE_ML[1]
            and APPENDAGE_MM[0] <= branch.length <= APPENDAGE_MM[1]
        )
        if is_one and -direction[1] > furthest:
            best, furthest = number, -direction[1]
    return best
