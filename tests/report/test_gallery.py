"""The figures as files: all there, small, the same every time, safe from a file's names."""

import io
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import matplotlib as mpl
import pytest
from matplotlib.image import imread

from auricle.report.gallery import figure_files
from auricle.surface.field import FieldMap

ALWAYS = {
    "spectrum.svg",
    "cumulative_power.svg",
    "geometry_error.svg",
    "field_error.svg",
    "surface_reconstruction.png",
}


@pytest.fixture(scope="module")
def files(case):
    return figure_files(case)


def test_every_figure_is_there_and_of_a_size_to_send(files):
    assert set(files) == ALWAYS | {"fields.png", "foci.png"}
    for name, content in files.items():
        assert len(content) < (300_000 if name.endswith(".svg") else 1_000_000), name


def test_figures_without_a_subject_are_left_out_and_the_others_counted(case):
    heard = []
    bare = replace(case, fields=(), simulated=(), reconstructions={})
    drawn = figure_files(bare, progress=lambda *stage: heard.append(stage))
    assert set(drawn) == ALWAYS
    assert heard == [("figures", done, 5) for done in range(6)]


def test_the_same_case_gives_the_same_bytes_whatever_the_readers_settings(case, files):
    with mpl.rc_context({"font.size": 30, "axes.facecolor": "red", "svg.hashsalt": None}):
        assert figure_files(case) == files


def test_files_carry_no_date_and_no_program(files):
    for name, content in files.items():
        for trace in (b"<dc:date>", b"Matplotlib v", b"Software", b"tIME"):
            assert trace not in content, (name, trace)


def test_charts_are_drawings_and_pictures_are_pixels(files):
    for name, content in files.items():
        if name.endswith(".svg"):
            assert ElementTree.fromstring(content).tag.endswith("svg")
            assert b"<text" not in content
        else:
            assert imread(io.BytesIO(content)).shape[1] == 1050


def test_a_hostile_field_name_neither_stops_nor_enters_a_figure(case):
    name = "_$\\frac{<script>&\n電" + "W" * 500
    first = case.fields[0]
    hostile = replace(
        first, name=name, title=name, field=FieldMap(case.surface, first.field.values, name)
    )
    files = figure_files(replace(case, fields=(hostile,), simulated=(), reconstructions={}))
    assert "fields.png" in files
    for name, content in files.items():
        assert b"<script" not in content
        if name.endswith(".svg"):
            ElementTree.fromstring(content)
