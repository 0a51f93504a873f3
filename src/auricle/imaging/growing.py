"""Region growing: the blood connected to a seed between two thresholds."""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, label

from auricle.arrays import Integers, Truths
from auricle.errors import ImageError


def grown_region(
    values: NDArray[np.floating],
    seed: tuple[int, int, int],
    *,
    lower: float,
    upper: float = np.inf,
) -> Truths:
    """Voxels with lower ≤ value ≤ upper that a path over faces of such voxels joins to the seed.

    Raises
    ------
    ImageError
        If the seed lies outside the lattice, or its own value outside the thresholds.

    Examples
    --------
    >>> line = np.array([0.0, 5.0, 6.0, 0.0, 5.0]).reshape(5, 1, 1)
    >>> grown_region(line, (1, 0, 0), lower=4.0).ravel().tolist()
    [False, True, True, False, False]
    """
    if not all(0 <= index < n for index, n in zip(seed, values.shape, strict=True)):
        raise ImageError(f"seed {seed} lies outside the lattice {values.shape}: move it")
    within = (values >= lower) & (values <= upper)
    if not within[seed]:
        raise ImageError(
            f"the seed's value, {float(values[seed]):.0f} HU, is not between {lower:.0f} and "
            f"{upper:.0f} HU: put the seed into blood"
        )
    marks, _ = label(within)
    region: Truths = marks == marks[seed]
    return region


def pieces_by_size(region: Truths, *, smallest: int = 1) -> tuple[Integers, Integers]:
    """Face-connected pieces of `smallest` voxels or more, the largest first.

    Returns
    -------
    labels
        Shape of the region: 0 outside and in pieces too small, then 1, 2, …
    sizes
        Voxels of each piece, shape (p,).
    """
    marks, n_pieces = label(region)
    if not n_pieces:
        return np.zeros(region.shape, dtype=np.int64), np.zeros(0, dtype=np.int64)
    sizes = np.bincount(marks.ravel(), minlength=n_pieces + 1)[1:]
    order = np.argsort(-sizes, kind="stable")
    kept = order[sizes[order] >= smallest]
    rank = np.zeros(n_pieces + 1, dtype=np.int64)
    rank[kept + 1] = np.arange(1, len(kept) + 1)
    return rank[marks], sizes[kept].astype(np.int64)


def spread_labels(
    labels: NDArray[np.integer], region: Truths, *, reach: float, step: float
) -> NDArray[np.int8]:
    """Labels carried to the voxels of `region` no further than `reach` (mm): the nearest one's."""
    distance, nearest = distance_transform_edt(labels == 0, sampling=step, return_indices=True)
    carried = labels[tuple(nearest)]
    return np.where(region & (distance <= reach), carried, 0).astype(np.int8)
