"""The page's speed: from a move of the slider to the pixels, in a browser that draws in software.

    python benchmarks/page_speed.py [--vertices 10000 100000] [--modes 500 100] [--steps 24]

A lobed sphere with spherical harmonics as its basis (the page's work depends on their number only,
not on their values) is exported, opened from the disk in Chromium without a graphics card, and the
slider moved to numbers drawn at random, and by one. Timed is the time from the slider's event to
the moment the pixels of the picture can be read, one move after the other; the time from a click
on the slider, or a key, to the picture on the screen as the browser itself reports it (Event
Timing), from rest; and beside it the processor time that all of the browser's processes took for a
step. Then the same surface is served, samples are taken on it, and further ones clicked: from the
click to the pixels of the new map. Writes docs/performance_page.md.
"""

import argparse
import os
import shutil
import socket
import sys
import tempfile
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import uvicorn
from markdown_tables import table
from playwright.sync_api import Page, sync_playwright
from scipy.spatial import ConvexHull
from scipy.special import sph_harm_y

from auricle.atomic import write_text
from auricle.sampling.chamber import Chamber
from auricle.spectral.harmonics import Certificate, Harmonics
from auricle.study.preparation import PreparedSurface
from auricle.study.result import Source
from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh
from auricle.surface.soundness import soundness
from auricle.viewer.built_page import BUILT, exported_page
from auricle.viewer.bundle import surface_bundle
from auricle.viewer.open_case import OpenCase
from auricle.viewer.server import application
from auricle.viewer.workspace import Workspace

SLIDER_MS = 150.0
POINT_MS = 200.0
FLAGS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--disable-background-networking",
]
COMPOSED = {
    "page composed by SwiftShader too": FLAGS,
    "page composed by the processor": [*FLAGS, "--disable-gpu-compositing"],
}
"""Without a graphics card Chromium draws WebGL in SwiftShader and composes the page itself."""
PICTURES = {"three pictures": ["original", "harmonics", "points"], "one picture": ["harmonics"]}
TAKEN = (100, 500)
N_CLICKS = 12
"""After each click the page judges the samples anew, which is waited for: seconds each."""
PAUSE_MS = 500
_PARTS = """async (counts) => {
  const explorer = window.explore.current();
  const { stage } = explorer;
  const draw = stage.drawNow.bind(stage);
  const found = [];
  for (const count of counts) {
    const begun = performance.now();
    stage.drawNow = () => {};
    explorer.setCount(count);
    const computed = performance.now();
    stage.drawNow = draw;
    stage.drawNow();
    stage.finish();
    found.push([computed - begun, performance.now() - computed]);
    await new Promise(requestAnimationFrame);
  }
  delete stage.drawNow;
  return found;
}"""
_WATCH = """() => {
  window.presented = [];
  new PerformanceObserver((list) => {
    for (const { name, duration } of list.getEntries())
      if (name === "pointerdown" || name === "keydown") window.presented.push(duration);
  }).observe({ type: "event", durationThreshold: 16 });
}"""
_TAKE = """async ([positions, values]) => {
  const { planner } = window.plan;
  await planner.live.takeAll(positions, values);
}"""


@dataclass(frozen=True)
class Timing:
    """Milliseconds of one kind of step, and of its two parts without waiting for a frame."""

    label: str
    to_pixels: Sequence[float]
    on_screen: Sequence[float]
    processor: float
    computing: Sequence[float]
    drawing: Sequence[float]

    def row(self) -> list[str]:
        """The row of the table."""
        return [
            self.label,
            *spread(self.to_pixels),
            *spread(self.on_screen),
            f"{self.processor:.0f}",
            *(f"{np.median(part):.0f}" for part in (self.computing, self.drawing)),
        ]


def spread(times: Sequence[float]) -> tuple[str, str]:
    """Median, and 10th to 90th percentile."""
    low, middle, high = np.percentile(times, [10, 50, 90])
    return f"**{middle:.0f}**", f"{low:.0f}–{high:.0f}"


