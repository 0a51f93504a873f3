"""Isosurfaces: the closed surface around the part of a grid where a field exceeds a level."""

import numpy as np
from scipy.ndimage import maximum_filter
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D, vtkWindowedSincPolyDataFilter

from auricle.arrays import Faces, Floats, Points
from auricle.errors import InputError, SurfaceError
from auricle.surface.mesh import Mesh

_CLEARANCE = 0.01
"""How near to a grid node a surface vertex may come, as a share of the grid's edge."""


def extract_surface(
    field: Floats,
    *,
    level: float,
    spacing: tuple[float, float, float],
    origin: tuple[float, float, float],
    smoothing_passes: int = 20,
    pass_band: float = 0.1,
) -> Mesh:
    """Surface of the region where `field` > `level`, by flying edges and windowed-sinc smoothing.

    Values within about 1 % of the field's local variation from the level are first moved that
    far from it. This shifts vertices by some 1 % of the spacing at most, and rules out faces
    without area: every edge then has exactly two faces, and nothing need be mended afterwards.

    Parameters
    ----------
    field
        Shape (x, y, z): value at node (i, j, k) of the grid.
    level
        The region lies where the field exceeds it; equal values lie outside.
    spacing
        Distance of the nodes along x, y and z, mm.
    origin
        Position of node (0, 0, 0), mm.
    smoothing_passes
        Degree of the low-pass filter (Taubin, Zhang and Golub 1996), which unlike averaging
        does not shrink the surface; 0 leaves the isosurface as it is.
    pass_band
        Where the filter cuts, from 0 (only the coarsest shape stays) to 2 (all stays).

    Returns
    -------
    Mesh
        Closed and manifold, normals out of the region; one or more pieces, in mm.

    Raises
    ------
    InputError
        If the field is not three-dimensional and finite, or an option is out of range.
    SurfaceError
        If the region is empty or reaches the border of the grid.

    Examples
    --------
    >>> x, y, z = np.mgrid[-6:7, -6:7, -6:7]
    >>> ball = extract_surface(25.0 - x**2 - y**2 - z**2, level=0.0, smoothing_passes=0,
    ...                        spacing=(1.0, 1.0, 1.0), origin=(-6.0, -6.0, -6.0))
    >>> bool(abs(ball.area / (4 * np.pi * 5**2) - 1) < 0.02)
    True
    """
    _check_options(field, spacing, smoothing_passes, pass_band)
    height = _clear_of_zero(np.asarray(field, dtype=np.float64) - level)
    _check_border(height)
    nodes, faces = _flying_edges(height)
    vertices = nodes * np.asarray(spacing)
    if smoothing_passes:
        vertices = _windowed_sinc(vertices, faces, passes=smoothing_passes, pass_band=pass_band)
    return Mesh(vertices + np.asarray(origin), faces)


def _check_options(
    field: Floats, spacing: tuple[float, float, float], passes: int, pass_band: float
) -> None:
    if np.ndim(field) != 3 or min(np.shape(field)) < 3:
        raise InputError(f"a field of shape {np.shape(field)}: give (x, y, z), each 3 or more")
    if not np.isfinite(field).all():
        raise InputError("the field holds NaN or infinite values: fill them before extraction")
    if not (np.asarray(spacing) > 0).all():
        raise InputError(f"a spacing of {tuple(spacing)} mm: give positive distances")
    if passes < 0:
        raise InputError(f"{passes} smoothing passes: give 0 or more")
    if not 0 < pass_band <= 2:
        raise InputError(f"a pass band of {pass_band}: give more than 0 and at most 2")


def _clear_of_zero(height: Floats) -> Floats:
    """Move values off zero, so that no vertex falls on a node; zero itself counts as outside."""
    clearance = _CLEARANCE * maximum_filter(np.abs(height), size=3) + np.finfo(np.float64).tiny
    moved: Floats = np.where(
        height > 0, np.maximum(height, clearance), np.minimum(height, -clearance)
    )
    return moved


def _check_border(height: Floats) -> None:
    inside = height > 0
    if not inside.any():
        raise SurfaceError("the field nowhere exceeds the level: lower the level")
    for axis in range(3):
        if inside.take([0, -1], axis=axis).any():
            raise SurfaceError("the surface leaves the grid: enlarge it")


def _flying_edges(height: Floats) -> tuple[Points, Faces]:
    """Zero level set in node coordinates, oriented from positive to negative."""
    image = vtkImageData()
    image.SetDimensions(*height.shape)
    values = numpy_to_vtk(height.ravel(order="F"))
    image.GetPointData().SetScalars(values)
    contour = vtkFlyingEdges3D()
    contour.SetInputData(image)
    contour.SetValue(0, 0.0)
    contour.ComputeNormalsOff()
    contour.ComputeGradientsOff()
    contour.ComputeScalarsOff()
    contour.Update()
    surface = contour.GetOutput()
    nodes = vtk_to_numpy(surface.GetPoints().GetData()).astype(np.float64)
    faces = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).astype(np.int64)
    return nodes, faces.reshape(-1, 3)


def _windowed_sinc(vertices: Points, faces: Faces, *, passes: int, pass_band: float) -> Points:
    centre = vertices.mean(axis=0)
    places = vtkPoints()
    places.SetData(numpy_to_vtk(vertices - centre, deep=True))
    triangles = vtkCellArray()
    offsets = np.arange(0, faces.size + 1, 3, dtype=np.int64)
    triangles.SetData(
        numpy_to_vtkIdTypeArray(offsets, deep=True),
        numpy_to_vtkIdTypeArray(faces.ravel(), deep=True),
    )
    surface = vtkPolyData()
    surface.SetPoints(places)
    surface.SetPolys(triangles)
    smoother = vtkWindowedSincPolyDataFilter()
    smoother.SetInputData(surface)
    smoother.SetNumberOfIterations(passes)
    smoother.SetPassBand(pass_band)
    smoother.NormalizeCoordinatesOn()
    smoother.FeatureEdgeSmoothingOff()
    smoother.BoundarySmoothingOff()
    smoother.Update()
    smoothed = vtk_to_numpy(smoother.GetOutput().GetPoints().GetData())
    moved: Points = smoothed.astype(np.float64) + centre
    return moved
