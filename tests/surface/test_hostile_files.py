import gzip
import os
import struct
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from auricle.errors import FormatError
from auricle.surface.formats.header import MOST_BYTES
from auricle.surface.formats.isolation import parse_isolated, run_child
from auricle.surface.reading import read_surface

VTK_TOP = b"# vtk DataFile Version 3.0\ntitle\n"
TRIANGLE = b"POINTS 3 float\n0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n3 0 1 2\n"
ASCII = VTK_TOP + b"ASCII\nDATASET POLYDATA\n"
BINARY = VTK_TOP + b"BINARY\nDATASET POLYDATA\n"
GRID = VTK_TOP + b"ASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\n"
LISTS = (
    b"# vtk DataFile Version 5.1\ntitle\nASCII\nDATASET POLYDATA\n" + TRIANGLE.partition(b"POLY")[0]
)
PLY_TOP = b"ply\nformat ascii 1.0\nelement vertex 3\n"
XYZ = b"property float x\nproperty float y\nproperty float z\n"
FACE = b"element face 1\nproperty list uchar int vertex_indices\nend_header\n"
PLY = PLY_TOP + XYZ + FACE
PLY_BINARY = PLY.replace(b"ascii", b"binary_little_endian")
CORNERS = b"0 0 0\n1 0 0\n0 1 0\n"
BINARY_CORNERS = np.eye(3, dtype="<f4").tobytes()
STL_FACET = (
    b"facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
)
OBJ = b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"


def vtp(
    positions: str = "0 0 0 1 0 0 0 1 0",
    *,
    points: object = 3,
    polygons: object = 1,
    corners: str = "0 1 2",
    offsets: str = "3",
    top: str = "",
    kind: str = "PolyData",
) -> bytes:
    return f"""<?xml version="1.0"?>{top}
<VTKFile type="{kind}" version="0.1" byte_order="LittleEndian"><{kind}>
<Piece NumberOfPoints="{points}" NumberOfPolys="{polygons}">
<Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">{positions}</DataArray>
</Points><Polys>
<DataArray type="Int64" Name="connectivity" format="ascii">{corners}</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">{offsets}</DataArray>
</Polys></Piece></{kind}></VTKFile>""".encode()


BOMB = '<!DOCTYPE a [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>'
APPENDED = (
    vtp()
    .replace(b'format="ascii">0 0 0 1 0 0 0 1 0', b'format="appended" offset="0">')
    .replace(b"</VTKFile>", b'<AppendedData encoding="raw">_' + struct.pack("<I", 36) + bytes(12))
)
END_OF_DATA = b"</AppendedData></VTKFile>"
HUGE_BLOCK = (
    vtp()
    .replace(b"LittleEndian", b'LittleEndian" compressor="vtkZLibDataCompressor')
    .replace(b'"ascii">0 0 0 1 0 0 0 1 0', b'"appended" offset="0">')
    .replace(b"</VTKFile>", b'<AppendedData encoding="raw">_' + b"\xff\xff\xff\xff" * 9)
    + END_OF_DATA
)
FACETS = 84 * b" "

