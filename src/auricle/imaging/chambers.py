"""Chambers: which of a blood pool's basins are the left atrium, its ventricle, or something else.

All rules of place hold in LPS mm: lattices here have axes left, back, head.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from auricle.arrays import Integers, Truths
from auricle.imaging.necks import Basins, owners, widest_ways

ATRIUM, VENTRICLE, OTHER = 1, 2, 3
"""Labels of the territories."""

TO_VENTRICLE = np.array([0.62, -0.55, -0.56])
"""Unit vector from the left atrium to the left ventricle: left, front, down."""
LEAST_CHAMBER_RADIUS = 8.0
"""A basin that holds a smaller ball, mm, is a vessel or a part of a chamber."""
LARGEST_BRANCH_ML = 30.0
"""What opens into the atrium alone and holds less is a vein or the appendage."""
_LEFT = 0.2
LOBE = 0.85
"""An opening this wide, as a share of the smaller radius beside it, parts nothing."""
TOWARD = 0.7
"""Least cosine to that direction of a chamber that is the ventricle; the appendage has 0.55."""


@dataclass(frozen=True, eq=False)
class Chambers:
    """The territories of a blood pool.

    Attributes
    ----------
    labels
        Shape of the lattice: 0, ATRIUM, VENTRICLE or OTHER.
    radius
        Of the largest ball in the atrium, mm.
    centre
        Index of its centre, shape (3,).
    mitral_radius
        Of the opening to the ventricle, mm; 0 if there is none.
    mitral_share
        That radius over the smaller of the radii beside it.
    leak_radius
        Of the widest opening to anything else, mm; 0 if there is none.
    leak_index
        Where, shape (3,).
    """

    labels: NDArray[np.int8]
    radius: float
    centre: Integers
    mitral_radius: float
    mitral_share: float
    leak_radius: float
    leak_index: Integers


def chambers_of(basins: Basins, home: int, *, step: float, oriented: bool = True) -> Chambers:
    """Give every basin to the atrium, the ventricle or another structure.

    Parameters
    ----------
    basins
        Of the blood pool.
    home
        The basin of the atrium's middle.
    step
        Spacing of the lattice, mm.
    oriented
        Whether the lattice's axes are known to be left, back and head; if not, the chamber with
        the widest opening to the atrium is taken for the ventricle.
    """
    markers = np.array([home, *_other_chambers(basins, home, step=step, oriented=oriented)])
    owner = owners(basins, markers.tolist())
    group = _groups(basins, markers, home)[owner]
    group[owner < 0] = -1
    openings = _openings(basins, owner == home, group)
    ventricle = _ventricle(basins, openings, group, home, oriented=oriented)
    role = np.where(owner == home, ATRIUM, OTHER)
    role[(group == ventricle) & (owner != home) & (group >= 0)] = VENTRICLE
    labels = np.concatenate([[0], role]).astype(np.int8)[basins.labels]
    mitral = openings.get(ventricle, (0.0, home))
    leak = max(
        (opening for other, opening in openings.items() if other != ventricle),
        default=(0.0, home),
    )
    smaller = min(basins.peaks[home], max(basins.peaks[group == ventricle], default=np.inf))
    return Chambers(
        labels,
        float(basins.peaks[home]),
        basins.centres[home],
        mitral[0],
        mitral[0] / float(smaller),
        leak[0],
        basins.centres[leak[1]],
    )


def _other_chambers(basins: Basins, home: int, *, step: float, oriented: bool) -> list[int]:
    """Basins that are chambers of their own."""
    offset = (basins.centres - basins.centres[home]) * step
    far = np.linalg.norm(offset, axis=1)
    toward = (offset @ TO_VENTRICLE / np.maximum(far, 1.0) > TOWARD) & oriented
    beyond = toward & (far > basins.peaks[home])
    smaller = np.minimum(basins.peaks, basins.peaks[home])
    width, limb = widest_ways(basins, home)
    lobe = (width >= LOBE * smaller) & ~beyond
    millilitres = basins.n_voxels * step**3 / 1000
    whole = np.bincount(np.maximum(limb, 0), millilitres, minlength=len(limb))[np.maximum(limb, 0)]
    branch = (_widest_neighbour(basins) == home) & (millilitres < LARGEST_BRANCH_ML)
    branch = (branch | (whole < LARGEST_BRANCH_ML)) & ~beyond
    # Right and in front lie the right atrium and the aorta, never a vein or the appendage.
    left, back = offset[:, 0] / np.maximum(far, 1.0), offset[:, 1] / np.maximum(far, 1.0)
    branch &= (left > _LEFT) | (back > -_LEFT) | (not oriented)
    large = (basins.peaks >= LEAST_CHAMBER_RADIUS) | (millilitres >= LARGEST_BRANCH_ML)
    chamber: Truths = large & ~lobe & ~branch
    chamber[home] = False
    return np.flatnonzero(chamber).tolist()


def _widest_neighbour(basins: Basins) -> Integers:
    """The basin each basin opens into most widely, shape (b,); −1 for none."""
    neighbour = np.full(len(basins.peaks), -1, dtype=np.int64)
    # The last assignment stays: rows from the narrowest neck to the widest, each way round.
    order = np.repeat(np.argsort(basins.necks, kind="stable"), 2)
    turned = np.arange(len(order)) % 2
    neighbour[basins.pairs[order, turned]] = basins.pairs[order, 1 - turned]
    return neighbour


def _groups(basins: Basins, markers: Integers, home: int) -> Integers:
    """One number for markers that are parts of one chamber, by basin; itself elsewhere."""
    group = np.arange(len(basins.peaks))
    is_marker = np.zeros(len(group), dtype=bool)
    is_marker[markers] = True
    is_marker[home] = False
    for (one, other), neck in zip(basins.pairs, basins.necks, strict=True):
        smaller = min(basins.peaks[one], basins.peaks[other])
        if is_marker[one] and is_marker[other] and neck >= 0.75 * smaller:
            group[group == group[other]] = group[one]
    return group


def _openings(basins: Basins, atrium: Truths, group: Integers) -> dict[int, tuple[float, int]]:
    """By group beside the atrium: radius of the widest opening, and the basin behind it."""
    openings: dict[int, tuple[float, int]] = {}
    for (one, other), neck in zip(basins.pairs, basins.necks, strict=True):
        if atrium[one] == atrium[other]:
            continue
        behind = int(other if atrium[one] else one)
        found = int(group[behind])
        if found >= 0 and neck > openings.get(found, (0.0, -1))[0]:
            openings[found] = (float(neck), behind)
    return openings


def _ventricle(
    basins: Basins,
    openings: dict[int, tuple[float, int]],
    group: Integers,
    home: int,
    *,
    oriented: bool,
) -> int:
    """The group that is the left ventricle; −2 if none is."""
    offset = (basins.centres - basins.centres[home]).astype(float)
    along = offset @ TO_VENTRICLE / np.maximum(np.linalg.norm(offset, axis=1), 1.0)
    large = basins.peaks >= LEAST_CHAMBER_RADIUS

    def toward(found: int) -> float:
        return float(along[(group == found) & large].max(initial=-1.0))

    candidates = [found for found in openings if not oriented or toward(found) > TOWARD]
    return max(candidates, key=lambda found: openings[found][0], default=-2)
