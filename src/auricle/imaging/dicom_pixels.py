"""The pixels of DICOM slices as HU: stored · slope + intercept, padding set to −1024."""

import hashlib
import json
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from auricle.errors import FormatError
from auricle.foreign import damaged, printable
from auricle.imaging.dicom_parsing import PARSER_FAULTS, parsed, quiet
from auricle.imaging.dicom_slice import SliceHeader
from auricle.imaging.hounsfield import AIR, floor_remark, require_hounsfield
from auricle.isolation import run_child
from auricle.progress import Progress, silent

_SECONDS = 60.0
_SECONDS_PER_MEGAPIXEL = 5.0


def read_slices(
    slices: Sequence[SliceHeader], *, progress: Progress = silent
) -> tuple[NDArray[Any], tuple[str, ...]]:
    """HU of a stack, in the order given.

    Returns
    -------
    values
        Shape (columns, rows, slices), read-only; int16 where all are whole, else float32.
    remarks
        How many voxels were padding, or below −1024 HU.

    Raises
    ------
    FormatError
        If pixels are missing or cannot be decoded, or are no HU; the message names the file.
    """
    rows, columns = slices[0].shape
    values: NDArray[Any] = np.empty((len(slices), rows, columns), _kind_of(slices))
    padded = floored = 0
    for k, (header, stored, is_hu) in enumerate(_stored(slices)):
        hu, blank = _hounsfield(header, stored, is_hu=is_hu)
        low = hu < AIR
        padded += int(np.count_nonzero(blank))
        floored += int(np.count_nonzero(low & ~blank))
        hu[blank | low] = AIR
        if values.dtype == np.int16 and hu.max() > np.iinfo(np.int16).max:
            values = values.astype(np.float32)
        values[k] = hu
        progress("reading slices", k + 1, len(slices))
    require_hounsfield(float(values.min()), float(values.max()))
    remarks = (f"{padded:,} voxels of padding set to −1024 HU",) if padded else ()
    values.flags.writeable = False
    return values.transpose(2, 1, 0), remarks + floor_remark(floored)


def pixel_digest(header: SliceHeader) -> str:
    """SHA-256 of the pixels as the file stores them."""
    return hashlib.sha256(_pixel_bytes(header)).hexdigest()


def _kind_of(slices: Sequence[SliceHeader]) -> type[np.int16] | type[np.float32]:
    whole = all(
        number.is_integer()
        for header in slices
        for number in (header.scaling.slope, header.scaling.intercept)
    )
    return np.int16 if whole else np.float32


def _stored(slices: Sequence[SliceHeader]) -> Iterator[tuple[SliceHeader, NDArray[Any], bool]]:
    """Each slice, its numbers, and whether they are HU already."""
    packed = [header for header in slices if header.packed]
    if not packed:
        for header in slices:
            yield header, _native(header), False
        return
    with tempfile.TemporaryDirectory(prefix="auricle-", ignore_cleanup_errors=True) as folder:
        unpacked = _unpacked(packed, Path(folder))
        place = {header.path: k for k, header in enumerate(packed)}
        for header in slices:
            if header.packed:
                yield header, np.array(unpacked[place[header.path]]), True
            else:
                yield header, _native(header), False
        del unpacked  # Windows removes no mapped file


def _native(header: SliceHeader) -> NDArray[Any]:
    rows, columns = header.shape
    count = rows * columns
    raw = _pixel_bytes(header)
    if len(raw) < count * header.dtype.itemsize:
        raise damaged(
            f"{printable(header.path.name)} holds {len(raw):,} bytes of pixels, "
            f"{count * header.dtype.itemsize:,} are due"
        )
    pixels = np.frombuffer(raw, header.dtype, count).reshape(rows, columns)
    pixels = pixels.astype(header.dtype.newbyteorder("="))
    spare = 8 * header.dtype.itemsize - header.bits_stored
    # shifting up and down clears what is no part of the number, and carries its sign
    return (pixels << spare) >> spare if spare else pixels


def _pixel_bytes(header: SliceHeader) -> bytes:
    try:
        with quiet():
            dataset = parsed(header.path, ("PixelData",))
            pixels = None if dataset is None else dataset.get("PixelData")
    except PARSER_FAULTS as fault:
        raise damaged(f"{printable(header.path.name)} has pixels that cannot be read") from fault
    if not isinstance(pixels, bytes):
        raise damaged(f"{printable(header.path.name)} has no pixels")
    return pixels


def _hounsfield(
    header: SliceHeader, stored: NDArray[Any], *, is_hu: bool
) -> tuple[NDArray[Any], NDArray[np.bool_]]:
    slope, intercept, padding = (
        header.scaling.slope,
        header.scaling.intercept,
        header.scaling.padding,
    )
    wide = stored.astype(np.float64)
    hu = wide if is_hu else wide * slope + intercept
    if padding is None:
        return hu, np.zeros(hu.shape, bool)
    low, high = sorted(end * slope + intercept for end in padding)
    half = abs(slope) / 2
    return hu, (hu > low - half) & (hu < high + half)


def _unpacked(slices: Sequence[SliceHeader], folder: Path) -> NDArray[Any]:
    """HU of compressed slices, shape (slices, rows, columns), decoded in a child process."""
    order, target = folder / "order.json", folder / "slices.npy"
    rows, columns = slices[0].shape
    task = {
        "paths": [str(header.path.absolute()) for header in slices],
        "shape": [len(slices), rows, columns],
        "dtype": "<i4" if _kind_of(slices) is np.int16 else "<f8",
    }
    order.write_text(json.dumps(task), encoding="utf-8")
    megapixels = len(slices) * rows * columns / 1e6
    module = [sys.executable, "-P", "-m", "auricle.imaging.dicom_child"]
    run_child(
        [*module, str(order), str(target)], seconds=_SECONDS + _SECONDS_PER_MEGAPIXEL * megapixels
    )
    try:
        unpacked: NDArray[Any] = np.load(target, mmap_mode="r", allow_pickle=False)
    except (OSError, ValueError) as fault:
        raise FormatError("its compressed pixels could not be decoded: export it again") from fault
    return unpacked
