"""Opening: from any path auricle knows to what the page shows of it."""

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from auricle.electroanatomy.formats.carto import study_file
from auricle.electroanatomy.formats.ensite import is_ensite
from auricle.electroanatomy.formats.export_files import open_export
from auricle.electroanatomy.study import ElectroanatomicStudy
from auricle.errors import AuricleError, FormatError, InputError
from auricle.imaging.image_files import is_image_file
from auricle.imaging.recognition import is_volume
from auricle.progress import Progress, silent
from auricle.sampling.samples_file import read_samples
from auricle.study.exports import ARCHIVES, TABLES, export_source, is_export, read_export
from auricle.study.preparation import N_MODES, N_VERTICES, prepare_soup
from auricle.study.provenance import source_of
from auricle.study.result import Source
from auricle.surface.reading import READABLE, read_surface
from auricle.viewer.cohort_files import is_cohort
from auricle.viewer.cohort_session import cohort_session
from auricle.viewer.open_case import OpenCase, OpenStudy, Recording, opens, recordings_of
from auricle.viewer.volume_session import volume_session
from auricle.viewer.workspace import Workspace

_LARGEST_RESULT = 64 * 2**20
_VERTICES_A_MODE = 4
_SURFACES = ("surface.vtp", "map.vtp", "map_1.vtp")
"""Where the commands' results keep their surface."""


@dataclass(frozen=True)
class Detail:
    """How finely surfaces are shown: vertices to simplify to, harmonics to solve for."""

    n_vertices: int = N_VERTICES
    n_modes: int = N_MODES


@dataclass(frozen=True)
class Opened:
    """What a path became: a title that names nobody, and the parts of the workspace."""

    title: str
    parts: tuple[object, ...]


Opener = Callable[[Path, Detail, Progress], Opened]


def open_path(
    workspace: Workspace, path: Path, detail: Detail | None = None, *, progress: Progress = silent
) -> None:
    """Open a path in place of what was open; a fault leaves the workspace as it was.

    Parameters
    ----------
    workspace
        Where to.
    path
        A surface, a CT, a vendor's export, or a folder that a command wrote.
    detail
        How finely surfaces are shown.
    progress
        Told the stages.

    Raises
    ------
    InputError
        If it is nothing auricle reads, or cannot be used; the message begins with the path.
    SolverError
        If the harmonics miss their certificate.
    """
    if not path.exists():
        raise InputError(f"{path}: is not there: check the name")
    chosen = detail or Detail()
    try:
        opened = _opener(path)(path, chosen, progress)
    except AuricleError as fault:
        if not str(fault).startswith(str(path)):
            fault.args = (f"{path}: {fault}",)
        raise
    with workspace.lock:
        workspace.open(opened.title, (chosen, *opened.parts))


def _opener(path: Path) -> Opener:
    """What opens a path: a command's folder before a CT before an export before a surface."""
    if is_cohort(path):
        return _cohort
    if path.is_dir() and (path / "summary.json").is_file():
        return _imported
    if path.is_dir() and (path / "result.json").is_file():
        return _result
    if is_volume(path):
        return _volume
    if path.is_dir() and (alone := _only_case(path)):
        return partial(_alone, alone)
    if path.suffix.lower() in TABLES:
        raise InputError("a table of points: open their surface first, then load the table there")
    return _export if is_export(path) else _surface


def _only_case(folder: Path) -> Path | None:
    """The one surface, CT or study among loose files; None of an export, or if there is none.

    Raises
    ------
    InputError
        If there are several.
    """
    with open_export(folder) as files:
        if study_file(files) is not None or is_ensite(files):
            return None
    found = {
        each.with_suffix("") if each.suffix.lower() in (".pts", ".elem") else each: each
        for each in sorted(folder.iterdir())
        if each.suffix.lower() in (*READABLE, *ARCHIVES) or is_image_file(each)
    }
    if len(found) > 1:
        raise InputError(f"{len(found)} surfaces, CTs or studies: open one case at a time")
    return next(iter(found.values()), None)


def _alone(case: Path, _folder: Path, detail: Detail, progress: Progress) -> Opened:
    """The one case of a folder, under its own name."""
    return _opener(case)(case, detail, progress)


def _surface(path: Path, detail: Detail, progress: Progress) -> Opened:
    return Opened(path.name, (case_of_surface(path, path.name, detail, progress=progress),))


