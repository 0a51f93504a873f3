import csv
import io
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from auricle.study.preparation import prepare_soup
from auricle.study.result import Source
from auricle.surface.distance import vertexwise_rms
from auricle.surface.shapes import icosphere
from auricle.surface.simplification import simplification_sequence
from auricle.surface.soup import TriangleSoup
from auricle.viewer.built_page import exported_page
from auricle.viewer.bundle import surface_bundle
from auricle.viewer.open_case import OpenCase

MARKUP = "<img src=x onerror=alert(1)>"
PIXELS = "window.explore.pixels().sum"
DESK = {"width": 1000, "height": 640}


@dataclass(frozen=True)
class Lobed:
    """A lobed surface with a voltage, of which a part is not sampled, and a field named badly."""

    case: OpenCase
    file: Path

    def shape(self, count: int):
        surface, basis = self.case.prepared.surface, self.case.prepared.chamber.basis
        centre = basis.areas @ surface.vertices / basis.area
        return basis.inverse(basis.transform(surface.vertices - centre)[:count]) + centre

    def rms(self, count: int) -> float:
        surface, basis = self.case.prepared.surface, self.case.prepared.chamber.basis
        return vertexwise_rms(self.shape(count), surface.vertices, basis.areas)


@pytest.fixture(scope="module")
def lobed(tmp_path_factory: pytest.TempPathFactory) -> Lobed:
    ball = icosphere(radius=1.0, subdivisions=3)
    x, y, z = ball.vertices.T
    radii = 20 + 5 * np.sin(3 * x + 1) * np.cos(4 * z) + 3 * y**3
    voltage = np.where(y > 0.9, np.nan, 1.5 + np.sin(3 * x) * np.cos(2 * z))
    soup = TriangleSoup(
        vertices=ball.vertices * radii[:, None] + [5.0, -80.0, 30.0],
        faces=ball.faces,
        point_fields={"bipolar_voltage": voltage, MARKUP: x},
        units={"bipolar_voltage": "mV"},
        space="unknown",
    )
    prepared = prepare_soup(soup, Source("lobed.vtp", 1, "0" * 64), n_modes=90)
    case = OpenCase(f"lobed {MARKUP}", prepared, remarks=(f"a remark {MARKUP}",))
    bundle = surface_bundle(prepared, name=case.name, remarks=case.remarks)
    file = tmp_path_factory.mktemp("export") / "page.html"
    file.write_text(exported_page(bundle), encoding="utf-8")
    return Lobed(case, file)


@pytest.fixture(scope="module")
def from_disk(lobed, chromium):
    """The exported page, opened from the disk without a network, and what its console said."""
    context = chromium.new_context(viewport=DESK, offline=True)
    page = context.new_page()
    page.set_default_timeout(60_000)
    complaints: list[str] = []
    page.on("console", lambda said: complaints.append(said.text) if said.type == "error" else None)
    page.on("pageerror", lambda fault: complaints.append(str(fault)))
    page.goto(lobed.file.as_uri())
    page.wait_for_selector("html[data-ready=true]")
    page.evaluate("window.begun = JSON.stringify(window.explore.current().saved())")
    yield page, complaints
    context.close()


@pytest.fixture
def exported(from_disk):
    """The same as it was when it was opened; its console may not complain of a test."""
    page, complaints = from_disk
    page.set_viewport_size(DESK)
    page.evaluate("window.explore.current().restore(JSON.parse(window.begun))")
    yield page
    assert complaints == []


def fact(page, name: str) -> float:
    return float(page.locator(f"[data-fact={name}]").inner_text().split()[0].strip("≈"))


def slide(page, count: int) -> None:
    page.evaluate("count => window.explore.slide(count)", count)


def test_the_slider_changes_the_surface_and_the_numbers_of_an_exported_page(exported, lobed):
    seen = []
    for count in (5, 30, 90, 30):
        slide(exported, count)
        assert fact(exported, "shape-rms") == pytest.approx(lobed.rms(count), rel=2e-3)
        seen.append(exported.evaluate(PIXELS))
    assert seen[1] == seen[3]
    assert len(set(seen)) == 3


