"""The third-party parsers of surfaces, each run in a child process."""

import sys
import tempfile
from pathlib import Path

from auricle.isolation import run_child
from auricle.surface.formats.soup_archive import load_soup
from auricle.surface.soup import TriangleSoup

_SECONDS = 60.0
_BYTES_PER_SECOND = 500_000.0


def parse_isolated(kind: str, path: Path) -> tuple[TriangleSoup, int]:
    """Let the third-party parser of `kind`, a suffix, read `path` in a child process.

    Returns
    -------
    soup
        What it read.
    cells
        How many cells it saw.

    Raises
    ------
    FormatError
        If the parser refuses the file, crashes on it, or needs too much memory or time.
    """
    seconds = _SECONDS + path.stat().st_size / _BYTES_PER_SECOND
    with tempfile.TemporaryDirectory(prefix="auricle-", ignore_cleanup_errors=True) as folder:
        archive = Path(folder) / "soup.npz"
        module = [sys.executable, "-P", "-m", "auricle.surface.formats.child"]
        run_child([*module, kind, str(path.absolute()), str(archive)], seconds=seconds)
        return load_soup(archive)
