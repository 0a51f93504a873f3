"""The faults of image files, each told with the file's name in front."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from auricle.errors import FormatError, ImageError
from auricle.foreign import printable


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """Put ``path: `` in front of what goes wrong inside, on one printable line.

    Raises
    ------
    FormatError
        For every fault of the file, and where it is missing or cannot be read.
    """
    shown = printable(str(path))
    if not path.exists():
        raise FormatError(f"{shown}: there is no such file or folder: check the name")
    try:
        yield
    except OSError as fault:
        reason = fault.strerror or str(fault)
        raise FormatError(f"{shown}: cannot be read ({reason}): check the place") from fault
    except (FormatError, ImageError) as fault:
        raise FormatError(f"{shown}: {printable(str(fault))}") from fault
    except MemoryError as fault:
        raise FormatError(f"{shown}: needs more memory than there is: crop it first") from fault
