"""Segments of a DICOM segmentation object (DICOM-SEG), where highdicom is installed."""

from collections.abc import Sequence
from importlib import import_module, util
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from auricle.arrays import Floats
from auricle.errors import FormatError
from auricle.foreign import damaged
from auricle.imaging.decoding import right_handed
from auricle.imaging.dicom_parsing import PARSER_FAULTS, parsed, quiet
from auricle.imaging.header import require_straight, require_volume

_SEGMENTATIONS = ("1.2.840.10008.5.1.4.1.1.66.4", "1.2.840.10008.5.1.4.1.1.66.7")


def is_dicom_segmentation(path: Path) -> bool:
    """Whether a file is a DICOM segmentation object, by its class."""
    try:
        with quiet():
            dataset = parsed(path, ("SOPClassUID",))
            return dataset is not None and str(dataset.get("SOPClassUID")) in _SEGMENTATIONS
    except PARSER_FAULTS:
        return False


def segments(path: Path, wanted: Sequence[int]) -> tuple[NDArray[np.bool_], Floats, list[int]]:
    """Voxels of any of the segments `wanted`.

    Returns
    -------
    inside
        Shape (nx, ny, nz), the slices the file holds; False everywhere for segments it lacks.
    affine
        Shape (4, 4): indices to mm, LPS; right-handed.
    numbers
        The segments there are.

    Raises
    ------
    FormatError
        If highdicom is not installed, or the file is damaged or no straight and even stack.
    """
    if util.find_spec("highdicom") is None:
        raise FormatError(
            "is a DICOM-SEG, which needs the package highdicom: install it, "
            "or convert the file to NIfTI or NRRD"
        )
    library: Any = import_module("highdicom.seg")
    try:
        with quiet():
            stack = library.segread(path)
            numbers = [int(number) for number in stack.segment_numbers]
            return (*_voxels(stack, [one for one in wanted if one in numbers]), numbers)
    except (*PARSER_FAULTS, RuntimeError) as fault:
        raise damaged(f"is a DICOM-SEG that cannot be read ({type(fault).__name__})") from fault


def _voxels(stack: Any, wanted: list[int]) -> tuple[NDArray[np.bool_], Floats]:
    geometry = stack.get_volume_geometry(allow_missing_positions=True)
    if geometry is None:
        raise FormatError("is a DICOM-SEG whose slices are unevenly spaced: resample it")
    shape = tuple(int(size) for size in geometry.spatial_shape)
    require_volume(shape)
    require_straight(np.asarray(geometry.affine, np.float64))
    inside = np.zeros(shape, bool)
    for number in wanted:
        volume = stack.get_volume(segment_numbers=[number], allow_missing_positions=True)
        inside |= np.asarray(volume.array).reshape(shape) > 0
    turned, affine = right_handed(inside, np.asarray(geometry.affine, np.float64))
    return turned.astype(bool), affine