HOSTILE: dict[str, tuple[str, bytes, str]] = {
    "legacy VTK that ends within its points": ("a.vtk", ASCII + TRIANGLE[:28], "bytes left"),
    "legacy VTK that ends within its last line": ("a.vtk", ASCII + TRIANGLE[:-5], "POLYGONS"),
    "legacy VTK in binary that is cut short": (
        "a.vtk",
        BINARY + b"POINTS 3 float\n" + bytes(20),
        "36 bytes or more, with 20 bytes left",
    ),
    "more points than numbers": ("a.vtk", ASCII + TRIANGLE.replace(b"S 3", b"S 4"), "'POLYGONS'"),
    "fewer points than numbers": ("a.vtk", ASCII + TRIANGLE.replace(b"S 3", b"S 2"), "9 numbers"),
    "a negative number of points": ("a.vtk", ASCII + TRIANGLE.replace(b"S 3", b"S -3"), "'-3'"),
    "a huge number of points": ("a.vtk", ASCII + TRIANGLE.replace(b"S 3", b"S 1000000000000"), ""),
    "a number of points beyond all integers": (
        "a.vtk",
        ASCII + TRIANGLE.replace(b"S 3", b"S 99999999999999999999"),
        "'99999999999999999999'",
    ),
    "decimal commas in VTK": ("a.vtk", ASCII + TRIANGLE.replace(b" 1", b" 0,5"), "comma"),
    "NaN positions in VTK": ("a.vtk", ASCII + TRIANGLE.replace(b" 1 0 0", b" nan 0 0"), "NaN"),
    "lists of cells that overrun": ("a.vtk", ASCII + TRIANGLE.replace(b"\n3 ", b"\n7 "), "lists"),
    "a negative list of cells": ("a.vtk", ASCII + TRIANGLE.replace(b"\n3 ", b"\n-3 "), "lists"),
    "cells of two corners": (
        "a.vtk",
        ASCII + TRIANGLE.replace(b"1 4\n3 0 1 2", b"1 3\n2 0 1"),
        "three corners",
    ),
    "fractional vertex indices": ("a.vtk", ASCII + TRIANGLE.replace(b"0 1 2", b"0 1 .5"), "whole"),
    "values for other points": ("a.vtk", ASCII + TRIANGLE + b"POINT_DATA 2\n", "2 point values"),
    "values for other cells": ("a.vtk", ASCII + TRIANGLE + b"CELL_DATA 2\n", "2 cell values"),
    "values of no type": (
        "a.vtk",
        BINARY + b"POINTS 3 complex\n",
        "'complex'",
    ),
    "offsets that run backwards": (
        "a.vtk",
        LISTS
        + b"POLYGONS 3 6\nOFFSETS vtktypeint64\n0 6 3\nCONNECTIVITY vtktypeint64\n0 1 2 0 1 2\n",
        "",
    ),
    "offsets without a name": ("a.vtk", LISTS + b"POLYGONS 2 3\n0 3\n0 1 2\n", "OFFSETS"),
    "a section nobody knows": ("a.vtk", ASCII + TRIANGLE + b"SURPRISE 1\n", "'SURPRISE'"),
    "a VTK version to come": ("a.vtk", ASCII.replace(b"3.0", b"9.0") + TRIANGLE, "version 9.0"),
    "binary VTK that says ASCII": (
        "a.vtk",
        ASCII + b"POINTS 3 float\n" + BINARY_CORNERS,
        "where the 9 numbers",
    ),
    "text VTK that says BINARY": ("a.vtk", BINARY + TRIANGLE, ""),
    "a volume in legacy VTK": (
        "a.vtk",
        ASCII.replace(b"POLYDATA", b"STRUCTURED_POINTS") + b"DIMENSIONS 2 2 2\n",
        "a volume, not a surface",
    ),
    "tetrahedra": (
        "a.vtk",
        GRID + b"CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n",
        "a volume mesh (1 tetrahedra), not a surface: extract its surface first",
    ),
    "curved cells": (
        "a.vtk",
        GRID + b"CELLS 1 7\n6 0 1 2 3 0 1\nCELL_TYPES 1\n22\n",
        "VTK types [22]",
    ),
    "an entity bomb": ("a.vtp", vtp("&b;", top=BOMB), "DTD"),
    "an external DTD": ("a.vtp", vtp(top='<!DOCTYPE VTKFile SYSTEM "http://x/y.dtd">'), "DTD"),
    "XML that is not well-formed": ("a.vtp", vtp()[:-20], "well-formed"),
    "XML nested without end": ("a.vtp", vtp(top="")[:22] + b"<a>" * 99, "of 'a'"),
    "VTK XML nested without end": ("a.vtp", vtp().partition(b"<Piece")[0] + b"<a>" * 99, "deep"),
    "XML of another kind": ("a.vtp", b"<html><body/></html>", "'html'"),
    "an image in XML": ("a.vtp", vtp(kind="ImageData"), "a volume, not a surface"),
    "a grid named .vtp": ("a.vtp", vtp(kind="UnstructuredGrid"), "rename it"),
    "legacy VTK named .vtp": ("a.vtp", ASCII + TRIANGLE, "well-formed"),
    "XML named .vtk": ("a.vtk", vtp(), "suffix"),
    "a huge number of points in XML": ("a.vtp", vtp(points=10**12), "announces"),
    "a negative number of points in XML": ("a.vtp", vtp(points=-3), "'-3'"),
    "fewer positions in XML than announced": ("a.vtp", vtp("0 0 0 1 0 0"), "9 values"),
    "more positions in XML than announced": ("a.vtp", vtp("0 0 0 " * 4), "9 values"),
    "decimal commas in XML": ("a.vtp", vtp("0 0 0 1 0 0 0 1 0,5"), "comma"),
    "no points in XML": ("a.vtp", vtp("", points=0, polygons=0, corners="", offsets=""), "no vert"),
    "XML offsets beyond the corners": ("a.vtp", vtp(offsets="600"), "not long enough"),
    "XML offsets below zero": ("a.vtp", vtp(offsets="-3"), "monotonically"),
    "XML with appended data cut short": ("a.vtp", APPENDED, "ends within its appended"),
    "XML with an appended array cut short": ("a.vtp", APPENDED + END_OF_DATA, "16 bytes left"),
    "XML with an appended array of another length": (
        "a.vtp",
        APPENDED.replace(b"_$", b"_\x0c") + END_OF_DATA,
        "36 bytes and then one of 12",
    ),
    "XML with a compressed block of 4 GiB": ("a.vtp", HUGE_BLOCK, "damaged"),
    "PLY with -5 vertices": ("a.ply", PLY.replace(b"x 3", b"x -5") + CORNERS + b"3 0 1 2", "'-5'"),
    "PLY with a huge number of faces": (
        "a.ply",
        PLY.replace(b"e 1", b"e 4000000000000") + CORNERS + b"3 0 1 2\n",
        "bytes left",
    ),
    "PLY that ends early": ("a.ply", PLY + CORNERS, "left"),
    "PLY that goes on": ("a.ply", PLY + CORNERS + b"3 0 1 2\n3 0 1 2\n", "goes on"),
    "PLY lines of other lengths": ("a.ply", PLY + b"0 0\n0 1 0 0\n0 1 0\n3 0 1 2\n", "2 of the 3"),
    "PLY lines with a number to spare": (
        "a.ply",
        PLY + CORNERS.replace(b"1 0 0", b"1 0 0 7") + b"3 0 1 2\n",
        "4 of the 3",
    ),
    "PLY with decimal commas": ("a.ply", PLY + CORNERS.replace(b"1", b"0,5") + b"3 0 1 2", "comma"),
    "PLY with a negative list": ("a.ply", PLY + CORNERS + b"-3 0 1 2\n", "'-3'"),
    "PLY faces of two corners": ("a.ply", PLY + CORNERS + b"2 0 1   \n", "three corners"),
    "PLY without faces": ("a.ply", PLY_TOP + XYZ + b"end_header\n" + CORNERS, "no face"),
    "PLY without positions": ("a.ply", PLY.replace(b"float z", b"float w") + CORNERS, "property z"),
    "PLY without an end": ("a.ply", PLY[:-12], ""),
    "PLY of a property twice": ("a.ply", PLY.replace(b"t y", b"t x") + CORNERS, "twice"),
    "PLY cut short in binary": ("a.ply", PLY_BINARY + BINARY_CORNERS[:-3], "left"),
    "PLY lists that lie in binary": (
        "a.ply",
        PLY_BINARY.replace(b"e 1", b"e 3")
        + BINARY_CORNERS
        + struct.pack("<B3iB4iB2i", 3, 0, 1, 2, 4, 0, 1, 2, 0, 2, 0, 1),
        "several sizes",
    ),
    "a page of HTML named .ply": ("a.ply", b"<html></html>", "not a PLY file"),
    "STL that announces more": (
        "a.stl",
        FACETS[:80] + struct.pack("<I", 9) + bytes(50),
        "9 facets",
    ),
    "STL that announces too much": (
        "a.stl",
        FACETS[:80] + b"\xff" * 4 + bytes(50),
        "4,294,967,295",
    ),
    "STL of no facets": ("a.stl", FACETS[:80] + bytes(4), "no vertices"),
    "STL cut short": ("a.stl", FACETS[:80] + struct.pack("<I", 2) + bytes(99), "holds 183"),
    "STL text cut short": ("a.stl", b"solid a\n" + STL_FACET[:90], "ends within"),
    "STL text of words": ("a.stl", b"solid a\nthis is no facet\nendsolid\n", "'this is"),
    "STL text with commas": (
        "a.stl",
        b"solid a\n" + STL_FACET.replace(b"x 1", b"x 1,5") + b"endsolid\n",
        "comma",
    ),
    "OBJ that counts from 0": ("a.obj", OBJ + b"f 0 1 2\n", "counts from 1"),
    "OBJ that counts backwards": ("a.obj", OBJ + b"f -3 -2 -1\n", "absolute"),
    "OBJ that names no vertex": ("a.obj", OBJ + b"f 1 2 300\n", "vertex 300 of 3"),
    "OBJ with commas": ("a.obj", OBJ + b"v 0,5 1 1\nf 1 2 3\n", "comma"),
    "OBJ of two coordinates": ("a.obj", OBJ + b"v 1 2\nf 1 2 3\n", "three coordinates"),
    "OBJ without faces": ("a.obj", OBJ, "no faces"),
    "OBJ of binary noise": ("a.obj", bytes(range(256)) * 40, "'\\x00"),
    "OFF with fewer lines": (
        "a.off",
        b"OFF\n4 1 0\n" + CORNERS + b"3 0.0000 1 2\n",
        "ends, or has fewer",
    ),
    "OFF with more lines": ("a.off", b"OFF\n3 1 0\n" + CORNERS + b"3 0 1 2\n3 0 1 2\n", "goes on"),
    "OFF with huge counts": ("a.off", b"OFF\n3000000000 1 0\n" + CORNERS, "bytes"),
    "OFF with negative counts": ("a.off", b"OFF\n-3 1 0\n" + CORNERS, "'-3'"),
    "OFF that names no vertex": ("a.off", b"OFF\n3 1 0\n" + CORNERS + b"3 0 1 9\n", "outside"),
    "OFF without OFF": ("a.off", b"3 1 0\n" + CORNERS + b"3 0 1 2\n", "suffix"),
    "a file of nothing": ("a.ply", b"", "empty"),
    "a suffix nobody knows": ("a.step", b"ISO-10303-21;", "suffix"),
    "no suffix at all": ("a", b"ply", "suffix"),
    "a NIfTI volume": ("a.nii", bytes(400), "a volume, not a surface"),
    "a packed NIfTI volume": ("a.NII.GZ", gzip.compress(bytes(400)), "a volume, not a surface"),
    "a packed surface": ("a.vtk.gz", gzip.compress(ASCII + TRIANGLE), "suffix"),
    "a MetaImage": ("a.mhd", b"ObjectType = Image\n", "a volume"),
    "a name of two lines": ("a\nb.ply", b"nothing", "not a PLY"),
}


