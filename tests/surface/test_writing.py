from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from auricle.arrays import Floats
from auricle.errors import OutputError
from auricle.surface.field import FieldMap
from auricle.surface.formats.trimesh_parsing import parse_with_trimesh
from auricle.surface.formats.vtk_parsing import parse_vtk
from auricle.surface.mesh import Mesh
from auricle.surface.reading import read_surface
from auricle.surface.writing import WRITABLE, write_surface

FACES = np.array([[0, 1, 2], [2, 1, 3], [4, 3, 1]])
HARD_NAME = """a <b> & "c" 'd' é=ü"""
TAGS = np.array([11, -2, 2**31 - 1])
MANY = settings(
    max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
positions = arrays(np.float64, (5, 3), elements=st.floats(-1e6, 1e6, width=64))
values = arrays(np.float64, 5, elements=st.floats(allow_infinity=False, width=64))


def fields_of(mesh: Mesh, column: Floats) -> list[FieldMap]:
    return [
        FieldMap(mesh, column, "local_activation_time", "ms"),
        FieldMap(mesh, column[::-1], "s"),
    ]


@MANY
@given(vertices=positions, column=values)
def test_vtp_gives_back_every_bit(vertices: Floats, column: Floats, tmp_path: Path) -> None:
    mesh = Mesh(vertices, FACES)
    fields = [
        FieldMap(mesh, column, HARD_NAME, "mV"),
        FieldMap(mesh, np.column_stack([column, vertices]), "rows"),
    ]
    write_surface(tmp_path / "a.vtp", mesh, fields, tags=TAGS)
    soup, cells = parse_vtk(tmp_path / "a.vtp", ".vtp")
    np.testing.assert_array_equal(soup.vertices, vertices)
    np.testing.assert_array_equal(soup.faces, FACES)
    assert list(soup.point_fields) == [HARD_NAME, "rows"]
    for field in fields:
        np.testing.assert_array_equal(soup.point_fields[field.name], field.values)
    assert soup.units == {HARD_NAME: "mV"}
    assert soup.face_tags["elemTag"].tolist() == TAGS.tolist()
    assert cells == 3


@MANY
@given(vertices=positions, column=values)
def test_ply_gives_back_every_bit(vertices: Floats, column: Floats, tmp_path: Path) -> None:
    mesh = Mesh(vertices, FACES)
    rows = FieldMap(mesh, np.column_stack([column, vertices[:, 0]]), "rows")
    write_surface(tmp_path / "a.ply", mesh, [*fields_of(mesh, column), rows], tags=TAGS)
    soup, cells = parse_with_trimesh(tmp_path / "a.ply", ".ply")
    np.testing.assert_array_equal(soup.vertices, vertices)
    np.testing.assert_array_equal(soup.faces, FACES)
    assert list(soup.point_fields) == ["local_activation_time", "s", "rows_0", "rows_1"]
    np.testing.assert_array_equal(soup.point_fields["s"], column[::-1])
    np.testing.assert_array_equal(soup.point_fields["local_activation_time"], column)
    np.testing.assert_array_equal(soup.point_fields["rows_1"], vertices[:, 0])
    assert soup.face_tags["elemTag"].tolist() == TAGS.tolist()
    assert cells == 3


@MANY
@given(vertices=positions)
def test_stl_gives_back_the_corners_in_single_precision(vertices: Floats, tmp_path: Path) -> None:
    write_surface(tmp_path / "a.stl", Mesh(vertices, FACES))
    soup, cells = parse_with_trimesh(tmp_path / "a.stl", ".stl")
    np.testing.assert_array_equal(soup.vertices, vertices[FACES].astype("f4").reshape(-1, 3))
    np.testing.assert_array_equal(soup.faces, np.arange(9).reshape(3, 3))
    assert cells == 3


@MANY
@given(vertices=positions, column=values)
def test_opencarp_gives_back_positions_to_a_millionth_mm(
    vertices: Floats, column: Floats, tmp_path: Path
) -> None:
    mesh = Mesh(vertices, FACES)
    write_surface(tmp_path / "a.elem", mesh, fields_of(mesh, column), tags=TAGS)
    soup = read_surface(tmp_path / "a.pts")
    np.testing.assert_allclose(soup.vertices, vertices, rtol=0, atol=1e-8)
    np.testing.assert_array_equal(soup.faces, FACES)
    np.testing.assert_array_equal(soup.point_fields["local_activation_time"], column)
    np.testing.assert_array_equal(soup.point_fields["s"], column[::-1])
    assert soup.face_tags["elemTag"].tolist() == TAGS.tolist()


@pytest.fixture
def mesh(rng: np.random.Generator) -> Mesh:
    return Mesh(rng.normal(scale=30, size=(5, 3)), FACES)


@pytest.fixture
def column(rng: np.random.Generator) -> Floats:
    drawn = rng.normal(size=5)
    drawn[2] = np.nan
    return drawn


@pytest.mark.parametrize("suffix", WRITABLE)
def test_the_same_surface_is_the_same_bytes(
    suffix: str, mesh: Mesh, column: Floats, tmp_path: Path
) -> None:
    contents = []
    for folder in ("first", "second"):
        path = tmp_path / folder / f"a{suffix}"
        write_surface(path, mesh, fields_of(mesh, column), space="LPS", tags=TAGS)
        contents.append({file.name: file.read_bytes() for file in path.parent.iterdir()})
    assert contents[0] == contents[1]
    opencarp = ["a.elem", "a.pts", "a_local_activation_time.dat", "a_s.dat"]
    assert sorted(contents[0]) == (opencarp if suffix in (".pts", ".elem") else [f"a{suffix}"])


def test_opencarp_takes_tag_0_where_none_is_given(mesh: Mesh, tmp_path: Path) -> None:
    write_surface(tmp_path / "a.pts", mesh)
    assert (tmp_path / "a.elem").read_text().splitlines()[:2] == ["3", "Tr 0 1 2 0"]


@pytest.mark.parametrize("suffix", [".vtp", ".ply", ".stl"])
def test_axes_and_units_come_back_through_the_whole_reader(
    suffix: str, mesh: Mesh, column: Floats, tmp_path: Path
) -> None:
    path = tmp_path / f"a{suffix}"
    write_surface(path, mesh, fields_of(mesh, column), space="LPS", tags=TAGS)
    soup = read_surface(path)
    assert len(soup.faces) == 3
    assert soup.space == "LPS"
    assert soup.units == ({} if suffix == ".stl" else {"local_activation_time": "ms"})
    assert not soup.remarks


def test_axes_nobody_stated_stay_unknown(mesh: Mesh, tmp_path: Path) -> None:
    write_surface(tmp_path / "a.vtp", mesh)
    assert read_surface(tmp_path / "a.vtp").space == "unknown"
    write_surface(tmp_path / "a.ply", mesh)
    write_surface(tmp_path / "a.stl", mesh)
    assert b"SPACE" not in (tmp_path / "a.ply").read_bytes() + (tmp_path / "a.stl").read_bytes()


def test_positions_in_ras_come_back_in_lps(mesh: Mesh, tmp_path: Path) -> None:
    write_surface(tmp_path / "a.vtp", mesh, space="RAS")
    soup = read_surface(tmp_path / "a.vtp")
    assert soup.space == "LPS"
    np.testing.assert_array_equal(soup.vertices, mesh.vertices * [-1, -1, 1])


def test_a_facet_without_area_has_no_normal(tmp_path: Path) -> None:
    flat = Mesh(np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0]]), [[0, 1, 2], [0, 1, 3]])
    write_surface(tmp_path / "a.stl", flat)
    facets = (tmp_path / "a.stl").read_bytes()[84:]
    assert np.frombuffer(facets[:12], "<f4").tolist() == [0, 0, 0]
    assert np.frombuffer(facets[50:62], "<f4").tolist() == [0, 0, 1]


