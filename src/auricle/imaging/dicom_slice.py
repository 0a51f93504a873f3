"""One slice of a DICOM series: what the reader may know of it, and where its pixels are."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np


@dataclass(frozen=True)
class Phase:
    """What tells moments of the heart's cycle apart; None where the file does not say.

    Attributes
    ----------
    percent
        Nominal share of the cycle, %.
    temporal
        Number of the temporal position.
    trigger_ms
        Time after the R wave, ms.
    acquisition
        Number of the acquisition.
    """

    percent: float | None
    temporal: int | None
    trigger_ms: float | None
    acquisition: int | None


@dataclass(frozen=True)
class Scaling:
    """How stored pixels become HU.

    Attributes
    ----------
    slope, intercept
        HU = slope · stored + intercept.
    padding
        Least and largest stored number that stand for no measurement, or None.
    """

    slope: float
    intercept: float
    padding: tuple[int, int] | None


@dataclass(frozen=True)
class SliceHeader:
    """What the reader may know of one slice.

    Attributes
    ----------
    path
        Its file.
    series, instance
        Identifiers, for comparison only; they never leave the reader.
    number
        Number of its series, for the order of a listing.
    kind
        ``original axial`` and the like, with the reconstruction kernel.
    shape
        Rows and columns.
    spacing
        Distance of rows and of columns, mm.
    orientation
        Directions of increasing column and of increasing row, LPS.
    position
        Centre of the first pixel, mm, LPS.
    dtype
        Type of the stored pixels, byte order included.
    bits_stored
        How many of their bits count.
    scaling
        How they become HU.
    packed
        Whether they are compressed.
    order
        Instance number, or None.
    phase
        Where in the heart's cycle it lies.
    announced
        How many images its acquisition should have, or None.
    remarks
        What the user should know, the same words for every slice.
    """

    path: Path
    series: str
    instance: str
    number: int
    kind: str
    shape: tuple[int, int]
    spacing: tuple[float, float]
    orientation: tuple[float, ...]
    position: tuple[float, float, float]
    dtype: np.dtype[np.generic]
    bits_stored: int
    scaling: Scaling
    packed: bool
    order: int | None
    phase: Phase
    announced: int | None
    remarks: tuple[str, ...]
