"""Volumes and masks written to files, whole or not at all, with geometry and nothing else."""

from pathlib import Path
from typing import Any

import numpy as np
import SimpleITK
from numpy.typing import NDArray

from auricle.arrays import Floats
from auricle.atomic import write_whole
from auricle.errors import OutputError
from auricle.imaging.mask import Mask
from auricle.imaging.volume import Volume

WRITABLE = (".nrrd", ".nii", ".nii.gz", ".mha")
"""Suffixes `write_volume` and `write_mask` know, in lower case."""
_FAST = 2
"""Level of compression: noise hardly packs better with more."""


def write_volume(volume: Volume, path: Path) -> None:
    """Write HU and geometry, compressed, in the format of the file's suffix.

    NRRD and MetaImage keep the affine to the last digit, NIfTI in single precision (about 1e-5
    mm). The file says LPS (NIfTI: RAS), whether or not the volume's orientation was known.

    Raises
    ------
    OutputError
        If the suffix is none of `WRITABLE`, or the file cannot be written.
    """
    _write(volume.voxels, volume.affine, path)


def write_mask(mask: Mask, path: Path, *, label: int = 1) -> None:
    """Write a mask as a label map of bytes: `label` inside, 0 outside.

    Raises
    ------
    OutputError
        If the suffix is none of `WRITABLE`, the label none of 1 to 255, or the file cannot be
        written.
    """
    if not 1 <= label <= 255:
        raise OutputError(f"{path}: label {label} cannot be written: choose 1 to 255")
    _write(mask.voxels.astype(np.uint8) * np.uint8(label), mask.affine, path)


def _write(voxels: NDArray[Any], affine: Floats, path: Path) -> None:
    suffix = next((end for end in WRITABLE[::-1] if path.name.lower().endswith(end)), None)
    if suffix is None:
        raise OutputError(f"{path}: cannot be written by its suffix: choose {' '.join(WRITABLE)}")
    image = _image(voxels, affine)

    def fill(place: Path) -> None:
        # the library chooses the format by the whole suffix, and misreads names with two
        named = place.with_name(f"{place.name.replace('.', '-')}{suffix}")
        try:
            SimpleITK.WriteImage(image, str(named), suffix != ".nii", compressionLevel=_FAST)
            named.replace(place)
        except RuntimeError as fault:
            raise OutputError(
                f"{path}: cannot be written: choose another place or free space"
            ) from fault
        finally:
            named.unlink(missing_ok=True)

    write_whole(path, fill)


def _image(voxels: NDArray[Any], affine: Floats) -> Any:
    spacing = np.linalg.norm(affine[:3, :3], axis=0)
    image = SimpleITK.GetImageFromArray(voxels.transpose(2, 1, 0))
    image.SetSpacing(spacing.tolist())
    image.SetOrigin(affine[:3, 3].tolist())
    image.SetDirection((affine[:3, :3] / spacing).ravel().tolist())
    return image
