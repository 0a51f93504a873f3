"""Exports of mapping systems: which inputs are one, how one is read, and what it is known by."""

import hashlib
from pathlib import Path

from auricle.electroanatomy.points_csv import PointTable, read_points_csv
from auricle.electroanatomy.reading import read_study
from auricle.electroanatomy.study import ElectroanatomicStudy
from auricle.errors import InputError
from auricle.study.result import Source

TABLES = (".csv", ".txt")
"""Suffixes of tables of points."""
ARCHIVES = (".zip", ".mat")
"""Suffixes of files that hold a study."""
_BLOCK = 1024**2


def is_export(path: Path) -> bool:
    """Whether a path is a vendor's study or a table of points, and not a bare surface.

    >>> is_export(Path("export.zip")), is_export(Path("points.csv")), is_export(Path("la.vtp"))
    (True, True, False)
    """
    return path.is_dir() or path.suffix.lower() in (*TABLES, *ARCHIVES)


def read_export(
    path: Path, *, table: PointTable | None = None, signals: bool = True, all_channels: bool = False
) -> ElectroanatomicStudy:
    """Read a study, or a table of points whose columns are named.

    Parameters
    ----------
    path
        The export.
    table
        How a table is written; for tables only.
    signals, all_channels
        As `read_study`.

    Raises
    ------
    InputError
        If a table comes without its columns, or columns with a study.
    FormatError
        As `read_study` and `read_points_csv`.
    """
    is_table = path.suffix.lower() in TABLES and not path.is_dir()
    if is_table and table is None:
        raise InputError(
            f"{path}: the columns of a table are not guessed: name them, as in "
            "--column position=x,y,z:mm --column local_activation_time=LAT:ms"
        )
    if not is_table and table is not None:
        raise InputError(f"{path}: columns are named for tables only: leave --column out")
    if table is not None and is_table:
        return ElectroanatomicStudy("CSV", (read_points_csv(path, table),))
    return read_study(path, signals=signals, all_channels=all_channels)


def export_source(path: Path, system: str) -> Source:
    """What an export is known by: its system, its size and SHA-256; never its name.

    People name exports after patients. Of a folder the files are taken in the order of their
    paths, which enter too.
    """
    if path.is_file():
        with path.open("rb") as file:
            digest = hashlib.file_digest(file, "sha256")
        return Source(f"{system} export", path.stat().st_size, digest.hexdigest())
    whole = hashlib.sha256()
    size = 0
    for place in sorted(place for place in path.rglob("*") if place.is_file()):
        whole.update(place.relative_to(path).as_posix().encode() + b"\0")
        with place.open("rb") as file:
            while block := file.read(_BLOCK):
                whole.update(block)
                size += len(block)
    return Source(f"{system} export", size, whole.hexdigest())
