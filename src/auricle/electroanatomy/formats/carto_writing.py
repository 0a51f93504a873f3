"""CARTO 3 exports written: study XML, meshes, points and electrograms, as CARTO lays them out."""

import math
from collections.abc import Iterator
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import numpy as np

from auricle.arrays import Floats
from auricle.atomic import write_bytes
from auricle.electroanatomy.electrogram import Electrogram
from auricle.electroanatomy.formats.carto_mesh import COLOURS, MISSING
from auricle.electroanatomy.formats.carto_signals import SAMPLING_RATE
from auricle.electroanatomy.points import MappingPoints
from auricle.electroanatomy.study import ElectroanatomicMap, ElectroanatomicStudy
from auricle.errors import OutputError
from auricle.surface.soup import TriangleSoup

GAIN = 0.003
"""mV of one unit of an electrogram file."""
VERSIONS = (4, 5, 6)
"""Versions of ``_car.txt`` that can be written."""
_UNDEFINED = "UNDEFINED"
_STUDY = "Study 1.xml"
_VALUES_BEFORE = ("unipolar_voltage", "bipolar_voltage", "local_activation_time", "impedance")
_MESH_HEAD = """#TriangulatedMeshVersion2.0
; written by auricle

[GeneralAttributes]
MeshID                 = -1
MeshName               =
NumVertex              = {vertices}
NumTriangle            = {triangles}
NumVertexColors        = {colours}
ColorsIDs              = {ids}
ColorsNames            = {names}
"""


def write_carto(
    folder: Path, study: ElectroanatomicStudy, *, version: int = 5, vertex_values: bool = True
) -> None:
    """Write a study as an export of CARTO 3 is laid out.

    Maps are called ``1-Map``, ``2-Map`` … The files hold positions of points to 1e-4 mm and of
    vertices to 1e-3 mm, values of points to 1e-3 and of vertices to 1e-5 of their unit,
    annotations to a sample, electrograms to half a unit of 0.003 mV; a missing role is
    ``UNDEFINED``.

    Parameters
    ----------
    folder
        Where to; made if it is not there.
    study
        What to write; electrograms at 1 kHz.
    version
        Of ``_car.txt``.
    vertex_values
        Write the colours of vertices, which exports of CARTO 7 lack.

    Raises
    ------
    OutputError
        If the version is another, an electrogram has another rate, or it cannot be written.
    """
    if version not in VERSIONS:
        raise OutputError(f"{folder}: version {version} of points: choose of {VERSIONS}")
    signals = (signal for one in study.maps for signal in one.electrograms.values())
    for signal in signals:
        if signal.sampling_rate != SAMPLING_RATE or not np.isfinite(signal.samples).all():
            raise OutputError(
                f"{folder}: CARTO's electrograms are at {SAMPLING_RATE:g} Hz without gaps: "
                "resample, and leave out channels with gaps"
            )
    write_bytes(folder / _STUDY, _study_xml(study))
    for number, one in enumerate(study.maps, start=1):
        name = f"{number}-Map"
        if one.surface is not None:
            content = _mesh(one.surface, vertex_values=vertex_values)
            write_bytes(folder / f"{name}.mesh", content)
        write_bytes(folder / f"{name}_car.txt", _car(name, one.points, version))
        for file, content in _point_files(name, one):
            write_bytes(folder / file, content)


def _study_xml(study: ElectroanatomicStudy) -> bytes:
    root = Element("Study", name="Study 1")
    SubElement(root, "Units", Distance="mm", Angle="radian")
    maps = SubElement(root, "Maps", Count=str(len(study.maps)))
    for number, one in enumerate(study.maps, start=1):
        name = f"{number}-Map"
        entry = SubElement(maps, "Map", Name=name, NumFiles="1", FileNames=f"{name}.mesh")
        points = SubElement(entry, "CartoPoints", Count=str(len(one.points)))
        for row, identifier in enumerate(one.points.identifiers):
            place = _triple(one.points.positions[row])
            point = SubElement(points, "Point", Id=str(identifier), Position3D=place)
            projected = one.points.projected_positions[row]
            if np.isfinite(projected).all():
                SubElement(point, "VirtualPoint", Position3D=_triple(projected))
    return _xml(root)


