"""VTK XML PolyData (``.vtp``), auricle's native surface format."""

from collections.abc import Sequence
from typing import Any
from xml.sax.saxutils import escape

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from auricle.arrays import Floats, Integers
from auricle.surface.field import FieldMap
from auricle.surface.formats.opencarp import ELEMENT_TAG
from auricle.surface.formats.vtk_parsing import SPACE_ARRAY, UNITS_ARRAY
from auricle.surface.mesh import Mesh


def vtp_bytes(
    mesh: Mesh, fields: Sequence[FieldMap], *, space: str, tags: Integers | None
) -> bytes:
    """Content of a ``.vtp`` file: float64 throughout, compressed by zlib, appended in base64.

    The axes are the field-data array ``SPACE``, the units ``UNITS`` of entries ``name=unit``.
    """
    polydata = vtkPolyData()
    points = vtkPoints()
    points.SetData(_array(mesh.vertices, ""))
    polydata.SetPoints(points)
    polydata.SetPolys(_triangles(mesh))
    for field in fields:
        polydata.GetPointData().AddArray(_array(field.values, field.name))
    if tags is not None:
        polydata.GetCellData().AddArray(_array(tags, ELEMENT_TAG))
    polydata.GetFieldData().AddArray(_text(SPACE_ARRAY, [space]))
    units = [f"{field.name}={field.unit}" for field in fields if field.unit]
    if units:
        polydata.GetFieldData().AddArray(_text(UNITS_ARRAY, units))
    return _written(polydata)


def _written(polydata: Any) -> bytes:
    writer = vtkXMLPolyDataWriter()
    writer.SetInputData(polydata)
    writer.SetByteOrderToLittleEndian()
    writer.SetHeaderTypeToUInt64()
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOn()
    writer.SetCompressorTypeToZLib()
    writer.WriteToOutputStringOn()
    writer.Write()
    content: str = writer.GetOutputString()
    return content.encode()


def _triangles(mesh: Mesh) -> Any:
    offsets = np.arange(0, 3 * mesh.n_faces + 1, 3)
    cells = vtkCellArray()
    cells.SetData(_array(offsets, ""), _array(mesh.faces.reshape(-1), ""))
    return cells


def _array(values: Floats | Integers, name: str) -> Any:
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    if name:
        array.SetName(escape(name, {'"': "&quot;"}))  # VTK writes names as they are
    return array


def _text(name: str, lines: Sequence[str]) -> Any:
    array = vtkStringArray()
    array.SetName(name)
    for line in lines:
        array.InsertNextValue(line)
    return array
