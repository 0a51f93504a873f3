"""Pictures of every view of the page, as a desk and a telephone show it, for docs/page.md.

    python benchmarks/page_pictures.py [--study FOLDER] [--only explore plan segment cohort]

A generated atrium is explored and planned on, a generated CT segmented, and the folder of a study
(as `make paper` writes it) shown where one is given. Writes docs/figures/page_*.png.
"""

import argparse
import io
import os
import shutil
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from page_speed import FLAGS, served
from PIL import Image
from playwright.sync_api import Browser, Page, sync_playwright

from auricle.imaging.writing import write_volume
from auricle.simulation.activation import activation_map
from auricle.simulation.anatomy import AtriumShape
from auricle.simulation.atrium import atrium
from auricle.simulation.phantom import PhantomOptions, phantom
from auricle.study.preparation import prepare_soup
from auricle.study.result import Source
from auricle.surface.soup import TriangleSoup
from auricle.viewer.cohort_session import cohort_session
from auricle.viewer.open_case import OpenCase
from auricle.viewer.opening import Detail
from auricle.viewer.volume_session import volume_session

SIZES = {"": (1280, 760), "_phone": (390, 800)}
FIGURES = Path(__file__).resolve().parents[1] / "docs" / "figures"
LARGEST_BYTES = 200_000
N_TAKEN = 90


def generated_case() -> OpenCase:
    """A generated atrium with an activation map; the lower part of it is not sampled."""
    mesh = atrium(AtriumShape.random(np.random.default_rng(3)), spacing=1.2)
    focus = int(mesh.vertices[:, 0].argmin())
    times = activation_map(mesh, foci=[focus], velocity=0.8).values
    x, y, z = (mesh.vertices / 12.0).T
    voltage = 1.6 + 0.9 * np.sin(x) * np.cos(z + 0.5 * y)
    voltage[mesh.vertices[:, 0] > np.percentile(mesh.vertices[:, 0], 96)] = np.nan
    soup = TriangleSoup(
        vertices=mesh.vertices,
        faces=mesh.faces,
        point_fields={"bipolar_voltage": voltage, "local_activation_time": times},
        units={"bipolar_voltage": "mV", "local_activation_time": "ms"},
        space="LPS",
    )
    prepared = prepare_soup(soup, Source("atrium.vtp", 1, "0" * 64), n_vertices=6_000, n_modes=200)
    return OpenCase("Generated atrium", prepared)


def explore(page: Page) -> None:
    """Eighty harmonics of the voltage, from behind."""
    page.evaluate("window.explore.current().change({ field: 'bipolar_voltage' })")
    page.get_by_role("button", name="PA", exact=True).click()
    page.evaluate("window.explore.slide(80)")


def plan(page: Page) -> None:
    """A plan for the activation of a focus, and samples taken."""
    page.get_by_role("button", name="Plan and map").click()
    page.wait_for_selector(".view-plan[data-ready=true]")
    page.get_by_label("A click takes").select_option("field:local_activation_time")
    page.get_by_label("Kind of map").select_option("class:activation")
    page.get_by_role("button", name="Plan", exact=True).click()
    page.wait_for_selector("[data-fact=needed]")
    live = "window.plan.planner.live"
    for _ in range(N_TAKEN):
        page.evaluate("window.plan.planner.takeNext()")
    while not page.evaluate(f"{live}.quiet && {live}.judgement?.n_taken === {N_TAKEN}"):
        page.wait_for_timeout(200)


def segment(page: Page) -> None:
    """The preview of the atrium."""
    page.wait_for_selector("[data-fact=kind]:text-matches('^preview at [0-9.]+ mm$')")


def cohort(page: Page) -> None:
    """The table and the charts, as they come."""
    page.wait_for_selector(".view-cohort table")


def save(content: bytes, place: Path) -> None:
    """Write a picture with at most 256 colours: a third of the bytes, and the same to the eye."""
    picture = Image.open(io.BytesIO(content)).convert("RGB")
    picture.quantize(256, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save(
        place, optimize=True
    )


def photographed(
    browser: Browser, name: str, parts: tuple[object, ...], title: str, show: Callable[[Page], None]
) -> list[Path]:
    """Both pictures of a view; the telephone's after the desk's, with the same done to it."""
    places = []
    for ending, (width, height) in SIZES.items():
        with served(title, *parts) as address:
            page = browser.new_page(viewport={"width": width, "height": height})
            page.set_default_timeout(300_000)
            page.goto(address)
            page.wait_for_selector("html[data-ready=true]")
            show(page)
            page.evaluate("document.querySelectorAll('.view *').forEach((e) => e.scrollTo(0, 0))")
            page.wait_for_timeout(1_500)
            places.append(FIGURES / f"page_{name}{ending}.png")
            save(page.screenshot(), places[-1])
            page.close()
        size = places[-1].stat().st_size
        if size > LARGEST_BYTES:
            raise SystemExit(f"{places[-1].name}: {size:,} bytes, more than {LARGEST_BYTES:,}")
    return places


def main() -> None:
    """Take the pictures asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--study", type=Path)
    parser.add_argument("--only", nargs="+", default=["explore", "plan", "segment", "cohort"])
    chosen = parser.parse_args()
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as folder:
        browser = playwright.chromium.launch(executable_path=chromium, args=FLAGS)
        done: list[Path] = []
        surface = {"explore": explore, "plan": plan}
        if wanted := [name for name in surface if name in chosen.only]:
            case = generated_case()
            for name in wanted:
                done += photographed(browser, name, (case,), case.name, surface[name])
        if "segment" in chosen.only:
            scan = Path(folder) / "generated.nrrd"
            write_volume(phantom(PhantomOptions(preset="small", seed=2)).volume, scan)
            parts = (volume_session(scan), Detail(4_000, 100))
            done += photographed(browser, "segment", parts, "Generated CT", segment)
        if "cohort" in chosen.only and chosen.study:
            parts = (cohort_session(chosen.study), Detail(4_000, 100))
            done += photographed(browser, "cohort", parts, chosen.study.name, cohort)
        browser.close()
    for place in done:
        sys.stdout.write(f"{place.name}: {place.stat().st_size:,} bytes\n")


if __name__ == "__main__":
    main()
