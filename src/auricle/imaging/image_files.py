"""NIfTI, NRRD and MetaImage files: header first, then the voxels it announces."""

from collections.abc import Callable
from pathlib import Path

from auricle.errors import FormatError
from auricle.imaging.decoding import read_image
from auricle.imaging.header import Image, ImageHeader
from auricle.imaging.metaimage import metaimage_header
from auricle.imaging.nifti import nifti_header
from auricle.imaging.nrrd import nrrd_header
from auricle.progress import Progress, silent

_HEADERS: dict[str, Callable[[Path], ImageHeader]] = {
    ".nii": nifti_header,
    ".nii.gz": nifti_header,
    ".nrrd": nrrd_header,
    ".nhdr": nrrd_header,
    ".mha": metaimage_header,
    ".mhd": metaimage_header,
}
SUFFIXES = tuple(_HEADERS)
"""Ends of the names of image files, in lower case."""


def is_image_file(path: Path) -> bool:
    """Whether the name ends as one of `SUFFIXES` (case does not matter).

    >>> is_image_file(Path("heart.NII.gz")), is_image_file(Path("heart.dcm"))
    (True, False)
    """
    return path.name.lower().endswith(SUFFIXES)


def image_from_file(path: Path, *, progress: Progress = silent) -> Image:
    """Read the voxels and the geometry of an image file.

    Raises
    ------
    FormatError
        If it is not what its name says, damaged, or no single volume.
    """
    if not path.stat().st_size:
        raise FormatError("is empty: export it again")
    suffix = next(end for end in SUFFIXES if path.name.lower().endswith(end))
    return read_image(_HEADERS[suffix](path), progress=progress)
