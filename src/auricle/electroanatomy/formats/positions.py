"""Positions that faces rest on: all there, all numbers."""

import numpy as np

from auricle.arrays import Faces, Points
from auricle.surface.formats.header import damaged


def require_positions(vertices: Points, faces: Faces) -> None:
    """Refuse a surface with faces at vertices that stand nowhere.

    Raises
    ------
    FormatError
        If a vertex of a face is NaN or infinite.
    """
    count = int((~np.isfinite(vertices[np.unique(faces)])).any(axis=1).sum())
    if count:
        raise damaged(f"holds no position of {count:,} vertices of faces")
