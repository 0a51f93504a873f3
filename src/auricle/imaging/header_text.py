"""Numbers and axes in the text headers of NRRD and MetaImage files."""

from pathlib import Path

import numpy as np

from auricle.arrays import Floats
from auricle.errors import FormatError
from auricle.foreign import count_of, damaged, shown


def numbers_in(text: str, *, count: int, what: str) -> Floats:
    """Find the finite numbers in `text`, separated by blanks or commas, shape (count,).

    Raises
    ------
    FormatError
        If there are more or fewer than `count`, or one is no finite number.

    Examples
    --------
    >>> numbers_in("(0.5, 0, -1e2)", count=3, what="origin").tolist()
    [0.5, 0.0, -100.0]
    """
    words = text.replace(",", " ").replace("(", " ").replace(")", " ").split()
    try:
        numbers = np.array([float(word) for word in words], np.float64)
    except ValueError as fault:
        raise damaged(f"gives {shown(text)} as its {what}") from fault
    if len(numbers) != count or not np.isfinite(numbers).all():
        raise damaged(f"gives {shown(text)} as its {what}, {count} numbers are due")
    return numbers


def sizes_in(text: str, *, dimensions: int, components: bool = False) -> tuple[list[int], int]:
    """Find the sizes of the axes, and which axis to leave out to come to three.

    Returns
    -------
    sizes
        Three numbers of voxels.
    left_out
        Which axis of four has the length one and was left out; 4 if there are but three.

    Raises
    ------
    FormatError
        If the axes are not three, or four with one of length 1; the message says colours where
        `components` says so, 4-D else.
    """
    sizes = [count_of(word, "voxels") for word in text.split()]
    if len(sizes) != dimensions:
        raise damaged(f"gives {len(sizes)} sizes for {dimensions} dimensions")
    if dimensions == 3:
        return sizes, 4
    if dimensions == 4 and 1 in (sizes[0], sizes[3]):
        left_out = 3 if sizes[3] == 1 else 0
        return [size for axis, size in enumerate(sizes) if axis != left_out], left_out
    if dimensions < 3:
        raise FormatError(f"holds a {dimensions}-D image: give the whole volume")
    if components:
        raise FormatError("is a colour or vector image: give the CT numbers themselves")
    raise FormatError(
        f"holds several volumes or components ({dimensions}-D): save one of them as its own file"
    )


def data_file(header: Path, name: str) -> Path:
    """Place of the voxels a detached header names, which must lie beside it.

    Raises
    ------
    FormatError
        If several files are named, one elsewhere, or one that is not there.
    """
    several = name.split()[0].upper() in ("LIST", "LIST:") if name.split() else False
    if several or "%" in name:
        raise FormatError("keeps its slices in several files: save it as one file")
    place = header.parent / name
    if not name or Path(name).name != name:
        raise FormatError(f"keeps its voxels in {shown(name)}: put both files into one folder")
    if not place.is_file():
        raise FormatError(f"keeps its voxels in {shown(name)}, which is not there: copy both files")
    return place
