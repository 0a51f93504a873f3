"""CARTO 3 exports: a study's XML and, by names made from its maps', everything else."""

from pathlib import PurePosixPath

from auricle.electroanatomy.formats.carto_map import CartoExport, read_carto_map
from auricle.electroanatomy.formats.export_files import ExportFiles
from auricle.electroanatomy.formats.omissions import Omissions
from auricle.electroanatomy.formats.plain_xml import parse_xml
from auricle.electroanatomy.study import ElectroanatomicStudy
from auricle.errors import FormatError
from auricle.surface.formats.header import damaged

SYSTEM = "CARTO 3"
_STUDY_START = b"<Study"
_SNIFFED = 2048
_KINDS = (
    ("_electrode_positions", "catheter electrode files"),
    ("eleclectrode_positions", "catheter electrode files"),
    ("_sensor_positions", "catheter sensor files"),
    ("contactforceinrf_", "ablation force files"),
    ("rf_", "ablation files"),
    ("visitagexport/", "VisiTag files"),
)


def study_file(files: ExportFiles) -> str | None:
    """Name of the study's XML, None if this is no CARTO 3 export.

    Raises
    ------
    FormatError
        If there are several.
    """
    candidates = [
        name
        for name in files.names
        if name.lower().endswith(".xml") and not name.lower().endswith("_export.xml")
    ]
    found = [name for name in candidates if _STUDY_START in files.start(name, _SNIFFED)]
    if len(found) > 1:
        raise FormatError(f"holds {len(found)} studies: give one of them")
    return found[0] if found else None


def read_carto(
    files: ExportFiles, place: str, *, signals: bool = True, all_channels: bool = False
) -> ElectroanatomicStudy:
    """Read every map of a study whose XML is the file `place`.

    Parameters
    ----------
    files
        The export.
    place
        As `study_file` found it.
    signals
        Read electrograms as well.
    all_channels
        Keep every channel of them, not only mapping and reference.

    Raises
    ------
    FormatError
        If a file that is there is damaged; files that are not are counted in the remarks.
    """
    export = CartoExport(files, PurePosixPath(place).parent, signals, all_channels)
    export.used.add(place)
    root = parse_xml(files.read(place), where="the study's XML")
    listed = root.find("Maps")
    if listed is None:
        raise damaged("lists no maps in the study's XML")
    elements = listed.findall("Map")
    if listed.get("Count", str(len(elements))).strip() != str(len(elements)):
        raise damaged(f"announces another number of maps than the {len(elements)} it lists")
    maps = tuple(read_carto_map(export, element, k) for k, element in enumerate(elements, start=1))
    return ElectroanatomicStudy(SYSTEM, maps, _left_out(export))


def _left_out(export: CartoExport) -> tuple[str, ...]:
    """Files nobody asked for, by kind."""
    omissions = Omissions()
    unread = [] if not export.signals else export.files.names
    for name in unread:
        if name in export.used:
            continue
        relative = name.lower().removeprefix(f"{export.folder.as_posix()}/".lower())
        kinds = (what for part, what in _KINDS if _is_of(relative, part))
        omissions.add(f"{next(kinds, 'other files')} not read")
    return omissions.remarks


def _is_of(name: str, part: str) -> bool:
    return part in name if part.startswith(("_", "eleclectrode")) else name.startswith(part)
