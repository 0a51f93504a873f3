"""What a surface file announces of itself, and the limits nobody may announce beyond."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

from auricle.errors import FormatError
from auricle.foreign import count_of as count_of
from auricle.foreign import damaged as damaged
from auricle.foreign import require_bytes as require_bytes
from auricle.foreign import shown as shown
from auricle.foreign import text_of

MOST_BYTES = 2 * 1024**3
MOST_VERTICES = 20_000_000
MOST_CELLS = 40_000_000

UNKNOWN_SPACE = "unknown"
_SPACE = re.compile(r"\bSPACE=(\w+)")
_UNIT = re.compile(r"\bUNITS=(.+)=(\S*)")


@dataclass(frozen=True)
class Header:
    """What a file promised before any library parsed it.

    Attributes
    ----------
    vertices
        Number of vertices the parser must find.
    cells
        Number of cells the parser must find (triangles, or polygons of any kind).
    space
        Axes as the file's comments name them, ``unknown`` where they do not.
    units
        Unit by field name, from the file's comments.
    remarks
        What the user should know of the way the file will be read.

    Raises
    ------
    FormatError
        If there are no vertices or no cells, or more than the limits.
    """

    vertices: int
    cells: int
    space: str = UNKNOWN_SPACE
    units: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    remarks: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for count, most, what in (
            (self.vertices, MOST_VERTICES, "vertices"),
            (self.cells, MOST_CELLS, "faces"),
        ):
            if not count:
                raise FormatError(f"holds no {what}: give a surface made of triangles")
            if count > most:
                raise FormatError(f"announces {count:,} {what}, the limit is {most:,}: simplify it")


def within_limits(path: Path, name: str = "it") -> int:
    """Size in bytes of a file, called `name` in the message if that is nothing or too much.

    Raises
    ------
    FormatError
        If it is.
    """
    size = path.stat().st_size
    if not size:
        raise FormatError(f"{name} is empty: export it again")
    if size > MOST_BYTES:
        raise FormatError(f"{name} has {size:,} bytes, the limit is {MOST_BYTES:,}: simplify it")
    return size


def space_in(comment: bytes | str) -> str:
    """Axes named in a comment, as 3D Slicer writes them; ``unknown`` if none are.

    Examples
    --------
    >>> space_in("3D Slicer output. SPACE=LPS")
    'LPS'
    """
    found = _SPACE.search(text_of(comment))
    return found[1].upper() if found else UNKNOWN_SPACE


def unit_in(comment: bytes | str) -> dict[str, str]:
    """Find the unit of a field in a comment as auricle writes it; empty if there is none.

    Examples
    --------
    >>> unit_in("UNITS=local_activation_time=ms")
    {'local_activation_time': 'ms'}
    """
    found = _UNIT.search(text_of(comment))
    return {found[1]: found[2]} if found else {}
