"""Plan and map in a browser: clicks become samples, the map follows, undo takes it back."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from auricle.sampling.samples import Samples
from auricle.viewer.open_case import OpenCase, Recording

Serve = Callable[..., Any]


def values_at(positions: np.ndarray) -> np.ndarray:
    x, y, z = positions.T / 20.0
    return 40.0 + 20.0 * x + 10.0 * y * z


@pytest.fixture
def planning(serve: Serve, browsing: Any, ball: OpenCase) -> Any:
    """The view, open on a sphere with a map and a recording of 40 points."""
    directions = np.random.default_rng(5).standard_normal((40, 3))
    positions = 20 * directions / np.linalg.norm(directions, axis=1)[:, None]
    recording = Recording(Samples(positions, values_at(positions), name="<b>LAT</b>", unit="ms"))
    case = OpenCase("<i>ball</i>", ball.prepared, (recording,))
    browsing.open(serve(case, name="<i>ball</i>").address)
    page = browsing.page
    page.get_by_role("button", name="Plan and map").click()
    page.wait_for_selector(".view-plan[data-ready=true]")
    return page


def pixels(page: Any) -> int:
    """A sum over the picture once the layout has settled: a chart appears with the second error."""
    page.evaluate("new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(r)))")
    return int(page.evaluate("window.plan.planner.pictures.stage.pixels().sum"))


def fact(page: Any, name: str) -> str:
    return str(page.locator(f".view-plan [data-fact={name}]").first.inner_text())


def taken(browsing: Any, count: int) -> None:
    live = "window.plan.planner.live"
    browsing.until(
        f"{live}.state?.n_taken === {count} && {live}.judgement?.n_taken === {count}"
        f" && {live}.quiet"
    )


def click_on_the_surface(page: Any, across: float, down: float) -> None:
    """Clicks so many mm from the middle of the left picture."""
    spot = page.evaluate(
        f"(() => {{ const s = window.plan.planner.pictures.stage;"
        f" const at = s.project([{across}, 0, {-down}]);"
        f" const box = s.element.getBoundingClientRect();"
        f" return [at.x + box.left, at.y + box.top]; }})()"
    )
    page.mouse.click(*spot)


def test_a_click_takes_a_sample_and_undo_restores_the_picture(planning: Any, browsing: Any) -> None:
    page = planning
    for index, (across, down) in enumerate([(0, 0), (10, 0), (-10, 2), (3, 12), (-4, -12), (9, 9)]):
        click_on_the_surface(page, across, down)
        taken(browsing, index + 1)
    before, error = pixels(page), fact(page, "predicted")
    assert "samples say too little" not in page.locator(".verdict").inner_text()
    click_on_the_surface(page, -12, -8)
    taken(browsing, 7)
    assert pixels(page) != before
    assert fact(page, "predicted") != error
    assert fact(page, "taken") == "7"
    page.get_by_role("button", name="Undo").click()
    taken(browsing, 6)
    assert pixels(page) == before
    assert fact(page, "predicted") == error
    page.keyboard.press("Control+y")
    taken(browsing, 7)
    assert pixels(page) != before
    assert browsing.violations() == []


def test_a_plan_says_how_many_points_and_taking_them_is_enough(
    planning: Any, browsing: Any
) -> None:
    page = planning
    page.get_by_label("Kind of map").select_option("bandwidth")
    page.get_by_label("Harmonics").fill("9")
    page.get_by_label("Error to reach").fill("20")
    page.get_by_label("Error to reach").press("Tab")
    bare = pixels(page)
    page.get_by_role("button", name="Plan", exact=True).click()
    page.wait_for_selector("[data-fact=needed]")
    needed = int(fact(page, "needed"))
    assert 9 < needed < 60
    assert pixels(page) != bare
    page.get_by_role("button", name="Take them").click()
    taken(browsing, needed)
    assert fact(page, "verdict") == "Enough"
    assert float(fact(page, "true-error").removesuffix(" %")) < 20
    assert browsing.violations() == []


def test_a_study_is_played_back_and_says_when_it_was_enough(planning: Any, browsing: Any) -> None:
    page = planning
    page.get_by_label("Error to reach").fill("25")
    page.get_by_label("Error to reach").press("Tab")
    page.get_by_role("button", name="Load", exact=True).click()
    browsing.until("window.plan.planner.live.state?.n_ahead === 40")
    page.get_by_role("button", name="Play", exact=True).click()
    taken(browsing, 40)
    assert page.locator(".view-plan .bar-title").first.inner_text() == "<b>LAT</b>"
    page.get_by_role("button", name="When was it enough?").click()
    page.wait_for_selector("[data-fact=enough-from] strong")
    words = fact(page, "enough-from")
    assert words.startswith("Enough from ")
    assert 5 < int(words.split()[2]) <= 40


def test_a_table_of_samples_is_loaded_by_its_columns(
    planning: Any, browsing: Any, tmp_path: Path
) -> None:
    page = planning
    directions = np.random.default_rng(6).standard_normal((30, 3))
    positions = 20 * directions / np.linalg.norm(directions, axis=1)[:, None]
    rows = [
        f"{index},{x:.4f},{y:.4f},{z:.4f},{value:.3f}"
        for index, ((x, y, z), value) in enumerate(
            zip(positions.tolist(), values_at(positions).tolist(), strict=True)
        )
    ]
    table = tmp_path / "<img src=x>.csv"
    table.write_text("\n".join(["point,x_mm,y_mm,z_mm,LAT_ms", *rows, "9,0,0,90,1"]))
    page.get_by_label("Table of samples").set_input_files(table)
    dialog = page.get_by_role("dialog", name="Columns of the table")
    assert dialog.get_by_label("Value").input_value() == "LAT_ms"
    dialog.get_by_role("button", name="Load").click()
    # The word of it goes by itself after a while: it is read first.
    assert "1 left out" in page.locator(".toast").inner_text()
    taken(browsing, 30)
    assert fact(page, "left-out") == "1 samples"
    assert page.locator("img").count() == 0


def test_the_state_is_saved_and_restored(planning: Any, browsing: Any, tmp_path: Path) -> None:
    page = planning
    for index, (across, down) in enumerate([(0, 0), (10, 0), (-10, 2), (3, 12), (-4, -12), (9, 9)]):
        click_on_the_surface(page, across, down)
        taken(browsing, index + 1)
    with page.expect_download() as saving:
        page.get_by_role("button", name="Save", exact=True).click()
    place = tmp_path / "state.json"
    saving.value.save_as(place)
    state = json.loads(place.read_text())
    assert len(state["views"]["plan"]["samples"]) == 6
    page.get_by_role("button", name="Clear").click()
    browsing.until("window.plan.planner.live.state.n_taken === 0")
    page.get_by_label("State file").set_input_files(place)
    taken(browsing, 6)
    assert fact(page, "taken") == "6"
    assert page.locator(".toast.bad").count() == 0


def test_markup_in_names_stays_text(planning: Any) -> None:
    assert planning.locator(".case-name").inner_text() == "<i>ball</i>"
    assert "<b>LAT</b>, 40 points" in planning.get_by_label("Recorded").inner_text()


def test_a_file_over_the_limit_is_refused_in_words(
    serve: Serve, browsing: Any, ball: OpenCase
) -> None:
    browsing.open(serve(ball, largest_upload=1000).address)
    page = browsing.page
    page.evaluate(
        """() => {
          const data = new DataTransfer();
          data.items.add(new File([new Uint8Array(5000)], "large.vtp"));
          document.dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true }));
        }"""
    )
    page.wait_for_selector(".toast.bad")
    assert "open it from the command line" in page.locator(".toast.bad").inner_text()
    assert page.locator(".case-name").inner_text() == "ball.vtp"
    # The browser itself notes the status 413 of the refused upload.
    assert len(browsing.complaints) == 1
    assert "413" in browsing.complaints.pop()
