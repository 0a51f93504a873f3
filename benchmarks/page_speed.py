"""The page's speed: from a move of the slider to the pixels, in a browser that draws in software.

    python benchmarks/page_speed.py [--vertices 10000 100000] [--modes 500 200] [--steps 24]

A lobed sphere with spherical harmonics as its basis (the page's work depends on their number only,
not on their values) is exported, opened from the disk in Chromium without a graphics card, and the
slider moved to numbers drawn at random, and by one. Timed is the time from the slider's event to
the moment the pixels of the picture can be read; and beside it the processor time that all of the
browser's processes took for a step, which a busy machine does not change. Writes
docs/performance_page.md.
"""

import argparse
import os
import shutil
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from calibration_report import table
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

BAR_MS = 150.0
FLAGS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--disable-background-networking",
]
PICTURES = {"three pictures": ["original", "harmonics", "points"], "one picture": ["harmonics"]}
_PARTS = """count => {
  const explorer = window.explore.current();
  const { stage } = explorer;
  const draw = stage.drawNow.bind(stage);
  const begun = performance.now();
  stage.drawNow = () => {};
  explorer.setCount(count);
  const computed = performance.now();
  stage.drawNow = draw;
  stage.drawNow();
  stage.finish();
  return [computed - begun, performance.now() - computed];
}"""


@dataclass(frozen=True)
class Timing:
    """Milliseconds of one kind of step, and of its two parts without waiting for a frame."""

    label: str
    to_pixels: Sequence[float]
    processor: float
    computing: Sequence[float]
    drawing: Sequence[float]

    def row(self) -> list[str]:
        """The row of the table."""
        low, middle, high = np.percentile(self.to_pixels, [10, 50, 90])
        parts = (np.median(self.computing), np.median(self.drawing))
        spread = f"{low:.0f} to {high:.0f}"
        return [
            self.label,
            f"{middle:.0f}",
            spread,
            f"{self.processor:.0f}",
            *(f"{part:.0f}" for part in parts),
        ]


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
    for label, pictures in PICTURES.items():
        page.evaluate("pictures => window.explore.current().change({ pictures })", pictures)
        page.evaluate("count => window.explore.slide(count)", n_modes // 2)
        jumps = rng.integers(1, n_modes + 1, n_steps).tolist()
        steps = [n_modes // 2 + i for i in range(n_steps)]
        for kind, counts in (("any number", jumps), ("one more", steps)):
            before = processor_seconds()
            slid = [page.evaluate("count => window.explore.slide(count)", k) for k in counts]
            processor = 1000 * (processor_seconds() - before) / n_steps
            parts = [page.evaluate(_PARTS, k) for k in counts]
            computing, drawing = zip(*parts, strict=True)
            found.append(Timing(f"{label}, {kind}", slid, processor, computing, drawing))
    return found


def measured(page: Page, n_vertices: int, n_modes: int, n_steps: int) -> tuple[str, float]:
    """The section of one size, and its slowest median with one picture, ms."""
    bundle = surface_bundle(lobed_case(n_vertices, n_modes), name="lobed sphere")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "page.html"
        file.write_text(exported_page(bundle), encoding="utf-8")
        size = file.stat().st_size / 1e6
        page.goto(file.as_uri(), timeout=300_000)
        page.wait_for_selector("html[data-ready=true]", timeout=300_000)
        found = timings(page, n_modes, n_steps)
    load = os.getloadavg()[0]
    heads = ["step", "median (ms)", "10–90 % (ms)", "processor (ms)", "computing", "drawing"]
    words = (
        f"## {n_vertices:,} vertices, {n_modes} harmonics\n\n"
        f"Exported page {size:.1f} MB; load average {load:.1f} on {os.cpu_count()} cores.\n\n"
    )
    return words + table(heads, [each.row() for each in found]), max(
        float(np.median(each.to_pixels)) for each in found
    )


def main() -> None:
    """Measure, write the document, say whether the bar is met."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--vertices", type=int, nargs="+", default=[10_000, 100_000])
    parser.add_argument("--modes", type=int, nargs="+", default=[500, 200])
    parser.add_argument("--steps", type=int, default=24)
    chosen = parser.parse_args()
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=FLAGS)
        page = browser.new_page(viewport={"width": 1280, "height": 760})
        page.set_default_timeout(300_000)
        sections = [
            measured(page, n, k, chosen.steps)
            for n, k in zip(chosen.vertices, chosen.modes, strict=True)
        ]
        browser.close()
    size = BUILT.stat().st_size / 1e3
    document = (
        "# The page's speed\n\n"
        "From the slider's event to pixels that can be read, 1280×760, Chromium drawing in\n"
        "software (SwiftShader), by `benchmarks/page_speed.py`. Computing is the sum over the\n"
        "harmonics, the errors, the simplified surface, the numbers and the charts; the first\n"
        "column has the wait for the next frame on top of both. Processor time is that of\n"
        "all of the browser's processes for one step, shared by the cores. The page itself\n"
        f"is {size:.0f} kB before data.\n\n" + "\n\n".join(words for words, _ in sections) + "\n"
    )
    target = Path(__file__).resolve().parents[1] / "docs" / "performance_page.md"
    write_text(target, document)
    slowest = sections[0][1]
    sys.stdout.write(document)
    sys.stdout.write(f"slowest median at the first size {slowest:.0f} ms, bar {BAR_MS:.0f} ms\n")


if __name__ == "__main__":
    main()
