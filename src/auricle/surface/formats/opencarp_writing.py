"""openCARP's pair of text files, and one file a field beside it."""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from auricle.arrays import Integers
from auricle.errors import OutputError
from auricle.surface.field import FieldMap
from auricle.surface.formats.opencarp import MICROMETRES_PER_MM
from auricle.surface.mesh import Mesh

_SAFE_NAME = re.compile(r"\w[\w.+-]*")


def opencarp_bytes(
    path: Path, mesh: Mesh, fields: Sequence[FieldMap], *, tags: Integers | None
) -> dict[Path, bytes]:
    """Contents by file: ``STEM_NAME.dat`` a field, ``.elem`` with `tags` or 0, ``.pts``.

    Positions are written in µm to 1e-6, values with as many digits as they take.

    Raises
    ------
    OutputError
        If a field has several components, or a name that cannot be part of a file's name.
    """
    contents = {_field_path(path, field): _lines(field.values.tolist()) for field in fields}
    labels = np.zeros(mesh.n_faces, np.int64) if tags is None else tags
    elements = (
        f"Tr {a} {b} {c} {tag}" for a, b, c, tag in np.column_stack([mesh.faces, labels]).tolist()
    )
    positions = (
        f"{x:.6f} {y:.6f} {z:.6f}" for x, y, z in (mesh.vertices * MICROMETRES_PER_MM).tolist()
    )
    pair = {".pts": path.with_suffix(".pts"), ".elem": path.with_suffix(".elem")}
    pair[path.suffix.lower()] = path
    contents[pair[".elem"]] = _lines([mesh.n_faces, *elements])
    contents[pair[".pts"]] = _lines([mesh.n_vertices, *positions])
    return contents


def _field_path(path: Path, field: FieldMap) -> Path:
    if field.values.ndim > 1:
        raise OutputError(
            f"field {field.name!r} has several components, an openCARP .dat file one: write .vtp"
        )
    if _SAFE_NAME.fullmatch(field.name) is None:
        raise OutputError(f"field {field.name!r} cannot name a file: rename it or write .vtp")
    return path.with_name(f"{path.stem}_{field.name}.dat")


def _lines(lines: Sequence[object]) -> bytes:
    return "".join(f"{line}\n" for line in lines).encode()
