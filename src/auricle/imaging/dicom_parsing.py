"""DICOM files parsed: chosen tags alone, within bounds, and without a word in any log."""

import logging
import struct
import warnings
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pydicom
from pydicom.errors import BytesLengthException, InvalidDicomError

from auricle.errors import FormatError

PARSER_FAULTS = (
    InvalidDicomError,
    BytesLengthException,
    EOFError,
    ValueError,
    TypeError,
    KeyError,
    IndexError,
    AttributeError,
    NotImplementedError,
    RecursionError,
    struct.error,
    zlib.error,
)
"""What pydicom raises on damaged files."""

_DEFLATED = b"1.2.840.10008.1.2.1.99"
_PREAMBLE = 128
_FIRST_GROUPS = (b"\x02\x00", b"\x08\x00")


@contextmanager
def quiet() -> Iterator[None]:
    """Keep pydicom from warning and logging: its texts quote values, names among them."""
    logger = logging.getLogger("pydicom")
    disabled, logger.disabled = logger.disabled, True
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        logger.disabled = disabled


def parsed(path: Path, tags: Sequence[str]) -> Any | None:
    """The data set of a DICOM file with these tags alone; None if it is no DICOM file.

    To be called, and its values to be looked at, inside `quiet`.

    Raises
    ------
    FormatError
        If the file as a whole is deflated, which would unpack without bound.
    """
    with path.open("rb") as file:
        start = file.read(4096)
    bare = start[:2] in _FIRST_GROUPS and start[2:4] != b"\0\0"
    if start[_PREAMBLE : _PREAMBLE + 4] != b"DICM" and not bare:
        return None
    if _DEFLATED in start:
        raise FormatError("is a deflated DICOM file: export it without compression")
    return pydicom.dcmread(
        path,
        force=bare,
        stop_before_pixels="PixelData" not in tags,
        specific_tags=list(tags),
    )