def test_pictures_are_coarse_only_while_the_slider_moves_and_drawing_is_slow(exported):
    moved = """(slow) => {
      const explorer = window.explore.current();
      explorer.stage.slow = slow;
      explorer.setCount(explorer.state.count === 20 ? 21 : 20);
      return explorer.stage.canvas.width;
    }"""
    width = "window.explore.current().stage.canvas.width"
    exported.wait_for_timeout(600)
    whole = exported.evaluate(width)
    assert exported.evaluate(moved, False) == whole
    assert exported.evaluate(moved, True) == whole // 2
    exported.wait_for_timeout(1_000)
    assert exported.evaluate(width) == whole


def test_only_pictures_that_change_are_drawn(exported):
    slide(exported, 20)
    exported.evaluate(PIXELS)
    drawn = exported.evaluate(
        """() => {
          const explorer = window.explore.current();
          const { stage } = explorer;
          stage.slow = false;
          const seen = [];
          const draw = stage.renderer.render.bind(stage.renderer);
          stage.renderer.render = (scene, camera) => {
            seen.push(stage.panes.findIndex((pane) => pane.scene === scene));
            draw(scene, camera);
          };
          explorer.setCount(21);
          stage.renderer.render = draw;
          return seen;
        }"""
    )
    assert drawn == [1, 2], "harmonics and points, not the original"


def test_a_page_that_is_served_shows_the_same(serve, browsing, lobed):
    page = browsing.open(serve(lobed.case).address)
    slide(page, 12)
    assert fact(page, "shape-rms") == pytest.approx(lobed.rms(12), rel=2e-3)


def test_the_points_beside_the_harmonics_are_those_of_the_simplification(exported, lobed):
    slide(exported, 40)
    shown = exported.evaluate("Array.from(window.explore.current().level.positions)")
    level = simplification_sequence(lobed.case.prepared.surface).mesh_at(40)
    np.testing.assert_allclose(np.reshape(shown, (-1, 3)), level.vertices, atol=1e-4)
    faces = exported.evaluate("Array.from(window.explore.current().level.faces)")
    assert np.reshape(faces, (-1, 3)).tolist() == level.faces.tolist()


def test_a_click_on_the_spectrum_chooses_the_number_of_harmonics(exported):
    box = exported.locator(".charts .plot").first.locator(".plot-frame").bounding_box()
    exported.mouse.click(box["x"] + box["width"] * 2 / 3, box["y"] + 20)
    assert exported.locator("output").first.inner_text() == "60"
    assert exported.locator(".view-explore").get_attribute("data-count") == "60"


def test_markup_in_names_stays_text(exported):
    assert exported.locator("img").count() == 0
    assert exported.locator("h1").inner_text() == f"lobed {MARKUP}"
    exported.get_by_label("Map", exact=True).select_option(MARKUP)
    assert exported.locator(".bar-title").first.inner_text() == MARKUP
    assert exported.locator(".remarks li").text_content() == f"a remark {MARKUP}"
    assert exported.locator("img").count() == 0


def test_colours_have_limits_bands_and_a_grey_for_what_is_not_sampled(exported):
    assert "not sampled" in exported.locator(".colour-bar").first.inner_text()
    before = exported.evaluate(PIXELS)
    exported.get_by_label("To", exact=True).fill("5")
    exported.get_by_label("To", exact=True).press("Enter")
    assert exported.evaluate(PIXELS) != before
    assert exported.locator(".colour-bar text").last.text_content() == "5"
    exported.get_by_label("Palette").select_option("classic")
    exported.get_by_label("Bands").fill("4")
    exported.get_by_label("Bands").press("Enter")
    assert exported.locator(".colour-bar").first.locator("svg[role=img] rect").count() == 4 + 1


