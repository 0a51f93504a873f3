"""CT numbers: stored values turned into Hounsfield units, or refused."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from auricle.errors import FormatError

AIR = -1024
"""HU nothing in a scanner is below; what lies outside its field of view is set to it."""
_WHOLE = np.iinfo(np.int16)
_LEAST_RANGE_HU = 100.0


def hounsfield(
    stored: NDArray[Any], *, slope: float = 1.0, intercept: float = 0.0
) -> tuple[NDArray[Any], tuple[str, ...]]:
    """HU of stored values: slope · stored + intercept, none below −1024.

    Parameters
    ----------
    stored
        Whole or floating-point numbers, any shape; may be overwritten.

    Returns
    -------
    values
        The same shape, read-only; int16 where the values are whole and fit, else float32.
    remarks
        What was changed.

    Raises
    ------
    FormatError
        If a value is NaN or infinite, or all lie within 100 HU: those are other units.

    Examples
    --------
    >>> hounsfield(np.array([0, 1024, 1300], np.uint16), intercept=-1024)[0].tolist()
    [-1024, 0, 276]
    """
    low, high = float(stored.min()), float(stored.max())
    if not np.isfinite([low, high]).all():
        raise FormatError("holds voxels that are NaN or infinite: fill them with −1024 (air)")
    ends = tuple(sorted((low * slope + intercept, high * slope + intercept)))
    require_hounsfield(*ends)
    values = _scaled(stored, slope, intercept, ends)
    floored = 0
    if ends[0] < AIR:
        below = values < AIR
        floored = int(np.count_nonzero(below))
        values[below] = AIR
    values.flags.writeable = False
    return values, floor_remark(floored)


def require_hounsfield(low: float, high: float) -> None:
    """Refuse a range of values no CT has.

    Raises
    ------
    FormatError
        If it is narrower than 100.
    """
    if high - low < _LEAST_RANGE_HU:
        raise FormatError(
            f"holds values from {low:.4g} to {high:.4g}, which are not Hounsfield units: "
            "export CT numbers"
        )


def floor_remark(count: int) -> tuple[str, ...]:
    """Say how many voxels were below −1024 HU, if any were."""
    if not count:
        return ()
    return (f"{count:,} voxels below −1024 HU set to it (outside the scanner's field)",)


def _scaled(
    stored: NDArray[Any], slope: float, intercept: float, ends: tuple[float, ...]
) -> NDArray[Any]:
    whole = (
        stored.dtype.kind in "iu" and float(slope).is_integer() and float(intercept).is_integer()
    )
    if not whole:
        scaled = stored.astype(np.float32, copy=False)
        if (slope, intercept) == (1.0, 0.0):
            return scaled if scaled.flags.writeable else scaled.copy(order="K")
        exact: NDArray[Any] = (stored * np.float64(slope) + intercept).astype(np.float32)
        return exact
    if ends[1] > _WHOLE.max or ends[0] < _WHOLE.min:
        wide: NDArray[Any] = (stored * np.float64(slope) + intercept).astype(np.float32)
        return wide
    if (slope, intercept) == (1.0, 0.0):
        return stored.astype(np.int16, copy=False)
    narrow: NDArray[Any] = (stored * np.int64(slope) + np.int64(intercept)).astype(np.int16)
    return narrow
