"""The page of a plan: true to the plan, complete, safe against what files hold."""

import csv
import io
import json
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from auricle.errors import OutputError
from auricle.report.plan_figures import plan_picture
from auricle.report.plan_page import CAPTIONS, plan_answer, plan_page, points_csv, write_plan
from auricle.report.wording import percent
from auricle.study.plan_result import PlanConfig, PlanResult
from auricle.study.planning import plan_surface
from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere
from auricle.surface.writing import write_surface

FIGURES = {name: f"<{name}>".encode() for name in CAPTIONS}
HOSTILE = "<img src=x onerror=alert(1)>\"'&\u202e\ud800</td>"


@pytest.fixture(autouse=True)
def _coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small pictures: quicker to draw."""
    monkeypatch.setattr("auricle.report.maps.RESOLUTION", 50)


class Outline(HTMLParser):
    """Elements of a page and its text; complains of elements not closed in order."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self.feed(page)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        if tag not in {"meta", "img", "br", "link"}:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag
        self.text += " " if tag in ("td", "th", "p", "h3") else ""

    def handle_data(self, data):
        self.text += data if self.open and self.open[-1] != "style" else ""

    def count(self, tag: str) -> int:
        return sum(name == tag for name, _ in self.elements)


def words(page: str) -> str:
    return " ".join(Outline(page).text.split())


@pytest.fixture(scope="module")
def surface(tmp_path_factory) -> Path:
    sphere = icosphere(radius=30.0, subdivisions=3)
    x, y, z = sphere.vertices.T / 30
    mesh = Mesh(sphere.vertices * (1 + 0.15 * x * y + 0.1 * z**3)[:, None], sphere.faces)
    fields = [FieldMap(mesh, (x > 0).astype(float), "left"), FieldMap(mesh, 30 * x * y, "LAT")]
    place = tmp_path_factory.mktemp("plan") / "chamber.vtp"
    write_surface(place, mesh, fields)
    return place


def planned(surface: Path, **parameters) -> PlanResult:
    return plan_surface(surface, PlanConfig(n_vertices=700, n_modes=80, **parameters))


@pytest.fixture(scope="module")
def plan(surface) -> PlanResult:
    return planned(surface, map_class="gaussian", parameters={"width_mm": 14}, target_nrmse=0.2)


@pytest.fixture(scope="module")
def unreachable(surface) -> PlanResult:
    return planned(surface, map_class="disc", target_nrmse=0.05)


@pytest.fixture(scope="module")
def with_catheter(surface) -> PlanResult:
    return planned(surface, bandwidth=12, catheter="grid", forbid="left", n_samples=30)


def test_the_page_begins_with_the_answer_and_holds_the_plan(plan):
    text = words(plan_page(plan, FIGURES))
    assert plan_answer(plan) in text
    advised = plan.recommendation
    assert f"Take {advised.n_samples} points, evenly spread" in plan_answer(plan)
    assert f"{percent(plan.plan.predicted_nrmse)} of the map's deviation" in text
    assert f"{plan.plan.coverage.radius_mm:.2g} mm" in text
    assert "Williams et al. 2018" in text
    assert plan.prepared.source.sha256 in text
    assert text.count("not a medical device") >= 2
    for (target, how), each in plan.by_target.items():
        if how == "planned" and each.n_samples is not None:
            assert f"{percent(target)} {each.n_samples:,}" in text


def test_an_error_out_of_reach_is_said_with_its_reason_and_no_point_is_promised(unreachable):
    answer = plan_answer(unreachable)
    assert answer.startswith("No number of points maps discs with a sharp edge")
    assert unreachable.recommendation.unreachable in answer
    text = words(plan_page(unreachable, {}))
    assert "unreachable" in text
    assert "Points planned" not in text
    assert points_csv(unreachable) == "order,x_mm,y_mm,z_mm\n"


def test_a_plan_that_differs_from_the_number_recommended_says_what_it_is_worth(with_catheter):
    answer = plan_answer(with_catheter)
    placements = len(with_catheter.placements.centres)
    assert answer.startswith("It takes 24 points")
    assert f"{len(with_catheter.positions)} electrodes in {placements} placements" in answer
    error = percent(with_catheter.plan.predicted_nrmse)
    assert f"plain least squares on them errs by {error}" in answer
    text = words(plan_page(with_catheter, {}))
    assert "no point is placed where left is not 0" in text
    assert f"{with_catheter.placements.n_off} electrodes of it fall off the surface" in text


