"""Electroanatomical studies read from the exports of mapping systems."""

from pathlib import Path

from auricle.electroanatomy.formats.carto import read_carto, study_file
from auricle.electroanatomy.formats.ensite import is_ensite, read_ensite
from auricle.electroanatomy.formats.export_files import open_export
from auricle.electroanatomy.formats.openep import read_openep
from auricle.electroanatomy.opencarp import read_opencarp_map
from auricle.electroanatomy.study import ElectroanatomicStudy
from auricle.errors import FormatError


def read_study(
    path: Path, *, signals: bool = True, all_channels: bool = False
) -> ElectroanatomicStudy:
    """Read all maps of an export, whatever system it came from.

    No name of a person or an institution, no date and no identifier leaves the reader; positions
    stay in the system's own axes (``space`` is ``unknown``).

    ====================== ======================================================================
    path                   read
    ====================== ======================================================================
    folder or zip, CARTO 3 The study's XML; of each map its ``.mesh`` with its colours, the points
                           of ``_car.txt`` (versions 4 to 6), ``Point_Export``, ``ContactForce``
                           and ``ECG_Export``
    folder or zip, EnSite  A folder a map: DIF XML; ``DxL_*.csv`` of Precision, ``Map_*.csv`` and
                           ``Wave_*.csv`` of X
    .mat                   OpenEP's ``userdata``, of MATLAB's version 5 to 7.3
    .pts .elem             openCARP's pair with ``.dat`` and ``.igb`` at its nodes
    ====================== ======================================================================

    Parameters
    ----------
    path
        The export.
    signals
        Read electrograms as well.
    all_channels
        Keep every channel of them, not only the mapping and reference ones.

    Raises
    ------
    FormatError
        If the export is of no known system, hostile or damaged; the message begins with the path.
    """
    try:
        return _read(path, signals=signals, all_channels=all_channels)
    except OSError as fault:
        reason = fault.strerror or str(fault)
        shown = _printable(path)
        raise FormatError(f"{shown}: cannot be read ({reason}): check the place") from fault
    except FormatError as fault:
        shown = _printable(path)
        told = str(fault)
        raise FormatError(told if told.startswith(shown) else f"{shown}: {told}") from fault


def _read(path: Path, *, signals: bool, all_channels: bool) -> ElectroanatomicStudy:
    match path.suffix.lower():
        case ".mat":
            return read_openep(path, signals=signals)
        case ".pts" | ".elem":
            return read_opencarp_map(path)
    with open_export(path) as files:
        carto = study_file(files)
        if carto is not None:
            return read_carto(files, carto, signals=signals, all_channels=all_channels)
        if is_ensite(files):
            return read_ensite(files, signals=signals)
    raise FormatError(
        "is an export of no known system: give one of CARTO 3, EnSite, OpenEP or openCARP"
    )


def _printable(path: Path) -> str:
    return "".join(
        letter if letter.isprintable() else ascii(letter).strip("'\"") for letter in str(path)
    )