def refusal(path: Path) -> str:
    start = time.perf_counter()
    with pytest.raises(FormatError) as caught:
        read_surface(path)
    assert time.perf_counter() - start < 10
    message = str(caught.value)
    assert message.startswith(str(path).replace("\n", "\\n") + ": ")
    assert message.isprintable()
    return message


@pytest.mark.parametrize("case", HOSTILE)
def test_a_hostile_file_is_refused_in_one_line_that_begins_with_its_path(
    case: str, tmp_path: Path
) -> None:
    name, content, cause = HOSTILE[case]
    (tmp_path / name).write_bytes(content)
    assert cause in refusal(tmp_path / name)


def test_a_missing_file_a_folder_and_a_device_are_refused(tmp_path: Path) -> None:
    assert "no such file" in refusal(tmp_path / "none.vtp")
    (tmp_path / "folder.vtp").mkdir()
    assert "not a file" in refusal(tmp_path / "folder.vtp")
    os.mkfifo(tmp_path / "pipe.vtp")
    assert "not a file" in refusal(tmp_path / "pipe.vtp")


def test_a_file_beyond_the_size_limit_is_refused_unread(tmp_path: Path) -> None:
    with (tmp_path / "sparse.stl").open("wb") as file:
        file.truncate(MOST_BYTES + 1)
    assert "2,147,483,648" in refusal(tmp_path / "sparse.stl")