@pytest.mark.parametrize(
    ("name", "field", "cause"),
    [
        ("a.obj", "lat", "suffix"),
        ("a", "lat", "suffix"),
        ("a.ply", "x", "PLY property"),
        ("a.ply", "red", "PLY property"),
        ("a.ply", "two words", "PLY property"),
        ("a.pts", "two words", "name a file"),
        ("a.pts", "../up", "name a file"),
        ("a.vtp", "", "printable"),
        ("a.vtp", "two\nlines", "printable"),
    ],
)
def test_a_name_that_cannot_be_written_is_refused_and_nothing_is(
    name: str, field: str, cause: str, mesh: Mesh, column: Floats, tmp_path: Path
) -> None:
    with pytest.raises(OutputError, match=cause) as caught:
        write_surface(tmp_path / name, mesh, [FieldMap(mesh, column, field)])
    assert str(caught.value).startswith(f"{tmp_path / name}: ")
    assert not list(tmp_path.iterdir())


def test_fields_tags_and_axes_that_do_not_fit_are_refused(
    mesh: Mesh, column: Floats, tmp_path: Path
) -> None:
    path = tmp_path / "a.vtp"
    other = Mesh(mesh.vertices[:4], FACES[:2])
    field = FieldMap(mesh, column, "lat")
    with pytest.raises(OutputError, match="4 values for 5 vertices"):
        write_surface(path, mesh, [FieldMap(other, column[:4], "lat")])
    with pytest.raises(OutputError, match="share a name"):
        write_surface(path, mesh, [field, field])
    with pytest.raises(OutputError, match="tags have shape"):
        write_surface(path, mesh, tags=TAGS[:2])
    with pytest.raises(OutputError, match="choose LPS RAS unknown"):
        write_surface(path, mesh, space="LAS")
    rows = FieldMap(mesh, mesh.vertices, "lat")
    with pytest.raises(OutputError, match="several components"):
        write_surface(tmp_path / "a.pts", mesh, [rows])
    with pytest.raises(OutputError, match="share a PLY property"):
        write_surface(tmp_path / "a.ply", mesh, [rows, FieldMap(mesh, column, "lat_1")])
    assert not list(tmp_path.iterdir())


def test_a_place_that_cannot_be_written_is_named(mesh: Mesh, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(OutputError, match="cannot be written"):
        write_surface(tmp_path / "file" / "a.vtp", mesh)
