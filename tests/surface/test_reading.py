import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData, vtkUnstructuredGrid
from vtkmodules.vtkIOLegacy import vtkPolyDataWriter, vtkUnstructuredGridWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter, vtkXMLUnstructuredGridWriter

from auricle.errors import FormatError
from auricle.surface import reading
from auricle.surface.formats.trimesh_parsing import parse_with_trimesh
from auricle.surface.formats.vtk_parsing import parse_vtk
from auricle.surface.reading import read_surface
from auricle.surface.soup import TriangleSoup

CORNERS = b"0 0 0\n1 0 0\n0 1 0\n"
STL_FACET = (
    b"facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
)
QUAD = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]
PTS = b"3\n0 0 0\n1000 0 0\n0 1000 0\n"
XYZ = b"property float x\nproperty float y\nproperty float z\n"


@pytest.fixture
def in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Parse without a child process, which takes a second to start and adds nothing to a truth."""

    def parse(kind: str, path: Path) -> tuple[TriangleSoup, int]:
        return (parse_vtk if kind in (".vtk", ".vtp", ".vtu") else parse_with_trimesh)(path, kind)

    monkeypatch.setattr(reading, "parse_isolated", parse)


@pytest.mark.usefixtures("in_this_process")
def test_text_and_binary_stl_hold_the_same_corners(tmp_path: Path) -> None:
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]] * 2, np.float64)
    record = np.zeros(2, [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    record["corners"] = corners.reshape(2, 3, 3)
    header = b"solid but binary SPACE=RAS".ljust(80) + struct.pack("<I", 2)
    (tmp_path / "binary.stl").write_bytes(header + record.tobytes())
    (tmp_path / "text.STL").write_bytes(
        b"solid vertex solid SPACE=RAS\n" + STL_FACET.upper() + b"endsolid vertex\n"
        b"solid\n" + STL_FACET + b"endsolid\n"
    )
    for name in ("binary.stl", "text.STL"):
        soup = read_surface(tmp_path / name)
        np.testing.assert_array_equal(soup.vertices, corners * [-1, -1, 1])
        np.testing.assert_array_equal(soup.faces, [[0, 1, 2], [3, 4, 5]])
        assert soup.space == "LPS"
        assert "RAS into LPS" in soup.remarks[0]


@pytest.mark.usefixtures("in_this_process")
def test_texture_and_normals_do_not_split_the_vertices_of_an_obj(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_bytes(
        b"# SPACE=LPS\nmtllib other.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0 .5 .5 .5 # coloured\n"
        b"v 9 9 9\n"
        b"vt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nvn 0 0 -1\no part\nusemtl red\n"
        b"f 1/1/1 2/2/1 3/3/1\nf 4/1/2 \\\n 3/2/2 2/1/2\ng end\nf 1/2/1 2/3/1 4/1/1 3/2/1\nl 1 2\n"
    )
    soup = read_surface(tmp_path / "a.obj")
    np.testing.assert_array_equal(soup.vertices, [*QUAD, [9, 9, 9]])
    assert soup.space == "LPS"
    assert soup.faces.tolist() == [[0, 1, 2], [3, 2, 1], [0, 1, 3], [0, 3, 2]]
    assert soup.remarks == (
        "1 polygons of more than three corners were cut into triangles, fan-wise",
        "1 lines and points left out: not faces",
    )


@pytest.mark.usefixtures("in_this_process")
def test_an_off_file_of_polygons_is_cut_into_triangles(tmp_path: Path) -> None:
    (tmp_path / "a.off").write_bytes(
        b"OFF # a comment\n5 2 0\n" + CORNERS + b"1 1 0\n2 2 0\n\n3 0 1 2\n5 0 1 4 3 2 255 0 0\n"
    )
    soup = read_surface(tmp_path / "a.off")
    assert len(soup.vertices) == 5
    np.testing.assert_array_equal(soup.faces, [[0, 1, 2], [0, 1, 4], [0, 4, 3], [0, 3, 2]])
    assert soup.remarks[0].startswith("1 polygons")


@pytest.mark.usefixtures("in_this_process")
def test_ply_properties_become_fields_and_tags_whatever_their_order(tmp_path: Path) -> None:
    (tmp_path / "a.ply").write_bytes(
        b"ply\nformat ascii 1.0\nelement vertex 4\n"
        b"comment SPACE=LPS\nproperty uchar red\nproperty double lat\n"
        + XYZ
        + b"property int region\nelement face 2\nproperty short tag\n"
        + b"property list uchar int vertex_index\nproperty float quality\nend_header\n"
        + b"9 10.5 0 0 0 7\n9 nan 1 0 0 7\n9 12.5 1 1 0 8\n9 13.5 0 1 0 8\n"
        + b"-4 3 0 1 2 0.5\n5 4 0 1 2 3 0.5\n"
    )
    soup = read_surface(tmp_path / "a.ply")
    np.testing.assert_array_equal(soup.vertices, [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    np.testing.assert_array_equal(soup.faces, [[0, 1, 2], [0, 1, 2], [0, 2, 3]])
    assert sorted(soup.point_fields) == ["lat", "region"]
    np.testing.assert_array_equal(soup.point_fields["lat"], [10.5, np.nan, 12.5, 13.5])
    np.testing.assert_array_equal(soup.point_fields["region"], [7, 7, 8, 8])
    np.testing.assert_array_equal(soup.face_tags["tag"], [-4, 5, 5])
    assert soup.space == "LPS"


def test_opencarp_positions_come_in_mm_with_tags_and_their_own_fields(tmp_path: Path) -> None:
    (tmp_path / "la.pts").write_bytes(PTS)
    (tmp_path / "la.ELEM").write_bytes(b"1\nTr 0 1 2 11\n")
    (tmp_path / "la.dat").write_bytes(b"1\n2\n3\n")
    (tmp_path / "la_lat.dat").write_bytes(b"10\nnan\n12.5\n")
    (tmp_path / "la_epi.pts").write_bytes(PTS)
    (tmp_path / "la_epi_lat.dat").write_bytes(b"field of another pair\n")
    (tmp_path / "lamb.dat").write_bytes(b"no field of this pair\n")
    for name in ("la.pts", "la.ELEM"):
        soup = read_surface(tmp_path / name)
        np.testing.assert_array_equal(soup.vertices, [[0, 0, 0], [1, 0, 0], [0, 1, 0]])
        np.testing.assert_array_equal(soup.faces, [[0, 1, 2]])
        assert sorted(soup.point_fields) == ["la", "lat"]
        np.testing.assert_array_equal(soup.point_fields["lat"], [10, np.nan, 12.5])
        assert soup.face_tags["elemTag"].tolist() == [11]
        assert "micrometres" in soup.remarks[0]


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("la.pts", PTS.replace(b"1000 0 0", b"\x1e")),
        ("la.dat", b"1\n\x1e\n3\n"),
        ("la.dat", b"\x1e\n\x1e\n\x1e\n"),
    ],
)
def test_an_opencarp_line_of_a_control_character_is_refused(
    name: str, content: bytes, tmp_path: Path
) -> None:
    files = {"la.pts": PTS, "la.elem": b"1\nTr 0 1 2 11\n", "la.dat": b"1\n2\n3\n", name: content}
    for file, text in files.items():
        (tmp_path / file).write_bytes(text)
    with pytest.raises(FormatError, match=f"holds a line that is not . numbers in {name}"):
        read_surface(tmp_path / "la.pts")


def test_opencarp_elements_need_no_tags(tmp_path: Path) -> None:
    (tmp_path / "la.pts").write_bytes(PTS)
    (tmp_path / "la.elem").write_bytes(b"1\nTr 2 1 0\n")
    soup = read_surface(tmp_path / "la.elem")
    assert soup.faces.tolist() == [[2, 1, 0]]
    assert not soup.face_tags


@pytest.mark.usefixtures("in_this_process")
def test_indices_beyond_the_vertices_are_left_to_the_cleaning(tmp_path: Path) -> None:
    (tmp_path / "a.ply").write_bytes(
        b"ply\nformat ascii 1.0\nelement vertex 3\n"
        + XYZ
        + b"element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        + CORNERS
        + b"3 0 -1 9\n"
    )
    assert read_surface(tmp_path / "a.ply").faces.tolist() == [[0, -1, 9]]


@pytest.mark.usefixtures("in_this_process")
def test_a_position_that_no_face_uses_may_be_nan(tmp_path: Path) -> None:
    (tmp_path / "a.vtk").write_bytes(
        b"# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n"
        + CORNERS
        + b"nan 1 1\nPOLYGONS 1 4\n3 0 1 2\n"
    )
    assert np.isnan(read_surface(tmp_path / "a.vtk").vertices[3, 0])


@pytest.mark.usefixtures("in_this_process")
def test_a_field_may_have_a_name_that_is_not_utf_8(tmp_path: Path) -> None:
    (tmp_path / "a.vtk").write_bytes(
        b"# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n"
        + CORNERS
        + b"POLYGONS 1 4\n3 0 1 2\nPOINT_DATA 3\nSCALARS Zeit\xfc float 1\n"
        + b"LOOKUP_TABLE default\n1 2 3\n"
    )
    assert list(read_surface(tmp_path / "a.vtk").point_fields) == [r"Zeit\xfc"]


def everything(*, grid: bool) -> Any:
    """Cells of every flat kind, and a point array of every type, in RAS axes."""
    points = vtkPoints()
    points.SetData(numpy_to_vtk(POSITIONS, deep=True))
    lists = [[0], [0, 1, 2], [0, 1, 2], [0, 1, 2, 3], [4, 5, 6, 7, 8], [0, 1, 2, 3]]
    if grid:
        data = vtkUnstructuredGrid()
        data.SetPoints(points)
        for kind, corners in zip((1, 4, 5, 8, 7, 6), lists, strict=True):
            order = [0, 1, 3, 2] if kind == 8 else range(len(corners))
            data.InsertNextCell(kind, len(corners), [corners[i] for i in order])
    else:
        data = vtkPolyData()
        data.SetPoints(points)
        for part, held in (("Verts", 0), ("Lines", 1), ("Polys", slice(2, 5)), ("Strips", 5)):
            cells = vtkCellArray()
            for corners in lists[held] if part == "Polys" else [lists[held]]:
                cells.InsertNextCell(len(corners), corners)
            getattr(data, f"Set{part}")(cells)
    for name, values in ARRAYS.items():
        array = numpy_to_vtk(values, deep=True)
        array.SetName(name)
        array.SetComponentName(0, f"{name} [unit]")
        data.GetPointData().AddArray(array)
    data.GetPointData().SetActiveScalars("int16")
    data.GetPointData().SetActiveVectors("wall shear")
    tags = numpy_to_vtk(np.arange(6) * 10, deep=True)
    tags.SetName("region")
    data.GetCellData().AddArray(tags)
    for name, words, owner in (
        ("SPACE", ["RAS"], data.GetFieldData()),
        ("UNITS", ["lat=ms", "x=y=mV"], data.GetFieldData()),
        ("labels", [f"a {i}" for i in range(9)], data.GetPointData()),
    ):
        text = vtkStringArray()
        text.SetName(name)
        for word in words:
            text.InsertNextValue(word)
        owner.AddArray(text)
    return data


POSITIONS = np.random.default_rng(1).normal(size=(9, 3))
ARRAYS = {
    "lat": np.array([1.5, np.nan, 3, 4, 5, 6, 7, 8, 9]),
    "wall shear": np.random.default_rng(2).normal(size=(9, 3)),
    **{
        kind: np.arange(9).astype(kind)
        for kind in ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "float32")
    },
}
VARIANTS = [
    (".vtk", 0, 1, 42),
    (".vtk", 0, 2, 51),
    (".vtk", 1, 1, 51),
    (".vtk", 1, 2, 42),
    (".vtp", 0, 0, 0),
    (".vtp", 0, 1, 0),
    (".vtp", 0, 2, 1),
    (".vtu", 1, 1, 1),
    (".vtu", 1, 3, 0),
]


def written_by_vtk(path: Path, *, grid: bool, kind: int, option: int) -> None:
    """Write `everything` as text, inline or appended, compressed or not, of an old version."""
    if path.suffix == ".vtk":
        writer: Any = vtkUnstructuredGridWriter() if grid else vtkPolyDataWriter()
        writer.SetFileType(kind)
        writer.SetFileVersion(option)
    else:
        writer = vtkXMLUnstructuredGridWriter() if grid else vtkXMLPolyDataWriter()
        writer.SetDataMode(min(kind, 2))
        writer.SetEncodeAppendedData(kind != 3)
        writer.SetCompressorType(option)
        writer.SetHeaderType(64 if kind == 3 else 32)
    writer.SetInputData(everything(grid=grid))
    writer.SetFileName(str(path))
    assert writer.Write() == 1


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize(("suffix", "grid", "kind", "option"), VARIANTS)
def test_every_kind_of_vtk_file_reads_the_same(
    suffix: str, grid: int, kind: int, option: int, tmp_path: Path
) -> None:
    path = tmp_path / f"all{suffix}"
    written_by_vtk(path, grid=bool(grid), kind=kind, option=option)
    soup = read_surface(path)
    close = 1e-6 if suffix == ".vtk" and kind == 1 else 0.0  # legacy text has few digits
    np.testing.assert_allclose(soup.vertices, POSITIONS * [-1, -1, 1], rtol=0, atol=close)
    triangles = [[0, 1, 2], [0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7], [4, 7, 8], [0, 1, 2]]
    assert soup.faces.tolist() == [*triangles, [3, 2, 1]]
    assert soup.face_tags["region"].tolist() == [20, 30, 30, 40, 40, 40, 50, 50]
    assert set(soup.point_fields) == set(ARRAYS)
    for name, values in ARRAYS.items():
        np.testing.assert_allclose(soup.point_fields[name], values, rtol=0, atol=close)
    assert soup.units == {"lat": "ms", "x=y": "mV"}
    assert soup.space == "LPS"
    assert soup.remarks == (
        f"cells left out, being no faces: 1 vertex, 1 {'poly' if grid else ''}line",
        "2 polygons of more than three corners were cut into triangles, fan-wise",
        "1 triangle strips were cut into triangles",
        "point arrays 'labels' left out: they are not numbers",
        "positions turned from RAS into LPS axes (x and y negated); "
        "fields of several components left as they were: wall shear",
    )


REAL = {
    "meshes/atlas/la_endo1_Labelled.pts": (60100, 119477),
    "meshes/atlas/la_endo2_Labelled.elem": (62178, 123651),
    "meshes/atlas/la_endo3_Labelled.pts": (81833, 162831),
    "meshes/atlas/LASC2018_06SR5RB_LA_mri_closed.vtk": (32042, 64080),
    "meshes/atlas/CTSSM01_LA_endo.vtk": (12639, 24854),
    "meshes/lasc2013-b002/gt_noclip_mesh.vtp": (13354, 26704),
    "meshes/lasc2013-b002/gt_std_mesh.vtp": (11355, 22055),
    "meshes/lausm/test.vtk": (11280, 22556),
    "meshes/lge/LA_A_lge.vtk": (20000, 39996),
    "meshes/lge/LA_B_lge.vtk": (20000, 39963),
    "meshes/lge/LA_A_clipped_5holes.vtk": (13942, 27732),
    "maps/openep-dataset2/openep_ds2_lat_bip.vtk": (8848, 16942),
}


@pytest.mark.parametrize("name", REAL)
def test_a_real_atrium_has_the_size_its_source_states(name: str, real_data: Path) -> None:
    soup = read_surface(real_data / name)
    assert (len(soup.vertices), len(soup.faces)) == REAL[name]
    assert soup.faces.min() >= 0
    assert soup.faces.max() < len(soup.vertices)
    assert 50 < np.linalg.norm(np.ptp(soup.vertices, axis=0)) < 200


def test_a_clinical_map_keeps_what_was_not_sampled(real_data: Path) -> None:
    soup = read_surface(real_data / "maps/openep-dataset2/openep_ds2_lat_bip.vtk")
    times = soup.point_fields["LAT"]
    assert np.isnan(times).sum() == 62
    assert (np.nanmin(times), np.nanmax(times)) == (20, 175)
    assert np.isnan(soup.point_fields["BIP_0_2mV_8bit"]).sum() == 548


def test_the_marks_of_landmarks_are_no_surface(real_data: Path) -> None:
    with pytest.raises(FormatError, match=r"testseeds.vtp: holds no faces"):
        read_surface(real_data / "meshes/lausm/testseeds.vtp")
