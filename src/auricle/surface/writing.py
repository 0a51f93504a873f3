"""Surfaces written to files, whole or not at all, the same bytes every time."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from auricle.arrays import Integers
from auricle.atomic import write_whole
from auricle.errors import OutputError
from auricle.surface.field import FieldMap
from auricle.surface.formats.header import UNKNOWN_SPACE
from auricle.surface.formats.opencarp_writing import opencarp_bytes
from auricle.surface.formats.ply_writing import ply_bytes
from auricle.surface.formats.stl_writing import stl_bytes
from auricle.surface.mesh import Mesh

WRITABLE = (".vtp", ".ply", ".stl", ".pts", ".elem")
"""Suffixes `write_surface` knows, in lower case."""
SPACES = ("LPS", "RAS", UNKNOWN_SPACE)
"""Axes a file can state."""


def write_surface(
    path: Path,
    mesh: Mesh,
    fields: Sequence[FieldMap] = (),
    *,
    space: str = UNKNOWN_SPACE,
    tags: Integers | None = None,
) -> None:
    """Write a surface and its fields in the format of the file's suffix.

    ========== =========================================== ========================= ============
    suffix     positions                                   fields                    tags, axes
    ========== =========================================== ========================= ============
    .vtp       float64, mm                                 float64, with units       both
    .ply       float64, mm                                 float64, with units       both
    .stl       float32, mm; vertices three a face          **dropped**               axes only
    .pts .elem text, µm to 1e-6; both files are written    scalars, ``STEM_NAME.dat`` tags only
    ========== =========================================== ========================= ============

    NaN survives. Files of fields that an earlier openCARP pair of this name left are not removed.

    Parameters
    ----------
    path
        Where to; of openCARP's pair either name.
    mesh
        The surface.
    fields
        Values at its vertices; names must differ.
    space
        What the positions' axes are, as the file will state: one of `SPACES`. Nothing is turned.
    tags
        A whole number a face, shape (f,), written as ``elemTag``; openCARP needs one and takes 0.

    Raises
    ------
    OutputError
        If the suffix is unknown, a field or the tags do not fit the mesh, a name cannot be
        written in this format, or the file cannot be written.
    """
    try:
        _require_fit(path, mesh, fields, space=space, tags=tags)
        contents = _contents(path, mesh, fields, space=space, tags=tags)
    except OutputError as fault:
        raise OutputError(f"{path}: {fault}") from fault
    for place, content in contents.items():
        write_whole(place, partial(_write_bytes, content=content))


def _require_fit(
    path: Path, mesh: Mesh, fields: Sequence[FieldMap], *, space: str, tags: Integers | None
) -> None:
    if path.suffix.lower() not in WRITABLE:
        raise OutputError(f"cannot be written by its suffix: choose {' '.join(WRITABLE)}")
    if space not in SPACES:
        raise OutputError(f"axes {space!r} are not known: choose {' '.join(SPACES)}")
    if tags is not None and tags.shape != (mesh.n_faces,):
        raise OutputError(f"tags have shape {tags.shape}: give one for {mesh.n_faces} faces")
    names = [field.name for field in fields]
    if len(set(names)) < len(names):
        raise OutputError(f"fields share a name among {names}: rename them")
    for field in fields:
        _require_field(mesh, field)


def _require_field(mesh: Mesh, field: FieldMap) -> None:
    if len(field.values) != mesh.n_vertices:
        raise OutputError(
            f"field {field.name!r} has {len(field.values)} values for {mesh.n_vertices} vertices: "
            "give a field of this mesh"
        )
    if not field.name or not (field.name + field.unit).isprintable():
        raise OutputError(f"field {field.name!r} has no printable name and unit: rename it")


def _contents(
    path: Path, mesh: Mesh, fields: Sequence[FieldMap], *, space: str, tags: Integers | None
) -> dict[Path, bytes]:
    """Bytes by file, in the order they are written in."""
    match path.suffix.lower():
        case ".stl":
            return {path: stl_bytes(mesh, space=space)}
        case ".ply":
            return {path: ply_bytes(mesh, fields, space=space, tags=tags)}
        case ".vtp":
            # VTK takes long to load, and only this format needs it
            from auricle.surface.formats.vtp_writing import vtp_bytes

            return {path: vtp_bytes(mesh, fields, space=space, tags=tags)}
    return opencarp_bytes(path, mesh, fields, tags=tags)


def _write_bytes(path: Path, *, content: bytes) -> None:
    path.write_bytes(content)
