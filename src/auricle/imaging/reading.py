"""CT volumes read from files and folders, in HU and LPS or not at all."""

from pathlib import Path

from auricle.errors import FormatError
from auricle.imaging.dicom import read_dicom
from auricle.imaging.faults import naming
from auricle.imaging.hounsfield import hounsfield
from auricle.imaging.image_files import SUFFIXES, image_from_file, is_image_file
from auricle.imaging.volume import Volume
from auricle.progress import Progress, silent

READABLE = (*SUFFIXES, ".dcm")
"""Suffixes `read_volume` knows, in lower case; DICOM is read whatever its files are called."""
_SURFACES = (".vtp", ".vtk", ".vtu", ".ply", ".stl", ".obj", ".off", ".pts", ".elem")
_PACKED = (".zip", ".gz", ".tar", ".tgz", ".7z", ".rar", ".bz2", ".xz")


def read_volume(path: Path, *, series: int | None = None, progress: Progress = silent) -> Volume:
    """Read a contrast CT: a DICOM folder or file, NIfTI, NRRD or MetaImage.

    Headers are held against each other and the files' sizes before a voxel is read. A volume
    comes back in HU, none below −1024, on a straight even lattice in LPS with right-handed axes,
    or an error names the files and the remedy.

    ==================== =======================================================================
    input                orientation
    ==================== =======================================================================
    DICOM                positions and orientations of the slices
    .nii .nii.gz         sform, else qform (turned from RAS); neither: unknown, remarked
    .nrrd .nhdr          space and space directions (LPS, RAS, LAS); neither: unknown, remarked
    .mha .mhd            TransformMatrix, LPS; none: unknown, remarked
    ==================== =======================================================================

    Parameters
    ----------
    path
        A file, or a folder with a DICOM series.
    series
        Which series of a DICOM folder, from 1, where there are several; the error lists them.
    progress
        Told how far the reading is.

    Raises
    ------
    FormatError
        If the input is missing, damaged, ambiguous, too large, no CT, or not on a straight and
        even lattice; the message begins with the path.
    """
    with naming(path):
        if path.is_dir() or not path.name.lower().endswith((*SUFFIXES, *_SURFACES, *_PACKED)):
            return read_dicom(path, series=series, progress=progress)
        if series is not None:
            raise FormatError("is one image, not a folder of series: leave --series out")
        if not is_image_file(path):
            raise _other_kind(path)
        image = image_from_file(path, progress=progress)
        header = image.header
        values, remarks = hounsfield(image.voxels, slope=header.slope, intercept=header.intercept)
        return Volume(values, image.affine, image.remarks + remarks, header.orientation_known)


def _other_kind(path: Path) -> FormatError:
    if path.name.lower().endswith(_PACKED):
        return FormatError("is a packed archive: unpack it and give the folder")
    return FormatError(f"is a surface, not a volume: give {' '.join(READABLE)} or a DICOM folder")