def _mesh(soup: TriangleSoup, *, vertex_values: bool) -> bytes:
    names = {name: written for written, (name, _) in reversed(COLOURS.items())}
    fields = soup.point_fields if vertex_values else {}
    colours = {names[name]: values for name, values in fields.items() if name in names}
    head = _MESH_HEAD.format(
        vertices=len(soup.vertices),
        triangles=len(soup.faces),
        colours=len(colours),
        ids="  ".join(map(str, range(len(colours)))),
        names="  ".join(colours),
    )
    normals = _unit_normals(soup)
    lines = [head, "[VerticesSection]"]
    lines += [f"{k} = {x:.3f} {y:.3f} {z:.3f} 0 0 0 0" for k, (x, y, z) in enumerate(soup.vertices)]
    lines += ["", "[TrianglesSection]"]
    lines += [
        f"{k} = {a} {b} {c} {n[0]:.5f} {n[1]:.5f} {n[2]:.5f} 0"
        for k, ((a, b, c), n) in enumerate(zip(soup.faces.tolist(), normals, strict=True))
    ]
    if colours:
        table = np.column_stack(list(colours.values()))
        rows = np.where(np.isfinite(table), table, MISSING)
        lines += ["", "[VerticesColorsSection]"]
        lines += [f"{k} = " + " ".join(f"{v:.5f}" for v in row) for k, row in enumerate(rows)]
    return _text(lines)


def _unit_normals(soup: TriangleSoup) -> Floats:
    corners = soup.vertices[soup.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.asarray(normals / np.where(lengths > 0, lengths, 1.0))


def _car(name: str, points: MappingPoints, version: int) -> bytes:
    rest = ["0", "-1", "1", "A", "0", "18027", "0"] + ["-10000"] * (2 * (version - 4))
    lines = [f"VERSION_{version}_0 {name}"]
    for row, identifier in enumerate(points.identifiers):
        place = [f"{v:.4f}" for v in points.positions[row]]
        values = [_value(getattr(points, column)[row]) for column in _VALUES_BEFORE]
        lines.append(
            "\t".join(["P", "0", str(identifier), "0", *place, "0", "0", "0", *values, *rest])
        )
    return _text(lines)


def _point_files(name: str, one: ElectroanatomicMap) -> Iterator[tuple[str, bytes]]:
    index = Element("Points", Map_Name=name)
    for row, identifier in enumerate(one.points.identifiers):
        signal = one.electrograms.get(row)
        if signal is None:
            continue
        stem = f"{name}_P{identifier}"
        SubElement(index, "Point", ID=str(identifier), File_Name=f"{stem}_Point_Export.xml")
        force = float(one.points.force[row])
        yield f"{stem}_Point_Export.xml", _point_export(stem, one.points, row, signal)
        yield f"{stem}_ECG_Export.txt", _signals(signal)
        if math.isfinite(force):
            yield f"{stem}_ContactForce.txt", _force(stem, force)
    yield f"{name}_Points_Export.xml", _xml(index)


def _point_export(stem: str, points: MappingPoints, row: int, signal: Electrogram) -> bytes:
    root = Element("Point", ID=str(points.identifiers[row]))
    reference = round(signal.reference_annotation)
    mapped = signal.map_annotation
    written = reference + MISSING if math.isnan(mapped) else mapped
    SubElement(
        root,
        "Annotations",
        StartTime="0",
        Reference_Annotation=str(reference),
        Map_Annotation=str(round(written)),
    )
    first, last = signal.window_of_interest
    SubElement(root, "WOI", From=f"{first:g}", To=f"{last:g}")
    SubElement(
        root,
        "Voltages",
        Unipolar=_value(points.unipolar_voltage[row]),
        Bipolar=_value(points.bipolar_voltage[row]),
    )
    SubElement(root, "ECG", FileName=f"{stem}_ECG_Export.txt")
    if math.isfinite(points.force[row]):
        SubElement(root, "ContactForce", FileName=f"{stem}_ContactForce.txt")
    return _xml(root)


def _signals(signal: Electrogram) -> bytes:
    lines = [
        "ECG_Export_4.0",
        f"Raw ECG to MV (gain) = {GAIN:.6f}",
        f"Unipolar Mapping Channel={signal.unipolar or _UNDEFINED} "
        f"Bipolar Mapping Channel={signal.bipolar or _UNDEFINED} "
        f"Reference Channel={signal.reference or _UNDEFINED}",
        "".join(f"{name}({k})".ljust(30) for k, name in enumerate(signal.channels, start=1)),
    ]
    counts = np.round(signal.samples / GAIN).astype(np.int64)
    lines += ["".join(str(value).ljust(30) for value in row) for row in counts.tolist()]
    return _text(lines)


def _force(stem: str, force: float) -> bytes:
    return _text(
        [
            f"{stem}_ContactForce.txt_2.0",
            "Rate=50\tNumber =1",
            "Mode=0",
            "Index\tTime\tTimestamp\tForceValue",
            f"0\t0\t0\t{force:.3f}",
        ]
    )


def _value(value: float) -> str:
    return f"{value:.3f}" if math.isfinite(value) else f"{MISSING:.0f}"


def _triple(place: Floats) -> str:
    return " ".join(f"{v:.4f}" for v in place)


def _xml(root: Element) -> bytes:
    indent(root)
    content: bytes = tostring(root, encoding="utf-8")
    return content + b"\r\n"


def _text(lines: list[str]) -> bytes:
    return "".join(f"{line}\n" for line in lines).replace("\n", "\r\n").encode()
