"""Binary PLY, fields as properties of the vertices."""

from collections.abc import Sequence

import numpy as np

from auricle.arrays import Integers
from auricle.errors import OutputError
from auricle.surface.field import FieldMap
from auricle.surface.formats.header import UNKNOWN_SPACE
from auricle.surface.formats.opencarp import ELEMENT_TAG
from auricle.surface.formats.ply import NO_FIELDS
from auricle.surface.mesh import Mesh


def ply_bytes(
    mesh: Mesh, fields: Sequence[FieldMap], *, space: str, tags: Integers | None
) -> bytes:
    """Content of a binary little-endian PLY file: float64 positions and fields, int32 faces.

    A field of c components becomes c properties, ``name_0`` … The axes and units are comments,
    ``SPACE=LPS`` and ``UNITS=name=unit``.

    Raises
    ------
    OutputError
        If a field's name holds a blank or belongs to positions, normals or colours, or two
        properties would share a name.
    """
    columns = [(axis, "", mesh.vertices[:, i]) for i, axis in enumerate("xyz")]
    for field in fields:
        values = field.values.reshape(mesh.n_vertices, -1)
        columns += [(name, field.unit, values[:, i]) for i, name in enumerate(_names(field))]
    names = [name for name, _, _ in columns]
    if len(set(names)) < len(names):
        raise OutputError(f"fields share a PLY property among {names}: rename them")
    vertices = np.rec.fromarrays([values for _, _, values in columns], dtype=_doubles(names))
    units = [f"comment UNITS={name}={unit}" for name, unit, _ in columns if unit]
    header = _header(mesh, names, [*_space(space), *units], tagged=tags is not None)
    return header + vertices.tobytes() + _faces(mesh, tags)


def _names(field: FieldMap) -> list[str]:
    if field.values.ndim == 1:
        names = [field.name]
    else:
        names = [f"{field.name}_{i}" for i in range(field.values.shape[1])]
    if any(name in NO_FIELDS or len(name.split()) != 1 for name in names):
        raise OutputError(
            f"the field {field.name!r} cannot name a PLY property: rename it or write .vtp"
        )
    return names


def _doubles(names: Sequence[str]) -> np.dtype[np.void]:
    return np.dtype([(name, "<f8") for name in names])


def _space(space: str) -> list[str]:
    return [] if space == UNKNOWN_SPACE else [f"comment SPACE={space}"]


def _header(mesh: Mesh, names: Sequence[str], comments: Sequence[str], *, tagged: bool) -> bytes:
    lines = [
        "ply",
        "format binary_little_endian 1.0",
        *comments,
        f"element vertex {mesh.n_vertices}",
        *(f"property double {name}" for name in names),
        f"element face {mesh.n_faces}",
        "property list uchar int vertex_indices",
        *([f"property int {ELEMENT_TAG}"] if tagged else []),
        "end_header\n",
    ]
    return "\n".join(lines).encode()


def _faces(mesh: Mesh, tags: Integers | None) -> bytes:
    tag = [("tag", "<i4")] if tags is not None else []
    records = np.empty(mesh.n_faces, [("length", "u1"), ("corners", "<i4", 3), *tag])
    records["length"] = 3
    records["corners"] = mesh.faces
    if tags is not None:
        records["tag"] = tags
    return records.tobytes()