def test_a_catheters_points_name_their_placement_and_electrode(with_catheter):
    rows = list(csv.DictReader(io.StringIO(points_csv(with_catheter))))
    assert len(rows) == len(with_catheter.positions)
    assert [int(row["order"]) for row in rows] == list(range(1, len(rows) + 1))
    assert {int(row["electrode"]) for row in rows} <= set(range(1, 17))
    placements = [int(row["placement"]) for row in rows]
    assert placements == sorted(placements)
    assert placements[0] == 1


def test_points_are_those_of_the_plan_to_a_thousandth_of_a_mm(plan):
    rows = list(csv.DictReader(io.StringIO(points_csv(plan))))
    read = np.array([[float(row[f"{axis}_mm"]) for axis in "xyz"] for row in rows])
    np.testing.assert_allclose(read, plan.positions, atol=5.1e-4)


def test_nothing_is_loaded_from_anywhere_and_nothing_runs(plan):
    outline = Outline(plan_page(plan, FIGURES))
    for tag in ("script", "link", "iframe", "form", "object", "a"):
        assert outline.count(tag) == 0
    for _, attributes in outline.elements:
        assert attributes.get("src", "data:").startswith("data:")
        assert not any(name.startswith("on") for name in attributes)
    assert outline.count("img") == len(FIGURES)
    assert outline.count("table") == outline.count("caption") == 3


@pytest.mark.parametrize("where", ["file", "wanted", "remark", "forbidden"])
def test_what_a_file_holds_is_text_and_never_markup(plan, where):
    prepared = plan.prepared
    changed = {
        "file": {"prepared": replace(prepared, source=replace(prepared.source, name=HOSTILE))},
        "wanted": {"wanted": HOSTILE},
        "remark": {"remarks": (HOSTILE,)},
        "forbidden": {"config": replace(plan.config, forbid=HOSTILE)},
    }[where]
    page = plan_page(replace(plan, **changed), {})
    assert Outline(page).count("img") == 0
    assert "&lt;img src=x onerror" in page
    page.encode("utf-8")


def test_the_same_plan_gives_the_same_page_whatever_time_it_took(plan):
    later = replace(plan, seconds={"plan": 123.456})
    assert plan_page(later, FIGURES) == plan_page(plan, FIGURES)


def test_the_folder_is_complete_and_its_numbers_are_finite(plan, tmp_path):
    told = []
    write_plan(plan, tmp_path / "out", progress=lambda *stage: told.append(stage))
    names = {path.relative_to(tmp_path / "out").as_posix() for path in tmp_path.rglob("*.*")}
    assert names == {
        "report.html",
        "result.json",
        "timings.json",
        "points.csv",
        "surface.vtp",
        *(f"figures/{name}" for name in CAPTIONS),
    }
    assert [stage[0] for stage in told] == ["figures"] * 4

    def refused(constant):
        raise AssertionError(constant)

    document = json.loads((tmp_path / "out/result.json").read_text(), parse_constant=refused)
    assert document["n_samples"] == plan.recommendation.n_samples
    assert "wall_s" not in document
    assert "wall_s" in json.loads((tmp_path / "out/timings.json").read_text())


def test_a_plan_without_points_has_no_picture_of_them(unreachable, tmp_path):
    """And without an error that can be reached, no curve of them."""
    never = {
        key: replace(each, n_samples=None, spacing_mm=None)
        for key, each in unreachable.by_target.items()
    }
    write_plan(replace(unreachable, by_target=never), tmp_path / "out")
    assert [each.name for each in (tmp_path / "out/figures").iterdir()] == ["tail.svg"]


def test_a_plan_of_a_bandwidth_has_a_picture_without_an_example(with_catheter):
    figure = plan_picture(with_catheter)
    assert "such a map" not in [axes.get_ylabel() for axes in figure.axes]
    assert figure.legends[0].texts[0].get_text() == "planned points"


def test_a_folder_that_cannot_be_written_is_an_output_error(plan, tmp_path, monkeypatch):
    monkeypatch.setattr("auricle.report.plan_page.drawn_files", lambda *_: {})
    (tmp_path / "out").write_text("mine")
    with pytest.raises(OutputError):
        write_plan(plan, tmp_path / "out")
