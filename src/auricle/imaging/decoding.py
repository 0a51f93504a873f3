"""Voxels decoded from a file whose header has been checked, within the bounds it announced."""

import gzip
import io
import zlib
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from auricle.arrays import Floats
from auricle.foreign import damaged
from auricle.imaging.header import Image, ImageHeader
from auricle.progress import Progress, silent

_CHUNK = 1 << 24
_ENCODED = 1 << 16


def read_image(header: ImageHeader, *, progress: Progress = silent) -> Image:
    """Read the voxels a header announces, and no byte more; flipped if they are left-handed.

    Raises
    ------
    FormatError
        If the data end early or cannot be decoded.
    """
    values = np.empty(int(np.prod(header.shape)), header.dtype)
    remarks = header.remarks
    try:
        with header.data.open("rb") as file:
            file.seek(header.offset)
            stream = _decoded(file, header.encoding)
            _leave_out(stream, header.skip)
            _fill(values.view(np.uint8), stream, progress)
            if stream.read(1):
                remarks = (*remarks, "the file holds more data than it announces: left out")
    except (gzip.BadGzipFile, zlib.error, EOFError) as fault:
        raise damaged("holds compressed data that cannot be unpacked") from fault
    if not values.dtype.isnative:
        values = values.byteswap(inplace=True).view(values.dtype.newbyteorder("="))
    voxels, affine = right_handed(values.reshape(header.shape, order="F"), header.affine)
    return Image(voxels, header, affine, remarks)


def right_handed(voxels: NDArray[np.generic], affine: Floats) -> tuple[NDArray[np.generic], Floats]:
    """The same voxels at the same places, counted so that the axes are right-handed.

    Returns
    -------
    voxels
        A view: as given, or with the first axis counted backwards.
    affine
        Shape (4, 4), with a positive determinant.
    """
    if np.linalg.det(affine[:3, :3]) > 0:
        return voxels, affine
    flip = np.diag([-1.0, 1.0, 1.0, 1.0])
    flip[0, 3] = len(voxels) - 1
    return voxels[::-1], affine @ flip


class _Inflated(io.RawIOBase):
    """A zlib stream, unpacked no further than it is read."""

    def __init__(self, file: BinaryIO) -> None:
        super().__init__()
        self._file = file
        self._engine = zlib.decompressobj(wbits=47)  # zlib's own wrapping or gzip's

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        """Unpack into `buffer`; the number of bytes, 0 at the end."""
        data = b""
        while not data and not self._engine.eof:
            encoded = self._engine.unconsumed_tail or self._file.read(_ENCODED)
            if not encoded:
                break
            data = self._engine.decompress(encoded, len(buffer))
        buffer[: len(data)] = data
        return len(data)


def _decoded(file: BinaryIO, encoding: str) -> BinaryIO | gzip.GzipFile | _Inflated:
    if encoding == "gzip":
        return gzip.GzipFile(fileobj=file)
    return _Inflated(file) if encoding == "zlib" else file


def _leave_out(stream: BinaryIO | gzip.GzipFile | _Inflated, count: int) -> None:
    left = count
    while left:
        passed = len(stream.read(min(left, _ENCODED)) or b"")
        if not passed:
            raise damaged("ends before its voxels begin")
        left -= passed


def _fill(
    memory: NDArray[np.uint8], stream: BinaryIO | gzip.GzipFile | _Inflated, progress: Progress
) -> None:
    view = memory.data
    done = 0
    while done < len(view):
        count = stream.readinto(view[done : done + _CHUNK])  # type: ignore[union-attr]
        if not count:
            raise damaged(f"announces {len(view):,} bytes of voxels, holds {done:,}")
        done += count
        progress("reading voxels", done, len(view))
