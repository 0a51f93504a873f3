"""openCARP's ``.igb``: a header of 1,024 bytes of text, then numbers, space fastest.

Format after the openCARP user's manual. A word's type and byte order are the header's ``type``
and ``systeme``; ``facteur`` and ``zero`` scale: value = stored · facteur + zero.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from auricle.arrays import Floats
from auricle.electroanatomy.formats.number_tables import number
from auricle.errors import FormatError
from auricle.surface.formats.header import count_of, damaged, require_bytes, within_limits

_HEADER_BYTES = 1024
_TYPES = {"byte": "u1", "char": "i1", "short": "i2", "int": "i4", "float": "f4", "double": "f8"}
_ORDERS = {"little_endian": "<", "big_endian": ">"}


@dataclass(frozen=True, eq=False)
class IgbSeries:
    """Values of shape (t, n), one row a moment, and ms from one to the next (NaN: not stated)."""

    values: Floats
    interval: float


def read_igb(path: Path) -> IgbSeries:
    """Read a series of fields, or of signals, in float64.

    Raises
    ------
    FormatError
        If the header lacks what is needed, or the file has another size than it says; the message
        begins with the path.
    """
    try:
        within_limits(path)
        return _series(path.read_bytes())
    except OSError as fault:
        raise FormatError(f"{path}: cannot be read: check the place") from fault
    except FormatError as fault:
        raise FormatError(f"{path}: {fault}") from fault


def _series(content: bytes) -> IgbSeries:
    words = content[:_HEADER_BYTES].decode("latin-1").replace("\x00", " ").split()
    about = dict(word.split(":", 1) for word in words if ":" in word)
    if about.get("type") not in _TYPES or about.get("systeme") not in _ORDERS:
        raise damaged("has no IGB header, or one of a type of numbers that is not known")
    sizes = [count_of(about.get(name, "1"), f"values along {name}") for name in "xyz"]
    moments = count_of(about.get("t", "1"), "moments")
    kind = np.dtype(_ORDERS[about["systeme"]] + _TYPES[about["type"]])
    needed = math.prod(sizes) * moments * kind.itemsize
    require_bytes("its values", needed=needed, left=len(content) - _HEADER_BYTES)
    if len(content) - _HEADER_BYTES > needed:
        raise damaged("goes on after its values")
    stored = np.frombuffer(content, kind, offset=_HEADER_BYTES).astype(np.float64)
    factor, zero = (
        number(about.get(name, default), where="its header")
        for name, default in (("facteur", "1"), ("zero", "0"))
    )
    values = (stored * factor + zero).reshape(moments, math.prod(sizes))
    interval = number(about["inc_t"], where="its header") if "inc_t" in about else math.nan
    return IgbSeries(values, interval)
