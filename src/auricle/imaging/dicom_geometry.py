"""The audit of a stack of slices: even, straight, complete, or refused with the files named.

The affine comes from positions and orientations alone, never from slice thickness, instance
numbers or the order of files.
"""

from collections.abc import Sequence

import numpy as np

from auricle.arrays import Floats, Integers
from auricle.errors import FormatError
from auricle.foreign import printable
from auricle.imaging.dicom_series import SAME_PLACE_MM, Series, normal_of
from auricle.imaging.dicom_slice import SliceHeader
from auricle.imaging.header import require_spacing, require_volume

EVENNESS = 0.01
"""How much one step may differ from the usual one, as a share of it."""
_ROUNDING_MM = 0.011
"""Steps of positions written to two decimals differ by as much."""
_TURN = 1e-3
_SIDEWAYS_PIXELS = 0.1
_GAP = 1.5
_COARSE_MM = 3.0
_MOST_NAMED = 3


def stack_affine(series: Series) -> tuple[Floats, tuple[str, ...]]:
    """Affine of slices in the order of their places, after every check.

    Returns
    -------
    affine
        Shape (4, 4): (column, row, slice, 1) to mm, LPS; right-handed.
    remarks
        What the user should know: copies left out, slices that may be missing at an end.

    Raises
    ------
    FormatError
        If the stack is tilted, has a gap, uneven steps, or different pixels at one place, or an
        orientation, spacing or position no CT has.
    """
    slices = series.slices
    if len(slices) < 2:
        raise FormatError(f"{_name(slices[0])} is the only slice: give the whole series")
    columns, rows = _axes(slices)
    normal = np.cross(columns, rows)
    positions = np.array([header.position for header in slices])
    steps = np.diff(positions @ normal)
    _require_single(slices, steps)
    usual = float(np.median(steps))
    _require_no_gap(slices, steps, usual)
    _require_even(slices, steps, usual)
    _require_straight(slices, positions, normal)
    between_rows, between_columns = slices[0].spacing
    step = float(steps.sum() / len(steps))
    spacing = np.array([between_columns, between_rows, step])
    require_spacing(spacing)
    require_volume((slices[0].shape[1], slices[0].shape[0], len(slices)))
    affine = np.eye(4)
    affine[:3, :3] = np.column_stack([columns, rows, normal]) * spacing
    affine[:3, 3] = positions[0]
    return affine, _remarks(series, step)


def series_spacing(series: Series) -> tuple[float, float, float]:
    """Distance of columns, rows and slices, mm, before any check; for a listing."""
    heights = np.array([np.dot(header.position, normal_of(header)) for header in series.slices])
    step = float(np.median(np.diff(heights))) if len(heights) > 1 else 0.0
    between_rows, between_columns = series.slices[0].spacing
    return between_columns, between_rows, step


def _axes(slices: Sequence[SliceHeader]) -> tuple[Floats, Floats]:
    """Directions of columns and rows, made exactly orthonormal."""
    first = np.array(slices[0].orientation).reshape(2, 3)
    for header in slices:
        if np.abs(np.subtract(header.orientation, slices[0].orientation)).max() > _TURN:
            raise FormatError(
                f"{_name(header)} is turned against {_name(slices[0])}: "
                "give slices that are parallel"
            )
    columns = first[0] / np.linalg.norm(first[0])
    rows = first[1] - (first[1] @ columns) * columns
    return columns, rows / np.linalg.norm(rows)


def _require_single(slices: Sequence[SliceHeader], steps: Floats) -> None:
    repeated = np.flatnonzero(steps < SAME_PLACE_MM)
    if len(repeated) == len(steps):
        raise FormatError(
            f"all {len(slices)} slices lie at one place (ImagePositionPatient): "
            "export the original CT images"
        )
    if len(repeated):
        pairs = [f"{_name(slices[int(k)])} and {_name(slices[int(k) + 1])}" for k in repeated]
        raise FormatError(
            f"{_some(pairs)} show different pixels at one place: two images of a slice are mixed; "
            "leave out one of each or export one series at a time"
        )


def _require_no_gap(slices: Sequence[SliceHeader], steps: Floats, usual: float) -> None:
    wide = np.flatnonzero(steps > _GAP * usual)
    if not len(wide):
        return
    missing = int(sum(max(round(steps[k] / usual) - 1, 1) for k in wide))
    places = _steps_named(slices, steps, wide)
    raise FormatError(
        f"{missing} slices are missing: {_some(places)}, {usual:.4g} mm elsewhere; "
        "copy or export the whole series"
    )


def _require_even(slices: Sequence[SliceHeader], steps: Floats, usual: float) -> None:
    allowed = max(EVENNESS * usual, _ROUNDING_MM)
    uneven = np.flatnonzero(np.abs(steps - usual) > allowed)
    if len(uneven):
        places = _steps_named(slices, steps, uneven)
        raise FormatError(
            f"the slices are unevenly spaced: {_some(places)}, {usual:.4g} mm is usual; "
            "export an evenly spaced reconstruction, or resample it"
        )
    even = np.linspace(0.0, steps.sum(), len(steps) + 1)[1:]
    if np.abs(np.cumsum(steps) - even).max() > max(10 * EVENNESS * usual, 2 * _ROUNDING_MM):
        raise FormatError(
            f"the slices are unevenly spaced: steps drift from {steps.min():.4g} to "
            f"{steps.max():.4g} mm; export an evenly spaced reconstruction, or resample it"
        )


def _require_straight(slices: Sequence[SliceHeader], positions: Floats, normal: Floats) -> None:
    offsets = positions - positions[0]
    sideways = np.linalg.norm(offsets - np.outer(offsets @ normal, normal), axis=1)
    if sideways.max() <= _SIDEWAYS_PIXELS * min(slices[0].spacing):
        return
    angle = np.degrees(np.arctan2(sideways[-1], offsets[-1] @ normal))
    worst = int(np.argmax(sideways))
    steady = np.linspace(0.0, sideways[-1], len(sideways))
    if np.abs(sideways - steady).max() > max(0.05 * sideways.max(), _ROUNDING_MM):
        raise FormatError(
            f"{_name(slices[worst])} is shifted sideways by {sideways[worst]:.3g} mm against "
            f"{_name(slices[0])}: export the original CT images"
        )
    raise FormatError(
        f"the slices are tilted by {angle:.1f}° against their stack (gantry tilt): "
        "export a straight reconstruction, or resample it"
    )


def _remarks(series: Series, step: float) -> tuple[str, ...]:
    remarks = tuple(dict.fromkeys(note for header in series.slices for note in header.remarks))
    if series.copies:
        remarks += (f"{series.copies} files left out: copies of slices that are there",)
    announced = max((header.announced or 0 for header in series.slices), default=0)
    if announced > series.scanned:
        remarks += (
            f"the scanner announces {announced} images, {series.scanned} are here: "
            "slices may be missing at an end",
        )
    if step > _COARSE_MM:
        remarks += (f"slices {step:.3g} mm apart: coarse for an atrium",)
    if series.phase:
        remarks += (f"phase: {series.phase}",)
    return remarks


def _steps_named(slices: Sequence[SliceHeader], steps: Floats, which: Integers) -> list[str]:
    return [
        f"{steps[k]:.4g} mm between {_name(slices[k])} and {_name(slices[k + 1])}"
        for k in map(int, which)
    ]


def _some(texts: Sequence[str]) -> str:
    more = len(texts) - _MOST_NAMED
    return ", ".join(texts[:_MOST_NAMED]) + (f" and {more} more" if more > 0 else "")


def _name(header: SliceHeader) -> str:
    return printable(header.path.name)
