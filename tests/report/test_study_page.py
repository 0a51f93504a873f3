"""The page of a study: complete, escaped, the same again, and silent on what is not known."""

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from auricle.electroanatomy.points import MappingPoints
from auricle.electroanatomy.study import ElectroanatomicMap, ElectroanatomicStudy
from auricle.report.study_answer import field_answer, map_answers
from auricle.report.study_page import study_answers, study_page, write_map_study
from auricle.report.study_tables import fill_table, points_table, quantity_tables
from auricle.study.map_analysis import analyze_study
from auricle.study.map_study import MapStudy, MapStudyConfig
from auricle.study.result import Source
from auricle.surface.mesh import Mesh
from auricle.surface.reading import read_surface
from auricle.surface.shapes import icosphere
from auricle.surface.soup import TriangleSoup

BALL = icosphere(radius=30.0, subdivisions=2)
SURFACE = Mesh(BALL.vertices * [1.0, 0.9, 0.8], BALL.faces)
TIMES = (SURFACE.vertices[:, 0] + 30.0) / 0.6
VOLTAGE = 1.0 + SURFACE.vertices[:, 2] / 30.0


@pytest.fixture(autouse=True, scope="module")
def _coarse() -> Iterator[None]:
    """Small pictures: quicker to draw."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("auricle.report.maps.RESOLUTION", 40)
        patch.setattr("auricle.report.gallery.RESOLUTION", 40)
        yield


def a_map(name: str, count: int) -> ElectroanatomicMap:
    rows = np.random.default_rng(1).choice(SURFACE.n_vertices, count, replace=False)
    points = MappingPoints(
        SURFACE.vertices[rows],
        local_activation_time=TIMES[rows],
        bipolar_voltage=VOLTAGE[rows],
    )
    soup = TriangleSoup(
        SURFACE.vertices, SURFACE.faces, point_fields={"local_activation_time": TIMES}
    )
    return ElectroanatomicMap(name, soup, points)


@pytest.fixture(scope="module")
def study() -> MapStudy:
    """A map that is known, one of two points, one without points, one without a surface."""
    maps = (
        a_map("<b>LA</b>", 60),
        a_map("two", 2),
        replace(a_map("none", 3), points=MappingPoints(np.empty((0, 3)))),
        replace(a_map("bare", 5), surface=None),
    )
    return analyze_study(
        ElectroanatomicStudy("<i>X</i>", maps, ("files not read: 3",)),
        MapStudyConfig(n_modes=40, n_draws=20),
        source=Source("export", 12, "ab" * 32),
    )


@pytest.fixture(scope="module")
def folder(study, tmp_path_factory) -> Path:
    place = tmp_path_factory.mktemp("study")
    assert write_map_study(study, place) == place / "report.html"
    return place


class Checker(HTMLParser):
    """Every tag that is opened is closed, in order."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []

    def handle_starttag(self, tag, _attributes) -> None:
        if tag not in ("meta", "img", "br", "link"):
            self.open.append(tag)

    def handle_endtag(self, tag) -> None:
        assert self.open.pop() == tag


def test_the_page_is_whole_and_needs_nothing_from_elsewhere(folder) -> None:
    page = (folder / "report.html").read_text()
    checker = Checker()
    checker.feed(page)
    assert not checker.open
    assert not re.search(r"(src|href)=\"(?!data:)", page)
    assert "<script" not in page
    assert page.count("<img") == 8
    text = re.sub(r"data:[^\"]*", "", page)
    for words in ("<b>LA", "<i>X", "nan", "None"):
        assert words not in text
    assert "&lt;b&gt;LA&lt;/b&gt;" in page


def test_every_table_is_as_wide_as_its_head(study) -> None:
    tables = [points_table(study), fill_table(study)]
    tables += [
        table for one in study.maps for each in one.fields for table in quantity_tables(each)
    ]
    assert len(tables) > 5
    for table in tables:
        assert all(len(row) == len(table.head) for row in table.rows)


def test_of_what_is_not_known_no_number_is_told(study) -> None:
    two = study.maps[1]
    for field in two.fields:
        answer = field_answer(field)
        assert "say nothing of the map" in answer
        assert "%" not in answer
        (table,) = quantity_tables(field)
        assert not any("error" in row[0] or "andwidth" in row[0] for row in table.rows)
    assert "no mapping points" in map_answers(study.maps[2])[0]
    assert "no surface" in map_answers(study.maps[3])[0]


def test_a_known_map_is_answered_with_its_part_error_and_points(study) -> None:
    time, voltage = study_answers(study)[:2]
    assert re.search(r"\d+ % of the surface was mapped \([\d.]+ mm to the farthest", time)
    assert re.search(r"\d+ of its 60 points would have been enough", time)
    assert re.search(r"Conduction runs at 0\.\d+ m/s in the median \(0\.\d+ to 0\.\d+\)", time)
    assert re.search(r"Below 0\.5 mV lie [\d.]+ cm² \([\d.]+ to [\d.]+\)", voltage)


def test_the_folder_holds_tables_surfaces_and_numbers(folder) -> None:
    names = {path.name for path in folder.iterdir()}
    assert {"report.html", "result.json", "timings.json", "map_1.vtp", "map_2.vtp"} <= names
    assert "map_3.vtp" not in names
    assert "map_1_bipolar_voltage_points.csv" in names
    document = json.loads((folder / "result.json").read_text())
    assert [len(each["quantities"]) for each in document["maps"]] == [2, 2, 0, 0]
    assert document["maps"][1]["quantities"][0]["mapped_predicted_nrmse"] is None
    soup = read_surface(folder / "map_1.vtp")
    np.testing.assert_allclose(soup.point_fields["local_activation_time_vendor"], TIMES)
    assert soup.units["conduction_velocity"] == "m/s"
    assert "local_activation_time" not in read_surface(folder / "map_2.vtp").point_fields


def test_the_same_study_gives_the_same_page(study, folder) -> None:
    figures = {path.name: path.read_bytes() for path in (folder / "figures").iterdir()}
    assert study_page(study, figures) == (folder / "report.html").read_text()