def case_of_surface(
    path: Path, name: str, detail: Detail | None = None, *, progress: Progress = silent
) -> OpenCase:
    """The case of a surface file.

    Raises
    ------
    InputError
        If the file or its surface cannot be used.
    """
    chosen = detail or Detail()
    progress("prepare surface", 0, 3)
    soup = read_surface(path)
    prepared = prepare_soup(
        soup,
        source_of(path),
        n_vertices=chosen.n_vertices,
        n_modes=_fitting(chosen.n_modes, len(soup.vertices)),
        progress=progress,
    )
    return OpenCase(name, prepared, remarks=prepared.remarks)


def _result(path: Path, detail: Detail, progress: Progress) -> Opened:
    """A folder that analyze, plan, reconstruct or segment wrote."""
    place = next((path / name for name in _SURFACES if (path / name).is_file()), None)
    if place is None:
        raise InputError("this result holds no surface: open the surface it was made from")
    case = case_of_surface(place, path.name, detail, progress=progress)
    samples = path / "samples.csv"
    if samples.is_file():
        case = replace(case, recordings=_recorded(path, samples))
    return Opened(path.name, (case,))


def _recorded(folder: Path, samples: Path) -> tuple[Recording, ...]:
    """The samples of a reconstruction, in the order they were given."""
    document = _document(folder / "result.json")
    parameters = document.get("parameters")
    found = parameters if isinstance(parameters, dict) else {}
    cycle = found.get("cycle_length_ms")
    read = read_samples(samples, value=str(found.get("value", "LAT")))
    return (Recording(read, float(cycle) if isinstance(cycle, int | float) else None),)


def _document(place: Path) -> dict[str, object]:
    if place.stat().st_size > _LARGEST_RESULT:
        raise FormatError(f"{place.name} is too large to be a result of auricle: check the folder")
    try:
        found = json.loads(place.read_text(encoding="utf-8"))
    except (OSError, ValueError) as fault:
        raise FormatError(f"{place.name} is damaged ({fault}): make the result again") from fault
    return found if isinstance(found, dict) else {}


def _imported(path: Path, detail: Detail, progress: Progress) -> Opened:
    """A folder that import wrote: its first map with a surface."""
    place = next(iter(sorted(path.glob("map_*/surface.vtp"))), None)
    if place is None:
        raise InputError("this import holds no surface: open another")
    return Opened(path.name, (case_of_surface(place, path.name, detail, progress=progress),))


def _cohort(path: Path, _detail: Detail, progress: Progress) -> Opened:
    """The folder of a study of many cases."""
    return Opened(path.name, (cohort_session(path, progress=progress),))


def _volume(path: Path, _detail: Detail, progress: Progress) -> Opened:
    """A CT, to be segmented; people name scans after patients, so its own name is not shown."""
    session = volume_session(path, progress=progress)
    return Opened(session.source.name, (session,))


def _export(path: Path, detail: Detail, progress: Progress) -> Opened:
    """A vendor's export: of the maps with a surface that of most points; others to choose from."""
    progress("read export", 0, 1)
    study = read_export(path, signals=False)
    source = export_source(path, study.system)
    progress("read export", 1, 1)
    numbers = [number for number, one in enumerate(study.maps, start=1) if opens(one)]
    if not numbers:
        raise InputError("no map of this export has a surface: export one with its mesh")
    fullest = max(numbers, key=lambda number: len(study.maps[number - 1].points))
    parts = chosen_map(study, source, fullest, detail, progress=progress)
    return Opened(source.name, parts)


def chosen_map(
    study: ElectroanatomicStudy,
    source: Source,
    number: int,
    detail: Detail | None = None,
    *,
    progress: Progress = silent,
) -> tuple[OpenCase, OpenStudy]:
    """The case of one map of an export, and the export with it chosen.

    Raises
    ------
    InputError
        If there is no such map, or its surface cannot be used.
    """
    if not 1 <= number <= len(study.maps):
        raise InputError(f"map {number}: there are maps 1 to {len(study.maps)}")
    one, chosen = study.maps[number - 1], detail or Detail()
    if one.surface is None or not opens(one):
        raise InputError(f"map {number} has no surface: choose another")
    prepared = prepare_soup(
        one.surface,
        replace(source, name=f"{source.name}, {one.name}"),
        n_vertices=chosen.n_vertices,
        n_modes=_fitting(chosen.n_modes, len(one.surface.vertices)),
        progress=progress,
    )
    remarks = (*study.remarks, *one.remarks, *prepared.remarks)
    case = OpenCase(one.name, prepared, recordings_of(one), remarks)
    return case, OpenStudy(study, source, number)


def _fitting(n_modes: int, n_vertices: int) -> int:
    """As many harmonics as wanted, or as a surface of so many vertices carries."""
    return max(min(n_modes, n_vertices // _VERTICES_A_MODE), 2)
