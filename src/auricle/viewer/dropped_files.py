"""Files dropped on the page at once: they come in one run of bytes and become a folder again."""

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import BinaryIO

from auricle.errors import FormatError, InputError
from auricle.viewer.file_names import plain_name

MOST_FILES = 50_000
"""Files dropped at once; a large export of a mapping system has some ten thousand."""
_LONGEST_LIST = 16 * 1024**2
_BLOCK = 1024**2


def unpacked(packed: Path, folder: Path) -> Path:
    r"""Write the files of a drop below a folder of their own.

    The first line of `packed` is a JSON list of ``[path, bytes]``, one a file; their contents
    follow, one after the other.

    Parameters
    ----------
    packed
        As the page sent it.
    folder
        Where to; it must not be there yet.

    Returns
    -------
    Path
        The folder that was dropped, if all lies in one, or else `folder`.

    Raises
    ------
    FormatError
        If the list and what follows it do not fit.
    InputError
        If there is no file, too many, or two of one name.

    Examples
    --------
    >>> import tempfile
    >>> place = Path(tempfile.mkdtemp())
    >>> _ = (place / "packed").write_bytes(b'[["ct/a.dcm", 2], ["ct/b.dcm", 1]]\nAAB')
    >>> found = unpacked(place / "packed", place / "files")
    >>> found.name, (found / "a.dcm").read_text()
    ('ct', 'AA')
    """
    with packed.open("rb") as file:
        entries = _entries(file)
        if sum(size for _, size in entries) != packed.stat().st_size - file.tell():
            raise FormatError("the dropped files did not come whole: drop them again")
        folder.mkdir()
        for parts, size in entries:
            place = folder.joinpath(*parts)
            place.parent.mkdir(parents=True, exist_ok=True)
            with place.open("xb") as to:
                for block in _blocks(file, size):
                    to.write(block)
    first = {parts[0] for parts, _ in entries}
    inside = all(len(parts) > 1 for parts, _ in entries) and len(first) == 1
    return folder / first.pop() if inside else folder


def _entries(file: BinaryIO) -> list[tuple[tuple[str, ...], int]]:
    """Parts of the path, safe to write, and size of each file."""
    try:
        listed = json.loads(file.readline(_LONGEST_LIST))
        entries = [(_parts(path), int(size)) for path, size in listed]
    except (ValueError, TypeError) as fault:
        raise FormatError("the list of dropped files is damaged: drop them again") from fault
    if not entries or len(entries) > MOST_FILES:
        raise InputError(f"{len(entries)} files: drop 1 to {MOST_FILES:,}")
    if any(size < 0 for _, size in entries):
        raise FormatError("the list of dropped files is damaged: drop them again")
    _refuse_clashes([parts for parts, _ in entries])
    return entries


def _parts(path: str) -> tuple[str, ...]:
    return tuple(plain_name(part) for part in path.split("/") if part)


def _refuse_clashes(paths: Sequence[tuple[str, ...]]) -> None:
    """Refuse two files of one name, and a file where another's folder must be."""
    folders = {parts[:depth] for parts in paths for depth in range(1, len(parts))}
    if not all(paths) or len(set(paths)) < len(paths) or folders & set(paths):
        raise InputError("two of the files have one name: drop one case at a time")


def _blocks(file: BinaryIO, size: int) -> Iterator[bytes]:
    while size:
        block = file.read(min(size, _BLOCK))
        if not block:
            raise FormatError("the dropped files did not come whole: drop them again")
        size -= len(block)
        yield block
