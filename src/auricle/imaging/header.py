"""What an image file announces of itself, and the limits nobody may announce beyond."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from auricle.arrays import Floats
from auricle.errors import FormatError
from auricle.foreign import damaged, require_bytes

MOST_VOXELS = 700_000_000
"""Ten times a clinical volume of 512×512×270."""
SPACINGS = (0.02, 20.0)
"""Least and largest distance of neighbouring voxels that a CT may have, mm."""
SHEAR = 1e-4
"""Cosine up to which two axes count as being at right angles."""
_MOST_INFLATION = 1100
"""Deflate cannot pack more than 1032 bytes into one."""


@dataclass(frozen=True, eq=False)
class ImageHeader:
    """What a file promised before any of its voxels was read.

    Attributes
    ----------
    data
        The file with the voxels.
    dtype
        Their type, byte order included.
    shape
        Voxels along the first (fastest), second and third axis.
    affine
        Shape (4, 4): (i, j, k, 1) to mm, LPS axes.
    encoding
        ``raw``, ``gzip`` or ``zlib``.
    offset
        Bytes in the file before the (encoded) data.
    skip
        Bytes to leave out after decoding.
    slope, intercept
        What turns stored numbers into values.
    orientation_known
        Whether the file says which way the patient lies.
    remarks
        What the user should know of the way the file will be read.

    Raises
    ------
    FormatError
        If there are fewer than two voxels along an axis, more than the limit in all or than the
        file can hold, or the spacing is none a CT could have, or the axes are sheared.
    """

    data: Path
    dtype: np.dtype[np.generic]
    shape: tuple[int, int, int]
    affine: Floats
    encoding: str = "raw"
    offset: int = 0
    skip: int = 0
    slope: float = 1.0
    intercept: float = 0.0
    orientation_known: bool = True
    remarks: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        require_volume(self.shape)
        require_straight(self.affine)
        self._require_room()

    def _require_room(self) -> None:
        left = self.data.stat().st_size - self.offset
        needed = self.skip + int(np.prod(self.shape, dtype=object)) * self.dtype.itemsize
        if self.encoding != "raw":
            needed = needed // _MOST_INFLATION
        require_bytes(f"{_times(self.shape)} voxels", needed=needed, left=left)


@dataclass(frozen=True, eq=False)
class Image:
    """Voxels as a file holds them: of any type of number, in LPS, right-handed.

    Attributes
    ----------
    voxels
        Shape (nx, ny, nz), indexed [i, j, k]; stored numbers before slope and intercept.
    header
        What the file said; its affine is the one of the voxels.
    affine
        Shape (4, 4): (i, j, k, 1) to mm, LPS axes; its determinant is positive.
    remarks
        What the user should know.
    """

    voxels: NDArray[np.generic]
    header: ImageHeader
    affine: Floats
    remarks: tuple[str, ...]


def require_volume(shape: tuple[int, ...]) -> None:
    """Refuse a shape that is no volume, or too large a one.

    Raises
    ------
    FormatError
        If an axis is shorter than two voxels, or there are more than the limit.
    """
    if min(shape) < 1:
        raise damaged(f"announces {_times(shape)} voxels")
    if min(shape) < 2:
        raise FormatError(f"holds one slice ({_times(shape)}): give the whole volume")
    count = int(np.prod(shape, dtype=object))
    if count > MOST_VOXELS:
        raise FormatError(
            f"announces {_times(shape)} voxels, the limit is {MOST_VOXELS:,}: crop or resample it"
        )


def require_straight(affine: Floats, what: str = "its axes") -> None:
    """Refuse an affine no CT has: wild spacing, or axes that are not at right angles.

    Raises
    ------
    FormatError
        If a number is not finite, a spacing is beyond `SPACINGS`, or `what` is sheared.
    """
    lengths = np.linalg.norm(affine[:3, :3], axis=0)
    require_spacing(lengths)
    if not np.isfinite(affine).all():
        raise damaged("announces a position that is NaN or infinite")
    axes = affine[:3, :3] / lengths
    cosine = np.abs(axes.T @ axes - np.eye(3)).max()
    if cosine > SHEAR:
        angle = np.degrees(np.arcsin(min(cosine, 1.0)))
        raise FormatError(
            f"{what} are sheared by {angle:.2g}°: resample it to a straight grid"
            " (a resliced or registered copy often is sheared; the original is not)"
        )


def require_spacing(spacing: Floats) -> None:
    """Refuse distances of voxels that no CT has.

    Raises
    ------
    FormatError
        If one is not finite or beyond `SPACINGS`.
    """
    least, most = SPACINGS
    if not ((spacing >= least) & (spacing <= most)).all():
        text = "×".join(f"{length:.4g}" for length in spacing)
        raise FormatError(
            f"announces voxels {text} mm apart, CT has {least:g} to {most:g}: "
            "correct the spacing (is it in metres, zero or missing?)"
        )


def _times(shape: tuple[int, ...]) -> str:
    return "×".join(map(str, shape))