def lobed_case(n_vertices: int, n_modes: int) -> PreparedSurface:
    """A lobed sphere with a map, and spherical harmonics for its basis."""
    place = np.arange(n_vertices) + 0.5
    polar, around = np.arccos(1 - 2 * place / n_vertices), np.pi * (1 + 5**0.5) * place
    sphere = np.stack(
        [np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], axis=1
    )
    faces = _outward(sphere, ConvexHull(sphere).simplices)
    x, y, z = sphere.T
    mesh = Mesh(sphere * (25 + 5 * np.sin(3 * x) * np.cos(3 * z + 1))[:, None], faces)
    areas = np.full(n_vertices, 4 * np.pi * 25**2 / n_vertices)
    degrees = np.array([degree for degree in range(40) for _ in range(2 * degree + 1)])[:n_modes]
    orders = np.concatenate([np.arange(-degree, degree + 1) for degree in range(40)])[:n_modes]
    modes = np.empty((n_vertices, n_modes))
    for mode, (degree, order) in enumerate(zip(degrees, orders, strict=True)):
        value = sph_harm_y(degree, abs(order), polar, around)
        part = value.real if order >= 0 else value.imag
        modes[:, mode] = part * (1.0 if order == 0 else 2**0.5) / 25
    certificate = Certificate(n_modes, n_modes, 1.0, n_modes, 0.0, 0.0, 1, "spherical harmonics")
    basis = Harmonics(degrees * (degrees + 1) / 25.0**2, modes, areas, "cotangent", certificate)
    voltage = FieldMap(mesh, 1.5 + np.sin(4 * x) * np.cos(3 * y), "bipolar_voltage", "mV")
    return PreparedSurface(
        source=Source("lobed", 1, "0" * 64),
        surface=mesh,
        chamber=Chamber(mesh, basis, np.ones(n_vertices, dtype=np.bool_)),
        fields=(voltage,),
        space="LPS",
        as_read=soundness(mesh),
        analyzed=soundness(mesh),
        repairs=(),
        remarks=(),
    )


