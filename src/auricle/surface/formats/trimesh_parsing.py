"""trimesh's parsers of PLY, STL, OBJ and OFF, without its repairs; runs in the child process."""

from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from trimesh.exchange.obj import load_obj
from trimesh.exchange.off import load_off
from trimesh.exchange.ply import load_ply
from trimesh.exchange.stl import load_stl

from auricle.arrays import Integers
from auricle.errors import FormatError
from auricle.surface.formats.header import damaged
from auricle.surface.formats.obj import stripped_obj
from auricle.surface.formats.off import stripped_off
from auricle.surface.formats.ply import FACE_LISTS, NO_FIELDS
from auricle.surface.formats.polygons import fanned_remark, fans
from auricle.surface.formats.stl import stripped_stl
from auricle.surface.soup import TriangleSoup


def parse_with_trimesh(path: Path, kind: str) -> tuple[TriangleSoup, int]:
    """Vertices, faces and fields of a file whose header was checked.

    Returns
    -------
    soup
        What trimesh read; an STL file's vertices are three a face, nothing merged.
    cells
        Polygons of a PLY file, triangles of the others.

    Raises
    ------
    FormatError
        If a PLY file mixes polygons in a way trimesh cannot read.
    """
    content = path.read_bytes()
    if kind == ".ply":
        return _ply(content)
    if kind == ".obj":
        loaded = load_obj(
            BytesIO(stripped_obj(BytesIO(content))), skip_materials=True, maintain_order=True
        )
    elif kind == ".off":
        loaded = load_off(BytesIO(stripped_off(BytesIO(content))))
    else:
        loaded = load_stl(BytesIO(stripped_stl(content)))
    (geometry,) = loaded.get("geometry", {"": loaded}).values()
    faces = np.asarray(geometry["faces"], np.int64)
    return TriangleSoup(np.asarray(geometry["vertices"], np.float64), faces), len(faces)


def _ply(content: bytes) -> tuple[TriangleSoup, int]:
    try:
        loaded = load_ply(BytesIO(content), fix_texture=False, skip_materials=True)
    except ValueError as fault:
        raise FormatError(
            f"is refused by trimesh ({fault}): it is damaged, or mixes polygons of several sizes "
            "in binary; export it as text or as triangles"
        ) from fault
    elements = loaded["metadata"]["_ply_raw"]
    vertex, face = elements["vertex"], elements["face"]
    columns = {name: _column(vertex["data"][name]) for name in vertex["properties"]}
    lengths, connectivity = _polygons(face["data"])
    faces, owner = fans(np.cumsum(lengths) - lengths, lengths, connectivity)
    polygons = int((lengths > 3).sum())
    tags = {
        name: _column(face["data"][name])[owner].astype(np.int64)
        for name, kind in face["properties"].items()
        if name not in NO_FIELDS and "," not in kind and np.dtype(kind).kind in "iu"
    }
    soup = TriangleSoup(
        np.column_stack([columns[axis] for axis in "xyz"]).astype(np.float64),
        faces,
        point_fields={n: v.astype(np.float64) for n, v in columns.items() if n not in NO_FIELDS},
        face_tags=tags,
        remarks=(fanned_remark(polygons),) if polygons else (),
    )
    return soup, len(lengths)


def _column(values: Any) -> NDArray[Any]:
    return np.asarray(values).reshape(-1)


def _polygons(data: Mapping[str, Any] | NDArray[Any]) -> tuple[Integers, Integers]:
    """Lengths and corners of the faces in trimesh's several ways of holding them."""
    names = data.keys() if isinstance(data, Mapping) else data.dtype.names or ()
    name = next(name for name in FACE_LISTS if name in names)
    held: Any = data[name]
    if isinstance(data, np.ndarray):
        if (held["f0"] != held["f1"].shape[-1]).any():
            raise FormatError(
                "mixes polygons of several sizes in a binary PLY: export it as text or as triangles"
            )
        held = held["f1"]
    if held.dtype != object:
        held = held.reshape(1, -1) if held.ndim == 1 else held
    lengths = np.array([len(polygon) for polygon in held], np.int64)
    if (lengths < 3).any():
        raise damaged(f"holds {(lengths < 3).sum()} faces of fewer than three corners")
    return lengths, np.concatenate(held).astype(np.int64)
