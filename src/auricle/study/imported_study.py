"""Import: a vendor's study as plain files anyone can read, and what of it was left out."""

import math
from pathlib import Path
from typing import Any

import numpy as np

from auricle.atomic import write_text
from auricle.electroanatomy.points import UNITS, MappingPoints
from auricle.electroanatomy.points_writing import write_points_csv
from auricle.electroanatomy.study import ElectroanatomicMap, ElectroanatomicStudy
from auricle.errors import SurfaceError
from auricle.progress import Progress, silent
from auricle.study.electrogram_archive import write_electrograms
from auricle.study.result import Source
from auricle.study.sampling_store import NOTICE
from auricle.study.store import json_text
from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh
from auricle.surface.soup import TriangleSoup
from auricle.surface.writing import write_surface


def write_study(
    study: ElectroanatomicStudy, folder: Path, *, source: Source, progress: Progress = silent
) -> dict[str, Any]:
    """Write every map into a folder of its own and, last, ``summary.json``; returns the latter.

    ``map_N/surface.vtp`` holds the vertices as the vendor numbers them and its values at them,
    ``map_N/points.csv`` the mapping points, ``map_N/electrograms.npz`` and ``.json`` the signals.
    What a map lacks has no file.

    Parameters
    ----------
    study
        As read.
    folder
        Where to.
    source
        What the export is known by.
    progress
        Told the number of maps written.

    Raises
    ------
    OutputError
        If the folder cannot be written.
    """
    maps = []
    for number, one in enumerate(study.maps, start=1):
        progress("write maps", number - 1, len(study.maps))
        maps.append(_written(one, folder / f"map_{number}", number))
    progress("write maps", len(study.maps), len(study.maps))
    document = {
        "format": "auricle study 1",
        "notice": NOTICE,
        "system": study.system,
        "n_bytes": source.n_bytes,
        "sha256": source.sha256,
        "left_out": list(study.remarks),
        "maps": maps,
    }
    write_text(folder / "summary.json", json_text(document))
    return document


def drawable(soup: TriangleSoup) -> tuple[Mesh | None, str]:
    """The triangles of a soup that are triangles, vertices as they are numbered, and a remark.

    None if none is left or a position is missing; the remark is empty if nothing was left out.
    """
    faces = soup.faces
    inside = ((faces >= 0) & (faces < len(soup.vertices))).all(axis=1)
    sound = inside & (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    left = f"triangles that are none left out: {int((~sound).sum()):,}" if not sound.all() else ""
    try:
        return Mesh(soup.vertices, faces[sound]), left
    except SurfaceError as fault:
        return None, f"surface left out: {fault}"


def _written(one: ElectroanatomicMap, folder: Path, number: int) -> dict[str, Any]:
    files, remarks = [], list(one.remarks)
    surface: dict[str, Any] | None = None
    if one.surface is not None:
        mesh, left = drawable(one.surface)
        remarks += [left] if left else []
        if mesh is not None:
            fields = _fields(mesh, one.surface)
            write_surface(folder / "surface.vtp", mesh, fields, space=one.space)
            files.append("surface.vtp")
            surface = _surface_document(mesh, fields)
    if len(one.points):
        write_points_csv(folder / "points.csv", one.points)
        files.append("points.csv")
    if one.electrograms:
        write_electrograms(folder, one)
        files += ["electrograms.npz", "electrograms.json"]
    return {
        "folder": f"map_{number}" if files else None,
        "name": one.name,
        "files": files,
        "space": one.space,
        "cycle_length_ms": _finite(one.cycle_length),
        "window_of_interest_ms": [_finite(edge) for edge in one.window_of_interest],
        "surface": surface,
        "points": _points_document(one.points),
        "n_electrograms": len(one.electrograms),
        "left_out": remarks,
    }


def _fields(mesh: Mesh, soup: TriangleSoup) -> list[FieldMap]:
    return [
        FieldMap(mesh, values, name, soup.units.get(name, ""))
        for name, values in soup.point_fields.items()
    ]


def _surface_document(mesh: Mesh, fields: list[FieldMap]) -> dict[str, Any]:
    return {
        "n_vertices": mesh.n_vertices,
        "n_faces": mesh.n_faces,
        "area_mm2": mesh.area,
        "fields": [
            {"name": each.name, "unit": each.unit, "n_values": int(each.sampled.sum())}
            for each in fields
        ],
    }


def _points_document(points: MappingPoints) -> dict[str, Any]:
    return {
        "n_points": len(points),
        "n_included": int(points.included.sum()),
        "n_projected": int(np.isfinite(points.projected_positions).all(axis=1).sum()),
        "values": [
            {
                "name": name,
                "unit": UNITS[name],
                "n_values": int(np.isfinite(getattr(points, name)).sum()),
            }
            for name in points.recorded
        ],
    }


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