def _outward(points: np.ndarray[Any, Any], faces: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    corners = points[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = (normals * corners[:, 0]).sum(axis=1) < 0
    return np.where(inward[:, None], faces[:, ::-1], faces).astype(np.int64)


def processor_seconds() -> float:
    """Processor time of this program's children and theirs: the browser's processes."""
    parents, times = {}, {}
    for place in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = place.read_text(encoding="utf-8").rpartition(")")[2].split()
        except OSError:
            continue
        parents[int(place.parent.name)] = int(fields[1])
        times[int(place.parent.name)] = int(fields[11]) + int(fields[12])
    own = {os.getpid()}
    while more := {each for each, parent in parents.items() if parent in own} - own:
        own |= more
    return sum(times[each] for each in own - {os.getpid()}) / os.sysconf("SC_CLK_TCK")


def timings(page: Page, n_modes: int, n_steps: int) -> list[Timing]:
    """Both kinds of steps, with all pictures and with one."""
    rng = np.random.default_rng(1)
    found = []
    page.evaluate(_WATCH)
    for label, pictures in PICTURES.items():
        page.evaluate("pictures => window.explore.current().change({ pictures })", pictures)
        page.evaluate("count => window.explore.slide(count)", n_modes // 2)
        jumps = rng.integers(1, n_modes + 1, n_steps).tolist()
        steps = [n_modes // 2 + i for i in range(n_steps)]
        for kind, counts in (("any number", jumps), ("one more", steps)):
            page.wait_for_timeout(PAUSE_MS)
            before = processor_seconds()
            slid = [page.evaluate("count => window.explore.slide(count)", k) for k in counts]
            processor = 1000 * (processor_seconds() - before) / n_steps
            computing, drawing = zip(*page.evaluate(_PARTS, counts), strict=True)
            shown = presented(page, n_steps, rng if kind == "any number" else None)
            found.append(Timing(f"{label}, {kind}", slid, shown, processor, computing, drawing))
    return found


def presented(page: Page, n_steps: int, rng: np.random.Generator | None) -> list[float]:
    """From a click on the slider at random (or, without `rng`, a key) to the screen, ms."""
    slider = page.locator("input[type=range]").first
    box = slider.bounding_box() or {}
    slider.focus()
    page.evaluate("window.presented.length = 0")
    for _ in range(n_steps):
        if rng is None:
            page.wait_for_timeout(PAUSE_MS)
            page.keyboard.press("ArrowRight")
        else:
            x = box["x"] + box["width"] * rng.uniform(0.05, 0.95)
            page.mouse.move(x, box["y"] + box["height"] / 2)
            page.wait_for_timeout(PAUSE_MS)
            page.mouse.down()
            page.mouse.up()
    page.wait_for_timeout(2 * PAUSE_MS)
    return [float(each) for each in page.evaluate("window.presented")]


def slider_section(page: Page, bundle: bytes, n_modes: int, n_steps: int) -> tuple[str, float]:
    """The table of one exported page, and its slowest median to the pixels, ms."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "page.html"
        file.write_text(exported_page(bundle), encoding="utf-8")
        page.goto(file.as_uri(), timeout=300_000)
        page.wait_for_selector("html[data-ready=true]", timeout=300_000)
        found = timings(page, n_modes, n_steps)
    heads = ["step", "to pixels (ms)", "10–90 %", "on screen (ms)", "10–90 %"]
    heads += ["processor (ms)", "computing", "drawing"]
    slowest = max(float(np.median(each.to_pixels)) for each in found)
    return table(heads, [each.row() for each in found]), slowest


@contextmanager
def served(name: str, *parts: object) -> Iterator[str]:
    """The address of a page that shows what is open, served by a thread of this process."""
    with tempfile.TemporaryDirectory() as folder:
        workspace = Workspace(Path(folder))
        workspace.open(name, parts)
        listener = socket.create_server(("127.0.0.1", 0))
        port = int(listener.getsockname()[1])
        app = application(workspace, token="once", port=port)
        server = uvicorn.Server(uvicorn.Config(app, log_level="error", ws="none", lifespan="off"))
        thread = threading.Thread(target=server.run, args=([listener],), daemon=True)
        thread.start()
        yield f"http://127.0.0.1:{port}/#token=once"
        server.should_exit = True
        thread.join(10)


def point_section(page: Page, case: PreparedSurface) -> tuple[str, float]:
    """The table of clicks after so many samples, and its slowest median, ms."""
    rng = np.random.default_rng(2)
    field, vertices = case.fields[0], case.surface.vertices
    rows, slowest = [], 0.0
    with served("lobed sphere", OpenCase("lobed sphere", case)) as address:
        page.goto(address)
        page.wait_for_selector("html[data-ready=true]", timeout=300_000)
        page.get_by_role("button", name="Plan and map").click()
        page.wait_for_selector(".view-plan[data-ready=true]")
        for n_taken in TAKEN:
            at = rng.choice(len(vertices), n_taken, replace=False)
            page.evaluate(_TAKE, [vertices[at].tolist(), field.values[at].tolist()])
            times = [click(page, rng) for _ in range(N_CLICKS)]
            rows.append([f"{n_taken} to {n_taken + N_CLICKS}", *spread(times)])
            slowest = max(slowest, float(np.median(times)))
    return table(["samples there", "to pixels (ms)", "10–90 %"], rows), slowest


def click(page: Page, rng: np.random.Generator) -> float:
    """Milliseconds from a click on the left picture to the pixels of the map with it."""
    live = "window.plan.planner.live"
    while not page.evaluate(f"{live}.quiet"):
        page.wait_for_timeout(50)
    page.evaluate("window.plan.planner.lastClickMs = NaN")
    across, up = rng.uniform(-12, 12, 2).tolist()
    spot = page.evaluate(
        "(at) => { const { stage } = window.plan.planner.pictures; const there = stage.project(at);"
        " const box = stage.element.getBoundingClientRect();"
        " return [there.x + box.left, there.y + box.top]; }",
        [across, 0, up],
    )
    page.mouse.move(*spot)
    page.wait_for_timeout(PAUSE_MS)
    page.mouse.down()
    page.mouse.up()
    while not (found := page.evaluate("window.plan.planner.lastClickMs || 0")):
        page.wait_for_timeout(20)
    return float(found)


def load() -> str:
    """How busy the machine is."""
    return f"load average {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores"


def document(sections: Sequence[str]) -> str:
    """The whole page of figures."""
    size = BUILT.stat().st_size / 1e3
    return (
        "# The page's speed\n\n"
        "Measured by `benchmarks/page_speed.py`, 1280×760, in Chromium without a graphics\n"
        "card: the pictures are drawn in software (SwiftShader).\n\n"
        "- **To pixels**: from the slider's event, or the click, until the pixels of the\n"
        "  picture can be read; slider moves follow one another without a pause. The bar is\n"
        "  150 ms at 10,000 vertices, for a new point 200 ms.\n"
        "- **On screen**: from a real click on the slider (any number) or a key (one more) to\n"
        "  the frame on the screen, from rest, as the browser reports it (Event Timing, in\n"
        "  steps of 8 ms).\n"
        "- Processor time is that of all of the browser's processes for one step, shared by\n"
        "  the cores. Computing is the sum over the harmonics, the errors, the simplified\n"
        "  surface, the numbers and the charts.\n\n"
        "While the slider moves, pictures are drawn with half the pixels each way, and only\n"
        "those that change; 150 ms after it rests they are drawn in full. Chromium composes\n"
        "the page in SwiftShader only when it is made to, as in the tests; on a machine\n"
        "without a graphics card the processor does.\n\n"
        f"The page itself is {size:.0f} kB before data.\n\n" + "\n\n".join(sections) + "\n"
    )


def main() -> None:
    """Measure, write the document, say whether the bars are met."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--vertices", type=int, nargs="+", default=[10_000, 100_000])
    parser.add_argument("--modes", type=int, nargs="+", default=[500, 100])
    parser.add_argument("--steps", type=int, default=24)
    chosen = parser.parse_args()
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    sections: list[str] = []
    slowest: list[str] = []

    def add(head: str, label: str, found: tuple[str, float]) -> None:
        sections.append(f"## {head}\n\n{load().capitalize()}.\n\n{found[0]}")
        slowest.append(f"{label}: {found[1]:.0f} ms")
        sys.stderr.write(sections[-1] + "\n")

    with sync_playwright() as playwright:

        def opened(flags: Sequence[str]) -> Page:
            browser = playwright.chromium.launch(executable_path=chromium, args=list(flags))
            page = browser.new_page(viewport={"width": 1280, "height": 760})
            page.set_default_timeout(300_000)
            return page

        for n_vertices, n_modes in zip(chosen.vertices, chosen.modes, strict=True):
            case = lobed_case(n_vertices, n_modes)
            size = f"{n_vertices:,} vertices, {n_modes} harmonics"
            if n_vertices == chosen.vertices[0]:
                page = opened(FLAGS)
                add("A new point to the new map: " + size, "new point", point_section(page, case))
                page.context.browser.close()
            bundle = surface_bundle(case, name="lobed sphere")
            for how, flags in COMPOSED.items():
                page = opened(flags)
                found = slider_section(page, bundle, n_modes, chosen.steps)
                add(f"Slider: {size}, {how}", f"slider, {size}, {how}", found)
                page.context.browser.close()
    text = document(sections)
    write_text(Path(__file__).resolve().parents[1] / "docs" / "performance_page.md", text)
    sys.stdout.write(text)
    bars = f"bars {SLIDER_MS:.0f} and {POINT_MS:.0f} ms"
    sys.stdout.write("\nslowest medians, " + bars + ":\n" + "\n".join(slowest) + "\n")


if __name__ == "__main__":
    main()
