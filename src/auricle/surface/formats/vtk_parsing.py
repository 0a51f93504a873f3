"""VTK's readers of legacy and XML surface files; runs in the child process."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow

from auricle.arrays import Faces, Floats, Integers, Truths
from auricle.errors import FormatError
from auricle.surface.formats.header import UNKNOWN_SPACE, damaged, shown
from auricle.surface.formats.polygons import fanned_remark, fans, strips
from auricle.surface.soup import TriangleSoup

SPACE_ARRAY = "SPACE"
UNITS_ARRAY = "UNITS"

_TRIANGLE_STRIP, _PIXEL = 6, 8
_LEFT_OUT = {0: "empty", 1: "vertex", 2: "polyvertex", 3: "line", 4: "polyline"}
_POLYGONS = (5, 7, 8, 9)
_VOLUMES = {10: "tetrahedra", 11: "voxels", 12: "hexahedra", 13: "wedges", 14: "pyramids"}
_Cutting = Callable[[Integers, Integers, Integers], tuple[Faces, Integers]]
_READ_ALL = ("Scalars", "Vectors", "Normals", "Tensors", "ColorScalars", "TCoords", "Fields")


def parse_vtk(path: Path, kind: str) -> tuple[TriangleSoup, int]:
    """Surface and fields of a VTK file whose outline was checked.

    Returns
    -------
    soup
        Triangles in the order of their cells (those of strips last), numeric point arrays,
        whole-number cell arrays.
    cells
        Cells in the file, the ones left out included.

    Raises
    ------
    FormatError
        If VTK reports an error, or the file holds cells of a volume or curved cells.
    """
    data = _read(path, kind)
    points, cells = data.GetPoints(), data.GetNumberOfCells()
    vertices = _numbers(points.GetData()) if points is not None else np.empty((0, 3))
    faces, owner, remarks = _surface(data)
    fields, field_remarks = _point_fields(data.GetPointData(), len(vertices))
    tags, tag_remarks = _face_tags(data.GetCellData(), cells, owner)
    about = _strings(data.GetFieldData())
    soup = TriangleSoup(
        vertices.astype(np.float64),
        faces,
        point_fields=fields,
        face_tags=tags,
        units=_units(about.get(UNITS_ARRAY, ())),
        space=next(iter(about.get(SPACE_ARRAY, ())), UNKNOWN_SPACE),
        remarks=remarks + field_remarks + tag_remarks,
    )
    return soup, cells


def _read(path: Path, kind: str) -> Any:
    """Read the data set of a file; any error VTK reports is the file's fault."""
    window = vtkStringOutputWindow()
    vtkOutputWindow.SetInstance(window)
    reader = _reader(path, kind)
    reader.SetFileName(str(path))
    reader.Update()
    told = _text(window.GetOutput())
    error = re.search(r"^ERROR:[^\n]*\n(?:[^\n]*\): )?([^\n]*)", told, re.MULTILINE)
    if error is not None or reader.GetErrorCode():
        text = error[1] if error is not None else f"error {reader.GetErrorCode()}"
        raise damaged(f"is refused by VTK ({text.strip(' .')})")
    return reader.GetOutput()


def _reader(path: Path, kind: str) -> Any:
    if kind in (".vtp", ".vtu"):
        from vtkmodules import vtkIOXML

        name = "PolyData" if kind == ".vtp" else "UnstructuredGrid"
        return getattr(vtkIOXML, f"vtkXML{name}Reader")()
    from vtkmodules import vtkIOLegacy

    with path.open("rb") as file:
        start = file.read(8192).upper()
    is_grid = re.search(rb"^\s*DATASET\s+UNSTRUCTURED_GRID", start, re.MULTILINE) is not None
    name = "UnstructuredGrid" if is_grid else "PolyData"
    reader = getattr(vtkIOLegacy, f"vtk{name}Reader")()
    for attribute in _READ_ALL:
        getattr(reader, f"ReadAll{attribute}On")()
    return reader


def _surface(data: Any) -> tuple[Faces, Integers, tuple[str, ...]]:
    """Triangles, the cell each belongs to, and remarks."""
    cells = _grid_cells(data) if data.IsA("vtkUnstructuredGrid") else _polydata_cells(data)
    cells.refuse_other_than_flat()
    ringed, stripped = np.isin(cells.kinds, _POLYGONS), cells.kinds == _TRIANGLE_STRIP
    if (cells.lengths[ringed | stripped] < 3).any():
        raise damaged("holds polygons of fewer than three corners")
    fanned, fan_owner = cells.cut(fans, ringed)
    zigzag, strip_owner = cells.cut(strips, stripped)
    remarks = []
    if left_out := cells.tally(_LEFT_OUT):
        held = ", ".join(f"{count} {name}" for name, count in left_out)
        remarks.append(f"cells left out, being no faces: {held}")
    if polygons := int((cells.lengths[ringed] > 3).sum()):
        remarks.append(fanned_remark(polygons))
    if stripped.any():
        remarks.append(f"{stripped.sum()} triangle strips were cut into triangles")
    owner = np.concatenate([fan_owner, strip_owner])
    return np.concatenate([fanned, zigzag]), owner, tuple(remarks)


