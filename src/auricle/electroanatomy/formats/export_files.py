"""The files of an export, in a folder or a zip archive, read one at a time within bounds."""

import re
import stat
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from typing import Protocol

from auricle.errors import FormatError
from auricle.surface.formats.header import damaged

MOST_MEMBERS = 200_000
MOST_TOTAL_BYTES = 32 * 1024**3
MOST_FILE_BYTES = 1024**3
MOST_RATIO = 200
_SMALL = 1024**2
_DEEPEST = 6
_ENCRYPTED = 0x1
_DRIVE = re.compile(r"[A-Za-z]:")


class ExportFiles(Protocol):
    """Files by their path within the export, parts separated by ``/``."""

    @property
    def names(self) -> tuple[str, ...]:
        """Every file, sorted."""

    def read(self, name: str) -> bytes:
        """Content of one of them."""

    def start(self, name: str, length: int) -> bytes:
        """First bytes of one of them."""


@contextmanager
def open_export(path: Path) -> Iterator[ExportFiles]:
    """Open a folder or a zip archive as it lies; nothing is unpacked on disk.

    Raises
    ------
    FormatError
        If there is no such place; the archive is damaged, encrypted or holds names that lead out
        of it, links, two files of one name, or more than the limits: members, bytes in all, bytes
        a file, and how often its packed size a file is (`MOST_RATIO`, from 1 MiB).
    """
    if path.is_dir():
        yield FolderFiles(path)
        return
    if not path.is_file():
        raise FormatError("there is no such file or folder: check the name")
    try:
        with zipfile.ZipFile(path) as archive:
            yield ZipFiles(archive)
    except (zipfile.BadZipFile, NotImplementedError, zlib.error, EOFError) as fault:
        raise damaged("is not a whole zip archive") from fault


class FolderFiles:
    """Regular files of a folder, down to six levels; links that lead out of it are refused."""

    def __init__(self, folder: Path) -> None:
        self._places: dict[str, Path] = {}
        root = folder.resolve()
        for place in _walk(folder, _DEEPEST):
            if not place.resolve().is_relative_to(root):
                raise FormatError("holds a link that leads out of the folder: remove it")
            self._places[place.relative_to(folder).as_posix()] = place
            if len(self._places) > MOST_MEMBERS:
                raise FormatError(f"holds more than {MOST_MEMBERS:,} files: give one study")

    @property
    def names(self) -> tuple[str, ...]:
        """Every file, sorted."""
        return tuple(sorted(self._places))

    def read(self, name: str) -> bytes:
        """Content of one file.

        Raises
        ------
        FormatError
            If it is larger than the limit.
        """
        _require_size(self._places[name].stat().st_size)
        return self._places[name].read_bytes()

    def start(self, name: str, length: int) -> bytes:
        """First bytes of one file."""
        with self._places[name].open("rb") as file:
            return file.read(length)


class ZipFiles:
    """Members of a zip archive, its directory checked before any of them is unpacked."""

    def __init__(self, archive: zipfile.ZipFile) -> None:
        self._archive = archive
        members = [member for member in archive.infolist() if not member.is_dir()]
        if len(members) > MOST_MEMBERS:
            raise FormatError(f"holds more than {MOST_MEMBERS:,} files: give one study")
        total = sum(member.file_size for member in members)
        if total > MOST_TOTAL_BYTES:
            raise FormatError(f"unpacks to {total:,} bytes, the limit is {MOST_TOTAL_BYTES:,}")
        for member in members:
            _require_harmless(member)
        self._members = {member.filename: member for member in members}
        if len(self._members) < len(members):
            raise damaged("holds two files of one name")

    @property
    def names(self) -> tuple[str, ...]:
        """Every file, sorted."""
        return tuple(sorted(self._members))

    def read(self, name: str) -> bytes:
        """Content of one member; its checksum is held against what was unpacked."""
        return self._archive.read(self._members[name])

    def start(self, name: str, length: int) -> bytes:
        """First bytes of one member."""
        with self._archive.open(self._members[name]) as file:
            return file.read(length)


def _walk(folder: Path, depth: int) -> Iterator[Path]:
    for place in sorted(folder.iterdir()):
        if place.is_dir():
            if depth > 1 and not place.is_symlink():
                yield from _walk(place, depth - 1)
        elif place.is_file():
            yield place


def _require_harmless(member: zipfile.ZipInfo) -> None:
    parts = PurePosixPath(member.filename).parts
    leads_out = ".." in parts or member.filename.startswith("/") or "\\" in member.filename
    if leads_out or _DRIVE.match(member.filename):
        raise FormatError("holds a name that leads out of the archive: do not use it")
    if stat.S_ISLNK(member.external_attr >> 16):
        raise FormatError("holds a link instead of a file: pack the files themselves")
    if member.flag_bits & _ENCRYPTED:
        raise FormatError("is encrypted: unpack it first and give the folder")
    _require_size(member.file_size)
    packed = max(member.compress_size, 1)
    if member.file_size > _SMALL and member.file_size > MOST_RATIO * packed:
        raise FormatError(
            f"holds a file packed {member.file_size // packed:,} times over, the limit is "
            f"{MOST_RATIO}: if it is genuine, unpack it first and give the folder"
        )


def _require_size(size: int) -> None:
    if size > MOST_FILE_BYTES:
        raise FormatError(
            f"holds a file of {size:,} bytes, the limit is {MOST_FILE_BYTES:,}: export less"
        )