PTS = b"3\n0 0 0\n1000 0 0\n0 1000 0\n"
ELEM = b"1\nTr 0 1 2 11\n"
HOSTILE_PAIRS: dict[str, tuple[dict[str, bytes], str]] = {
    "nodes without elements": ({"la.pts": PTS}, "la.elem"),
    "fewer nodes than announced": ({"la.pts": PTS[:-9], "la.elem": ELEM}, "bytes left"),
    "more nodes than announced": ({"la.pts": PTS + b"0 0 0\n", "la.elem": ELEM}, "holds 4"),
    "a negative number of nodes": ({"la.pts": b"-3\n", "la.elem": ELEM}, "'-3'"),
    "no number of nodes": ({"la.pts": PTS[2:], "la.elem": ELEM}, "'0 0 0'"),
    "no nodes": ({"la.pts": b"", "la.elem": ELEM}, "empty"),
    "a huge number of elements": ({"la.pts": PTS, "la.elem": b"9" * 12 + b"\n"}, "bytes left"),
    "decimal commas": ({"la.pts": PTS.replace(b"1000", b"1,5"), "la.elem": ELEM}, "'1,5'"),
    "nodes of two numbers": (
        {"la.pts": PTS.replace(b"1000 0 0", b"1000 10"), "la.elem": ELEM},
        "2",
    ),
    "tetrahedra": ({"la.pts": PTS, "la.elem": b"1\nTt 0 1 2 2 1\n"}, "1 'Tt' elements"),
    "fractional indices": ({"la.pts": PTS, "la.elem": b"1\nTr 0 1.0 2 1\n"}, "'1.0'"),
    "elements of two nodes": ({"la.pts": PTS, "la.elem": b"1\nTr 0 0001\n"}, "2 numbers, not 3"),
    "binary noise": ({"la.pts": b"3\n" + bytes(range(128, 255)), "la.elem": ELEM}, ""),
    "a field of another mesh": (
        {"la.pts": PTS, "la.elem": ELEM, "la_lat.dat": b"1\n2\n"},
        "2 values in la_lat.dat for 3 nodes",
    ),
    "a field of words": (
        {"la.pts": PTS, "la.elem": ELEM, "la.dat": b"1\nearly\n3\n"},
        "'early'",
    ),
    "a field in two files": (
        {"la.pts": PTS, "la.elem": ELEM, "la_v.dat": b"1\n2\n3\n", "la.v.dat": b"1\n2\n3\n"},
        "two files of the field 'v'",
    ),
}


