"""Files that are whole or absent: written beside their place, flushed, then moved into it."""

import os
import tempfile
from collections.abc import Callable
from pathlib import Path

from auricle.errors import OutputError


def write_whole(path: Path, write: Callable[[Path], None]) -> None:
    """Let `write` fill a temporary file, then move it to `path` in one step.

    A crash, a full disk or a kill leaves the old file or none, never half of one.

    Raises
    ------
    OutputError
        If the folder cannot be made or written, or the disk is full.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(
            prefix=f".{path.stem}.", suffix=path.suffix, dir=path.parent
        )
        os.close(handle)
    except OSError as fault:
        raise _cannot(path, fault) from fault
    temporary = Path(name)
    try:
        write(temporary)
        with temporary.open("rb+") as file:
            os.fsync(file.fileno())
        temporary.chmod(0o666 & ~_umask())
        temporary.replace(path)
    except OSError as fault:
        raise _cannot(path, fault) from fault
    finally:
        temporary.unlink(missing_ok=True)


def write_bytes(path: Path, content: bytes) -> None:
    """Write `content`, whole or not at all."""

    def fill(place: Path) -> None:
        place.write_bytes(content)

    write_whole(path, fill)


def write_text(path: Path, text: str) -> None:
    """Write `text` as UTF-8 with bare line feeds, whole or not at all."""
    write_bytes(path, text.encode())


def _umask() -> int:
    mask = os.umask(0o077)
    os.umask(mask)
    return mask


def _cannot(path: Path, fault: OSError) -> OutputError:
    reason = fault.strerror or str(fault)
    return OutputError(f"{path}: cannot be written ({reason}): choose another place or free space")
