"""DICOM folders: every header audited, one series chosen, then its pixels read."""

import os
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from auricle.errors import FormatError
from auricle.foreign import printable
from auricle.imaging.dicom_geometry import series_spacing, stack_affine
from auricle.imaging.dicom_header import slice_header
from auricle.imaging.dicom_pixels import read_slices
from auricle.imaging.dicom_series import Series, sort_into_series
from auricle.imaging.dicom_slice import SliceHeader
from auricle.imaging.image_files import is_image_file
from auricle.imaging.volume import Volume
from auricle.progress import Progress, silent

_MOST_FILES = 100_000
_MOST_NAMED = 5


@dataclass(frozen=True)
class SeriesSummary:
    """What tells one series of a folder from the next; nothing of the patient.

    Attributes
    ----------
    number
        What ``--series`` takes, from 1.
    kind
        How the images came about, with the kernel: ``CT original axial B26f``.
    slices
        How many.
    shape
        Columns and rows.
    spacing
        Distance of columns, rows and slices, mm, before any check.
    phase
        Which moment of the heart's cycle, or which run; empty if nothing tells.
    """

    number: int
    kind: str
    slices: int
    shape: tuple[int, int]
    spacing: tuple[float, float, float]
    phase: str

    def __str__(self) -> str:
        apart = "×".join(f"{length:.3g}" for length in self.spacing)
        words = f"{self.kind}, {self.slices} slices {self.shape[0]}×{self.shape[1]}, {apart} mm"
        return f"{words}, {self.phase}" if self.phase else words


@dataclass(frozen=True)
class _Folder:
    series: tuple[Series, ...]
    set_aside: Counter[str]


def list_series(folder: Path, *, progress: Progress = silent) -> tuple[SeriesSummary, ...]:
    """What CT series a folder and those in it hold, numbered as ``--series`` counts them.

    Raises
    ------
    FormatError
        If a slice is damaged.
    """
    return _summaries(_scan(_files_under(folder), progress).series)


def read_dicom(path: Path, *, series: int | None = None, progress: Progress = silent) -> Volume:
    """Read one CT series from a folder, or the series one of its files belongs to.

    Parameters
    ----------
    path
        A folder or its DICOMDIR, searched with those in it, or one slice, for the series it
        belongs to among the files beside it.
    series
        Number of the series in the listing, from 1; needed where there are several.
    progress
        Told how far the headers and the slices are.

    Raises
    ------
    FormatError
        If there is no CT, several series and none chosen, or the one chosen fails the audit.
    """
    if path.name.upper() == "DICOMDIR":
        path = path.parent
    alone = path.is_file()
    found = _scan(_files_beside(path) if alone else _files_under(path), progress)
    if not found.series:
        raise _nothing(path, found.set_aside)
    chosen, others = _chosen(found.series, series, path if alone else None)
    affine, remarks = stack_affine(chosen)
    voxels, more = read_slices(chosen.slices, progress=progress)
    return Volume(voxels, affine, _set_aside(found.set_aside, others) + remarks + more)


def _files_under(folder: Path) -> list[Path]:
    files: list[Path] = []
    for place, folders, names in os.walk(folder, onerror=_unreadable):
        folders.sort()
        files += [Path(place) / name for name in sorted(names) if not name.startswith(".")]
        if len(files) > _MOST_FILES:
            raise FormatError(f"holds more than {_MOST_FILES:,} files: give the folder of one scan")
    return files


def _unreadable(fault: OSError) -> None:
    """A folder that cannot be listed could hide slices."""
    raise fault


def _files_beside(file: Path) -> list[Path]:
    if isinstance(slice_header(file), str):
        return [file]
    return sorted(place for place in file.parent.iterdir() if place.is_file())


def _scan(files: Sequence[Path], progress: Progress) -> _Folder:
    slices: list[SliceHeader] = []
    set_aside: Counter[str] = Counter()
    for k, file in enumerate(files):
        header = slice_header(file) if file.is_file() else "no DICOM image"
        if isinstance(header, str):
            set_aside[header] += 1
        else:
            slices.append(header)
        progress("reading headers", k + 1, len(files))
    return _Folder(tuple(sort_into_series(slices)), set_aside)


def _chosen(
    found: tuple[Series, ...], number: int | None, member: Path | None
) -> tuple[Series, int]:
    """The series asked for, or the only one of several slices; how many slices of others are left.

    A lone slice beside a stack is no rival to it.
    """
    if number is not None:
        if not 1 <= number <= len(found):
            raise FormatError(f"has no series {number}: {_listing(found)}")
        return found[number - 1], 0
    if member is not None:
        found = tuple(one for one in found if any(h.path == member for h in one.slices)) or found
    stacks = [one for one in found if len(one.slices) > 1] or list(found)
    if len(stacks) > 1:
        raise FormatError(f"holds {_listing(found)}")
    return stacks[0], sum(len(one.slices) for one in found) - len(stacks[0].slices)


def _summaries(found: Sequence[Series]) -> tuple[SeriesSummary, ...]:
    return tuple(
        SeriesSummary(
            number=k + 1,
            kind=f"CT {one.slices[0].kind}".strip(),
            slices=len(one.slices),
            shape=(one.slices[0].shape[1], one.slices[0].shape[0]),
            spacing=series_spacing(one),
            phase=one.phase,
        )
        for k, one in enumerate(found)
    )


def _listing(found: Sequence[Series]) -> str:
    lines = "; ".join(f"{one.number}: {one}" for one in _summaries(found))
    return f"{len(found)} series, choose one with --series N: {lines}"


def _set_aside(kinds: Counter[str], others: int) -> tuple[str, ...]:
    counts = Counter(kinds)
    if others:
        counts["lone slice"] += others
    if not counts:
        return ()
    return (f"{counts.total()} files set aside: {_counted(counts)}",)


def _counted(kinds: Counter[str]) -> str:
    return ", ".join(f"{count} × {kind}" for kind, count in sorted(kinds.items()))


def _nothing(path: Path, kinds: Counter[str]) -> FormatError:
    if kinds["multi-frame image"]:
        return FormatError(
            "holds multi-frame (enhanced) CT, which is not read: "
            "export it as classic CT, one slice a file"
        )
    if path.is_file():
        return FormatError(f"is no slice of a CT ({_counted(kinds)}): give a CT series")
    images = [printable(p.name) for p in sorted(path.iterdir()) if is_image_file(p)]
    if images:
        names = ", ".join(images[:_MOST_NAMED])
        return FormatError(f"is a folder of image files, not of DICOM: give one of them ({names})")
    if not kinds:
        return FormatError("is an empty folder: give the folder of a CT series")
    return FormatError(
        f"holds no CT ({_counted(kinds)}): give the folder of a CT series (unpack a zip first)"
    )
