"""EnSite Precision exports written: a folder a map, DIF XML and ``DxL_*.csv``."""

import math
from collections.abc import Callable
from pathlib import Path
from xml.etree.ElementTree import Comment, Element, SubElement, tostring

import numpy as np

from auricle.arrays import Floats
from auricle.atomic import write_bytes
from auricle.electroanatomy.electrogram import MILLISECONDS, Electrogram
from auricle.electroanatomy.study import ElectroanatomicMap, ElectroanatomicStudy
from auricle.errors import OutputError
from auricle.surface.soup import TriangleSoup

_COMMENTS = {
    "local_activation_time": "Data values at each vertex of DxL map LAT Isochronal",
    "bipolar_voltage": "Data values at each vertex of DxL map P-P Voltage",
}
_END_TIME = 100.0
"""s; when every segment ends, which only differences are taken of."""


def write_ensite(folder: Path, study: ElectroanatomicStudy, *, points_per_file: int = 200) -> None:
    """Write a study as an export of EnSite Precision, revision 5.2, is laid out.

    The files hold positions to 1e-4 mm, times to 1e-3 ms, voltages and electrograms to 1e-4 mV;
    the mapping bipole and the reference are written, unipoles have no place. Points without an
    electrogram are left out.

    Parameters
    ----------
    folder
        Where to; made if it is not there.
    study
        What to write.
    points_per_file
        Points a ``DxL_*.csv``.

    Raises
    ------
    OutputError
        If electrograms of one map differ in rate or length, or it cannot be written.
    """
    for number, one in enumerate(study.maps, start=1):
        place = folder / f"map {number}"
        if one.surface is not None:
            write_bytes(place / "DxLandmarkGeo.xml", _geometry(one.surface))
        rows = sorted(one.electrograms)
        shapes = {
            (signal.sampling_rate, len(signal.samples)) for signal in one.electrograms.values()
        }
        if len(shapes) > 1:
            raise OutputError(f"{folder}: electrograms differ in rate or length: choose some")
        starts = range(0, len(rows), points_per_file)
        for file, start in enumerate(starts, start=1):
            chosen = rows[start : start + points_per_file]
            content = _points(one, chosen, f"This is file {file} of {len(starts)} for map,map")
            write_bytes(place / f"DxL_{file}.csv", content)


def _geometry(soup: TriangleSoup) -> bytes:
    root = Element("DIF")
    SubElement(SubElement(root, "DIFHeader"), "Version").text = "SJM_DIF_5.0"
    volumes = SubElement(SubElement(root, "DIFBody"), "Volumes", number="1")
    volume = SubElement(volumes, "Volume", name="volume 1")
    _block(volume, "Vertices", [" ".join(f"{v:.4f}" for v in row) for row in soup.vertices])
    faces = (soup.faces + 1).tolist()
    _block(volume, "Polygons", [f"{a} {b} {c}" for a, b, c in faces])
    for name, comment in _COMMENTS.items():
        values = soup.point_fields.get(name)
        if values is not None:
            volume.append(Comment(comment))
            _block(volume, "Map_data", [f"{value:.4f}" for value in values])
    content: bytes = tostring(root, encoding="utf-8")
    return content


def _block(parent: Element, tag: str, lines: list[str]) -> None:
    SubElement(parent, tag, number=str(len(lines))).text = "\n" + "\n".join(lines) + "\n"


def _points(one: ElectroanatomicMap, rows: list[int], file: str) -> bytes:
    signals = [one.electrograms[row] for row in rows]
    rate, length = signals[0].sampling_rate, len(signals[0].samples)
    seconds = length / rate
    points = one.points.chosen(np.array(rows))
    table: dict[str, list[str]] = {
        "pt number": [str(number) for number in points.identifiers],
        "ref trace": [signal.reference for signal in signals],
        "rov trace": [signal.bipolar for signal in signals],
        **_axes("roving", points.positions),
        **_axes("surfPt", points.projected_positions),
        "utilized": [str(int(used)) for used in points.included],
        "peak2peak": _words(points.bipolar_voltage, 4),
        "end time": [f"{_END_TIME:.6f}"] * len(rows),
        "ref LAT": _times(signals, lambda signal: signal.reference_annotation, rate, seconds),
        "rov LAT": _times(signals, lambda signal: signal.map_annotation, rate, seconds),
    }
    lines = [
        "St. Jude Medical. File Revision : 5.2",
        "Export Data Element : DxL",
        f"Total number of data points (columns):, {len(rows)}",
        file,
        "Begin data",
        *(",".join([f"{name}:", *words]) for name, words in table.items()),
        f"Seg data len:,{seconds:.6f}",
        f"Exported seconds:,{seconds:.6f}",
        f"Sample rate:,{rate:.6f}",
        *_waveforms("rov trace", signals, [signal.bipolar for signal in signals]),
        *_waveforms("ref trace", signals, [signal.reference for signal in signals]),
        "FFT spectrum is available for FFT maps only",
        "EOF",
    ]
    return "".join(f"{line}\n" for line in lines).encode()


def _axes(name: str, positions: Floats) -> dict[str, list[str]]:
    return {f"{name} {axis}": _words(positions[:, k], 4) for k, axis in enumerate("xyz")}


def _words(values: Floats, digits: int) -> list[str]:
    return [f"{value:.{digits}f}" if math.isfinite(value) else "invalid" for value in values]


def _times(
    signals: list[Electrogram],
    mark: Callable[[Electrogram], float],
    rate: float,
    seconds: float,
) -> list[str]:
    """Moments of annotations on the clock of the file, s."""
    moments = np.array([_END_TIME - seconds + mark(signal) / rate for signal in signals])
    return _words(np.round(moments * MILLISECONDS, 3) / MILLISECONDS, 6)


def _waveforms(name: str, signals: list[Electrogram], channels: list[str]) -> list[str]:
    missing = np.full(len(signals[0].samples), np.nan)
    columns = [
        signal.channel(channel) if channel else missing
        for signal, channel in zip(signals, channels, strict=True)
    ]
    rows = np.column_stack(columns)
    samples = ("," + ",".join(f"{value:.4f}" for value in row) for row in rows)
    return [",".join([f"{name}:", *channels]), *samples, ""]