def test_keys_do_what_the_help_lists(exported):
    front = exported.evaluate(PIXELS)
    exported.locator(".stage-hand").press("2")
    back = exported.evaluate(PIXELS)
    exported.locator(".stage-hand").press("ArrowLeft")
    assert len({front, back, exported.evaluate(PIXELS)}) == 3
    exported.locator(".stage-hand").press("1")
    assert exported.evaluate(PIXELS) == front
    exported.get_by_label("Number of harmonics k").press("ArrowRight")
    exported.wait_for_selector(".view-explore[data-count='51']")
    exported.keyboard.press("?")
    assert "standard views" in exported.get_by_role("dialog").inner_text()
    exported.keyboard.press("Escape")


def test_the_state_is_saved_and_comes_back(exported, tmp_path):
    begun = exported.evaluate(PIXELS)
    slide(exported, 33)
    exported.get_by_role("button", name="PA", exact=True).click()
    exported.get_by_label("Cut across").select_option("0")
    exported.get_by_label("Palette").select_option("classic")
    expected = exported.evaluate(PIXELS)
    with exported.expect_download() as saved:
        exported.get_by_role("button", name="Save", exact=True).click()
    state = tmp_path / "state.json"
    saved.value.save_as(state)
    assert json.loads(state.read_text())["views"]["explore"]["count"] == 33
    exported.evaluate("window.explore.current().restore(JSON.parse(window.begun))")
    assert exported.evaluate(PIXELS) == begun != expected
    exported.get_by_label("State file").set_input_files(state)
    exported.wait_for_selector(".view-explore[data-count='33']")
    assert exported.evaluate(PIXELS) == expected
    state.write_text('{"format": "other"}')
    exported.get_by_label("State file").set_input_files(state)
    assert "not a saved state" in exported.locator(".toast.bad").inner_text()
    exported.get_by_role("button", name="Dismiss").click()


def test_tables_hold_what_is_seen(exported, lobed):
    slide(exported, 20)
    with exported.expect_download() as saved:
        exported.get_by_role("button", name="Vertices (CSV)").click()
    rows = list(csv.DictReader(io.StringIO(Path(saved.value.path()).read_text())))
    assert len(rows) == lobed.case.prepared.surface.n_vertices
    written = [[float(row[f"{axis}_20_harmonics_mm"]) for axis in "xyz"] for row in rows]
    np.testing.assert_allclose(written, lobed.shape(20), atol=5e-3)
    unsampled = sum(row["bipolar_voltage_mV"] == "" for row in rows)
    assert unsampled == np.isnan(lobed.case.prepared.field("bipolar_voltage").values).sum() > 0
    with exported.expect_download() as saved:
        exported.get_by_role("button", name="Spectrum (CSV)").click()
    spectrum = list(csv.DictReader(io.StringIO(Path(saved.value.path()).read_text())))
    assert len(spectrum) == 90
    assert float(spectrum[19]["geometry_rms_error_mm"]) == pytest.approx(lobed.rms(20), rel=1e-3)
    with exported.expect_download() as saved:
        exported.get_by_role("button", name="Picture (PNG)").click()
    content = Path(saved.value.path()).read_bytes()
    assert content.startswith(b"\x89PNG")
    left = exported.locator(".colour-bar").first.bounding_box()["x"]
    stage = exported.locator(".stage").bounding_box()
    width = int.from_bytes(content[16:20], "big")
    assert width == round(stage["x"] + stage["width"] - left), "the colour bar is in the picture"


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing_wrong(exported, scheme):
    from axe_playwright_python.sync_playwright import Axe

    exported.emulate_media(color_scheme=scheme)
    found = Axe().run(exported).response["violations"]
    assert [(each["id"], [node["target"] for node in each["nodes"]]) for each in found] == []


def test_a_telephone_shows_the_surface_and_the_slider_at_once(exported):
    exported.set_viewport_size({"width": 390, "height": 800})
    assert exported.evaluate("document.documentElement.scrollWidth") == 390
    for seen in (".stage canvas", "input[type=range]"):
        box = exported.locator(seen).first.bounding_box()
        assert box["y"] >= 0
        assert box["y"] + box["height"] <= 800
