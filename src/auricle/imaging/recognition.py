"""Recognition: whether a path is a CT, before anything is read."""

from itertools import islice
from pathlib import Path

from auricle.imaging.image_files import is_image_file

_FILES_LOOKED_AT = 1_000


def is_volume(path: Path) -> bool:
    """Whether a path is read as a CT: an image file, DICOM, or a folder that holds some.

    >>> is_volume(Path("scan.nrrd")), is_volume(Path("atrium.vtp"))
    (True, False)
    """
    if path.is_dir():
        return any(_is_dicom(each) for each in islice(path.rglob("*"), _FILES_LOOKED_AT))
    return is_image_file(path) or path.suffix.lower() in ("", ".dcm")


def _is_dicom(path: Path) -> bool:
    if path.suffix.lower() == ".dcm":
        return True
    try:
        with path.open("rb") as file:
            return file.read(132)[128:] == b"DICM"
    except OSError:
        return False