@pytest.mark.parametrize("case", HOSTILE_PAIRS)
def test_a_hostile_opencarp_pair_is_refused(case: str, tmp_path: Path) -> None:
    files, cause = HOSTILE_PAIRS[case]
    for name, content in files.items():
        (tmp_path / name).write_bytes(content)
    assert cause in refusal(tmp_path / "la.pts")


def test_a_child_that_crashes_fails_or_hangs_costs_one_line() -> None:
    def child(program: str) -> list[str]:
        return [sys.executable, "-c", program]

    run_child(child("pass"), seconds=20)
    with pytest.raises(FormatError, match=r"crash \(SIGSEGV\).*damaged"):
        run_child(child("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)"), seconds=20)
    with pytest.raises(FormatError, match=r"fail \(KeyError: 'face'\)"):
        run_child(child("{}['face']"), seconds=20)
    with pytest.raises(FormatError, match="memory"):
        run_child(child("raise MemoryError"), seconds=20)
    with pytest.raises(FormatError, match=r"^no\.$"):
        run_child(child("import sys; sys.stderr.write('noise\\nno.\\n'); sys.exit(3)"), seconds=20)
    with pytest.raises(FormatError, match="longer than 0 s"):
        run_child(child("import time; time.sleep(20)"), seconds=0.2)


def test_a_list_that_makes_vtk_read_beyond_its_memory_is_survived(tmp_path: Path) -> None:
    path = tmp_path / "a.vtk"
    path.write_bytes(ASCII + TRIANGLE.replace(b"\n3 ", b"\n300000000 "))
    with pytest.raises(FormatError):
        parse_isolated(".vtk", path)