@dataclass(frozen=True)
class _Cells:
    """Cells of every kind in the file's order."""

    kinds: Integers
    starts: Integers
    lengths: Integers
    connectivity: Integers

    def tally(self, names: Mapping[int, str]) -> list[tuple[str, int]]:
        """How many cells there are of each named kind, where there are any."""
        kinds, counts = np.unique(self.kinds, return_counts=True)
        found = dict(zip(kinds.tolist(), counts.tolist(), strict=True))
        return [(name, found[kind]) for kind, name in names.items() if kind in found]

    def refuse_other_than_flat(self) -> None:
        """Refuse volumes and curved cells."""
        if volumes := self.tally(_VOLUMES):
            held = ", ".join(f"{count} {name}" for name, count in volumes)
            raise FormatError(
                f"holds a volume mesh ({held}), not a surface: extract its surface first"
            )
        known = {*_LEFT_OUT, *_POLYGONS, _TRIANGLE_STRIP}
        others = sorted(set(np.unique(self.kinds).tolist()) - known)
        if others:
            count = int(np.isin(self.kinds, others).sum())
            raise FormatError(
                f"holds {count} cells of VTK types {others}: export flat triangles only"
            )

    def cut(self, how: _Cutting, chosen: Truths) -> tuple[Faces, Integers]:
        """Triangles of the chosen cells, and the cell each belongs to."""
        cells = np.flatnonzero(chosen)
        faces, owner = how(self.starts[cells], self.lengths[cells], self.connectivity)
        return faces, cells[owner]


def _grid_cells(grid: Any) -> _Cells:
    lengths, connectivity = _lists(grid.GetCells())
    try:
        kinds = vtk_to_numpy(grid.GetCellTypes()).astype(np.int64)
    except TypeError:  # VTK before 9.6, where this name wants an argument
        kinds = vtk_to_numpy(grid.GetCellTypesArray()).astype(np.int64)
    cells = _Cells(kinds, np.cumsum(lengths) - lengths, lengths, connectivity)
    pixels = cells.starts[kinds == _PIXEL]
    connectivity[pixels + 2], connectivity[pixels + 3] = (
        connectivity[pixels + 3],
        connectivity[pixels + 2],
    )
    return cells


def _polydata_cells(polydata: Any) -> _Cells:
    parts = {
        1: _lists(polydata.GetVerts()),
        3: _lists(polydata.GetLines()),
        7: _lists(polydata.GetPolys()),
        _TRIANGLE_STRIP: _lists(polydata.GetStrips()),
    }
    kinds = np.concatenate([np.full(len(part[0]), kind) for kind, part in parts.items()])
    lengths = np.concatenate([part[0] for part in parts.values()])
    connectivity = np.concatenate([part[1] for part in parts.values()])
    return _Cells(kinds, np.cumsum(lengths) - lengths, lengths, connectivity)


def _lists(cells: Any) -> tuple[Integers, Integers]:
    """Lengths and vertex indices of a cell array's lists."""
    cells.ConvertTo64BitStorage()
    offsets = vtk_to_numpy(cells.GetOffsetsArray()).astype(np.int64)
    connectivity = vtk_to_numpy(cells.GetConnectivityArray()).astype(np.int64)
    if len(offsets) and offsets[-1] != len(connectivity):
        raise damaged(f"holds {len(connectivity)} vertex indices, its lists {offsets[-1]}")
    return np.diff(offsets), connectivity


def _point_fields(attributes: Any, n_vertices: int) -> tuple[dict[str, Floats], tuple[str, ...]]:
    fields: dict[str, Floats] = {}
    left_out = []
    for name, values in _arrays(attributes):
        if values is None:
            left_out.append(name)
        elif len(values) != n_vertices:
            raise damaged(f"holds {len(values)} values of {shown(name)} for {n_vertices} vertices")
        else:
            fields[name] = values.astype(np.float64)
    return fields, _left_out("point", left_out, "they are not numbers")


def _face_tags(
    attributes: Any, n_cells: int, owner: Integers
) -> tuple[dict[str, Integers], tuple[str, ...]]:
    tags: dict[str, Integers] = {}
    left_out = []
    for name, values in _arrays(attributes):
        if values is None or values.ndim > 1 or values.dtype.kind not in "iu":
            left_out.append(name)
        elif len(values) != n_cells:
            raise damaged(f"holds {len(values)} values of {shown(name)} for {n_cells} cells")
        else:
            tags[name] = values[owner].astype(np.int64)
    return tags, _left_out("cell", left_out, "they are not whole-number labels")


def _left_out(where: str, names: list[str], why: str) -> tuple[str, ...]:
    if not names:
        return ()
    return (f"{where} arrays {', '.join(shown(name) for name in names)} left out: {why}",)


def _arrays(attributes: Any) -> Iterator[tuple[str, NDArray[Any] | None]]:
    """Names and values of arrays, None for values that are not numbers."""
    for place in range(attributes.GetNumberOfArrays()):
        array = attributes.GetAbstractArray(place)
        name = _text(array.GetName() or f"array {place}")
        yield name, _numbers(array) if array.IsNumeric() else None


def _numbers(array: Any) -> NDArray[Any]:
    values: NDArray[Any] = vtk_to_numpy(array)
    return values


def _units(entries: Iterable[str]) -> dict[str, str]:
    """Units by name from entries ``name=unit``."""
    parts = (entry.rpartition("=") for entry in entries)
    return {name: unit for name, equals, unit in parts if equals}


def _strings(attributes: Any) -> dict[str, list[str]]:
    """Text arrays by name."""
    arrays = map(attributes.GetAbstractArray, range(attributes.GetNumberOfArrays()))
    return {
        array.GetName(): [_text(array.GetValue(i)) for i in range(array.GetNumberOfValues())]
        for array in arrays
        if array.IsA("vtkStringArray")
    }


def _text(words: str | bytes) -> str:
    """Words of VTK, which come as bytes where they are not UTF-8."""
    return words.decode("utf-8", "backslashreplace") if isinstance(words, bytes) else words
