"""Folders and files dropped on the page, or chosen by hand, as a user drops them."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from auricle.electroanatomy.formats.carto_writing import write_carto
from auricle.electroanatomy.study import ElectroanatomicStudy
from auricle.electroanatomy.synthetic import Acquisition, synthetic_map
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere
from auricle.surface.writing import write_surface
from auricle.viewer.open_case import OpenCase
from auricle.viewer.opening import Detail

Serve = Callable[..., Any]
BALL = icosphere(radius=30.0, subdivisions=2)
SMALL = Detail(n_vertices=160, n_modes=20)


@pytest.fixture
def export(tmp_path: Path) -> Path:
    """A CARTO study of two maps, 20 and 31 points, in a folder named after somebody."""
    surface = Mesh(BALL.vertices * [1.0, 0.9, 0.8], BALL.faces)
    truth = {
        "local_activation_time": np.asarray(surface.vertices[:, 0] / 0.6),
        "bipolar_voltage": 1.0 + surface.vertices[:, 2] / 40.0,
    }
    maps = [
        synthetic_map(
            surface,
            truth,
            acquisition=Acquisition(n_points=count, duration=300.0),
            rng=np.random.default_rng(count),
        )
        for count in (20, 31)
    ]
    folder = tmp_path / "CANARYNAME^ANNA"
    write_carto(folder, ElectroanatomicStudy("synthetic", tuple(maps)))
    return folder


def drop(page: Any, *paths: Path) -> None:
    """Drops files and folders from outside the browser on the middle of the page."""
    devtools = page.context.new_cdp_session(page)
    data = {"items": [], "files": [str(path) for path in paths], "dragOperationsMask": 1}
    for kind in ("dragEnter", "dragOver", "drop"):
        devtools.send("Input.dispatchDragEvent", {"type": kind, "x": 400, "y": 300, "data": data})


def opened_maps(browsing: Any) -> Any:
    choice = browsing.page.get_by_label("Map of the export")
    choice.wait_for(state="visible")
    return choice


def test_a_folder_is_dropped_and_one_of_its_maps_chosen(
    serve: Serve, browsing: Any, ball: OpenCase, export: Path
) -> None:
    server = serve(ball, SMALL)
    page = browsing.open(server.address)
    drop(page, export)
    choice = opened_maps(browsing)
    offered = choice.locator("option").all_inner_texts()
    assert [each.rpartition(", ")[2] for each in offered] == ["20 points", "31 points"]
    assert choice.input_value() == "2", "that of most points comes first"
    assert server.workspace.require(OpenCase, "none").recordings[0].samples.values.size > 20
    choice.select_option("1")
    page.get_by_role("button", name="Plan and map").click()
    browsing.until("document.querySelector('dialog.working') === null")
    page.wait_for_selector(".view-plan[data-ready=true]")
    browsing.until("document.querySelector('.map-choice select').value === '1'")
    assert server.workspace.require(OpenCase, "none").recordings[0].samples.values.size <= 20
    page.get_by_label("Recorded").filter(has_text="20 points").wait_for()
    assert browsing.violations() == []
    for canary in ("CANARY", "ANNA"):
        assert canary not in page.content() + page.title()


def test_a_surface_and_its_samples_are_dropped_at_once(
    serve: Serve, browsing: Any, ball: OpenCase, tmp_path: Path
) -> None:
    page = browsing.open(serve(ball, SMALL).address)
    write_surface(tmp_path / "other.ply", BALL)
    rows = [f"{x:.4f},{y:.4f},{z:.4f},{x:.4f}" for x, y, z in BALL.vertices[::12].tolist()]
    (tmp_path / "samples.csv").write_text("\n".join(["x,y,z,LAT_ms", *rows]))
    drop(page, tmp_path / "other.ply", tmp_path / "samples.csv")
    dialog = page.get_by_role("dialog", name="Columns of the table")
    dialog.get_by_role("button", name="Load").click()
    browsing.until(f"window.plan.planner.live.state?.n_taken === {len(rows)}")
    assert page.locator(".case-name").inner_text() == "other.ply"
    assert page.locator(".toast.bad").count() == 0


def test_a_folder_can_be_chosen_without_a_mouse(
    serve: Serve, browsing: Any, ball: OpenCase, export: Path
) -> None:
    page = browsing.open(serve(ball, SMALL).address)
    page.get_by_role("button", name="Open …").press("Enter")
    assert browsing.violations() == []
    with page.expect_file_chooser() as choosing:
        page.get_by_role("button", name="Folder …").press("Enter")
    choosing.value.set_files(export)
    assert opened_maps(browsing).locator("option").count() == 2


def test_files_that_are_no_case_are_refused_in_words(
    serve: Serve, browsing: Any, ball: OpenCase, tmp_path: Path
) -> None:
    page = browsing.open(serve(ball, SMALL).address)
    for name in ("a.vtp", "b.vtp"):
        write_surface(tmp_path / name, BALL)
    drop(page, tmp_path / "a.vtp", tmp_path / "b.vtp")
    page.wait_for_selector(".toast.bad")
    assert "one case at a time" in page.locator(".toast.bad").inner_text()
    assert page.locator(".case-name").inner_text() == "ball.vtp"
