"""Label maps: the mask of one label in an image of whole numbers."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from auricle.errors import FormatError
from auricle.imaging.dicom_segmentation import is_dicom_segmentation, segments
from auricle.imaging.faults import naming
from auricle.imaging.image_files import SUFFIXES, image_from_file, is_image_file
from auricle.imaging.mask import Mask
from auricle.progress import Progress, silent

_MOST_SHOWN = 20


def label_mask(path: Path, label: int | Sequence[int], *, progress: Progress = silent) -> Mask:
    """Read the voxels that carry `label`, or one of several, in a label map.

    Parameters
    ----------
    path
        A NIfTI, NRRD or MetaImage file of whole numbers, or a DICOM-SEG (with highdicom
        installed).
    label
        The number of the structure (in a DICOM-SEG: of the segment), or of its parts.
    progress
        Told how far the reading is.

    Raises
    ------
    FormatError
        If the file cannot be read, holds other than whole numbers, or lacks a label: then the
        message lists the labels there are with their volumes.
    """
    with naming(path):
        wanted = [label] if isinstance(label, int) else list(label)
        if not is_image_file(path):
            return _of_segmentation(path, wanted)
        image = image_from_file(path, progress=progress)
        header = image.header
        if (header.slope, header.intercept) != (1.0, 0.0):
            raise FormatError("holds scaled values, not labels: give a label map")
        return _mask(image.voxels, image.affine, wanted, image.remarks)


def _of_segmentation(path: Path, wanted: list[int]) -> Mask:
    if not path.is_file() or not is_dicom_segmentation(path):
        raise FormatError(
            f"is neither a label map with a name in {' '.join(SUFFIXES)} nor a DICOM-SEG: "
            "convert it"
        )
    inside, affine, numbers = segments(path, wanted)
    missing = [label for label in wanted if label not in numbers]
    if missing:
        raise FormatError(
            f"has no segment {missing[0]}: it holds {', '.join(map(str, numbers))}; "
            "give one of them"
        )
    if not inside.any():
        raise FormatError(f"segment {wanted[0]} is empty: give another")
    inside.flags.writeable = False
    return Mask(inside, affine)


def _mask(
    voxels: NDArray[Any], affine: NDArray[np.float64], wanted: list[int], remarks: tuple[str, ...]
) -> Mask:
    inside = np.zeros_like(voxels, bool)
    for label in wanted:
        carrying = voxels == label
        if not carrying.any():
            raise FormatError(
                f"has no label {label}: it holds {_inventory(voxels, affine)}; give one of them"
            )
        inside |= carrying
    if voxels.dtype.kind == "f" and (voxels != np.round(voxels)).any():
        raise FormatError("holds fractions, not labels: give a label map of whole numbers")
    inside.flags.writeable = False
    return Mask(inside, affine, remarks)


def _inventory(voxels: NDArray[Any], affine: NDArray[np.float64]) -> str:
    ml = abs(np.linalg.det(affine[:3, :3])) / 1000
    labels, counts = np.unique(voxels, return_counts=True)
    found = [
        f"{value:g} ({count * ml:.1f} ml)"
        for value, count in zip(labels, counts, strict=True)
        if value
    ]
    more = f" and {len(found) - _MOST_SHOWN} more" if len(found) > _MOST_SHOWN else ""
    return ", ".join(found[:_MOST_SHOWN]) + more if found else "nothing but 0"
