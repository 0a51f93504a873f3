"""The page of a segmented CT, and the folder it comes in."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any

from matplotlib.figure import Figure

from auricle.atomic import write_bytes, write_text
from auricle.imaging.verdict import Reason, Verdict
from auricle.imaging.writing import write_mask
from auricle.progress import Progress, silent
from auricle.report.gallery import drawn_files
from auricle.report.html import Caption, captioned, rendered
from auricle.report.tables import Table
from auricle.report.volume_pictures import histogram_figure, overlay_picture, surface_picture
from auricle.report.wording import counted, number, percent, printable
from auricle.study.segmented import SegmentedCase
from auricle.study.segmented_store import segmentation_document
from auricle.study.store import json_text
from auricle.surface.writing import write_surface

CAPTIONS: Mapping[str, Caption] = MappingProxyType(
    {
        "overlay.png": Caption(
            "The atrium in the CT",
            "Three planes at a quarter, the middle and three quarters of the atrium, hung as a "
            "radiologist hangs them. Does the yellow line follow the bright blood of the left "
            "atrium, and nothing else? Straight ends are cuts: veins, and the mitral orifice.",
            "Nine grey slices of the CT with the segmented atrium outlined.",
        ),
        "surface.png": Caption(
            "The surface from four sides",
            "Dots: where veins and appendage leave the body.",
            "The closed surface of the left atrium from front, back, left and right.",
        ),
        "histogram.svg": Caption(
            "CT numbers and thresholds",
            "How much of the region and of the atrium has which CT number. The surface lies "
            "half-way between wall and blood.",
            "Two histograms of CT numbers with four upright lines.",
        ),
    }
)
"""Captions of the figures, in the order of the page."""

_VERDICTS = {
    Verdict.OK: "Nothing was found that speaks against it; look at the slices all the same.",
    Verdict.CHECK: "Look at the slices before using it: there is reason for doubt.",
}


@dataclass(frozen=True)
class ReasonLine:
    """A reason for doubt, ready to show."""

    code: str
    cause: str
    remedy: str
    stops: bool
    place: str


def segmentation_answer(case: SegmentedCase) -> str:
    """What came out, in a sentence."""
    found = case.endocardium.soundness
    how = "label map" if case.segmentation is None else "CT"
    return (
        f"Left atrium of {number(case.volume_ml)} ml from a {how}, closed surface of "
        f"{number(found.area_mm2 / 100)} cm² with {counted(found.n_vertices, 'vertex', 'vertices')}"
        f"; verdict: {case.verdict.value}."
    )


def write_segmentation(case: SegmentedCase, folder: Path, *, figures: Mapping[str, bytes]) -> Path:
    """Write mask, surface, report, figures and, last, result.json; returns the report.

    ``mask.nrrd`` lies on the lattice of the input, ``surface.vtp`` in mm, LPS.

    Parameters
    ----------
    case
        The segmentation.
    folder
        Where to.
    figures
        Its pictures, as `segmentation_figures` draws them.

    Raises
    ------
    OutputError
        If the folder cannot be written.
    """
    page = rendered("segmentation.html.j2", segmentation_context(case, figures))
    document = json_text(segmentation_document(case))
    write_mask(case.mask, folder / "mask.nrrd")
    write_surface(folder / "surface.vtp", case.endocardium.mesh, space="LPS")
    for name, content in figures.items():
        write_bytes(folder / "figures" / name, content)
    write_text(folder / "report.html", page)
    write_text(folder / "timings.json", json_text({"wall_s": dict(case.seconds)}))
    write_text(folder / "result.json", document)
    return folder / "report.html"


def segmentation_figures(case: SegmentedCase, *, progress: Progress = silent) -> dict[str, bytes]:
    """Draw the pictures of a segmentation: file name to content."""
    wanted: dict[str, Callable[[], Figure]] = {
        "overlay.png": partial(overlay_picture, case),
        "surface.png": partial(surface_picture, case),
    }
    if case.segmentation is not None:
        wanted["histogram.svg"] = partial(histogram_figure, case)
    return drawn_files(wanted, progress)


def segmentation_context(case: SegmentedCase, figures: Mapping[str, bytes]) -> dict[str, Any]:
    """What the templates need to tell a segmentation."""
    return {
        "source": case.source,
        "source_name": printable(case.source.name),
        "labels": case.labels_source,
        "labels_name": "" if case.labels_source is None else printable(case.labels_source.name),
        "shape": "×".join(map(str, case.shape)),
        "spacing": "×".join(number(each) for each in case.spacing_mm),
        "answer": segmentation_answer(case),
        "verdict": case.verdict.value,
        "verdict_words": _VERDICTS[case.verdict],
        "reasons": [_line(reason) for reason in case.reasons],
        "remarks": [printable(str(each)) for each in (*case.remarks, *case.endocardium.repairs)],
        "figures": captioned(figures, CAPTIONS),
        "tables": segmentation_tables(case),
        "vein_stub": case.config.vein_stub_mm,
        "parameters": _parameters_table(case),
        "versions": [f"{name} {version}" for name, version in case.versions.items()],
    }


def _line(reason: Reason) -> ReasonLine:
    place = "" if reason.position is None else _place(reason.position)
    return ReasonLine(
        reason.code.replace("_", " "), reason.cause, reason.remedy, reason.stops, place
    )


def segmentation_tables(case: SegmentedCase) -> tuple[Table, ...]:
    """Measures of the atrium, and its branches."""
    found, segmentation = case.endocardium.soundness, case.segmentation
    rows = [
        ("Volume inside the surface", f"{number(case.volume_ml)} ml"),
        ("Volume of the mask", f"{number(case.mask.volume_ml)} ml"),
        ("Area", f"{number(found.area_mm2 / 100)} cm²"),
        ("Vertices", f"{found.n_vertices:,}"),
        ("Lattice of the surface", f"{number(case.endocardium.spacing)} mm"),
    ]
    if segmentation is None:
        return (Table("The atrium", ("Measure", "Value"), tuple(rows)),)
    thresholds, measures = segmentation.thresholds, segmentation.measurements
    rows += [
        ("Blood, wall, noise", _hu(thresholds.blood, thresholds.wall, thresholds.noise)),
        (
            "Surface, chambers, upper limit",
            _hu(thresholds.lower, thresholds.growing, thresholds.upper),
        ),
        (
            "Seed",
            f"{_place(segmentation.seed.position.tolist())}"
            + (", given" if segmentation.seed.given else ", found"),
        ),
        ("Largest ball inside", f"{number(segmentation.radius)} mm radius"),
        (
            "Opening to the ventricle",
            f"{number(measures['mitral_opening_radius_mm'])} mm radius, "
            f"{percent(measures['mitral_opening_share'])} of the smaller chamber's",
        ),
    ]
    branches = tuple(
        (
            each.kind,
            _place(each.ostium.tolist()),
            number(each.radius),
            number(each.length),
            number(each.volume_ml),
        )
        for each in segmentation.branches
    )
    head = ("Branch", "Ostium, mm", "Radius, mm", "Length, mm", "Volume, ml")
    return (
        Table("The atrium", ("Measure", "Value"), tuple(rows)),
        Table("Branches, before they were cut", head, branches),
    )


def _hu(*values: float) -> str:
    return ", ".join(f"{value:.0f}" for value in values) + " HU"


def _place(position: tuple[float, ...] | list[float]) -> str:
    return "(" + ", ".join(number(each, digits=4) for each in position) + ")"


def _parameters_table(case: SegmentedCase) -> Table:
    config = case.config
    region = "; ".join(_place(each) for each in config.region_mm)
    rows = (
        ("Seed", "found" if config.seed_mm is None else _place(config.seed_mm)),
        ("Region of interest", f"{region} mm" if region else "around the seed"),
        ("Cutters", "; ".join(_place(each) for each in config.cuts_mm) or "none"),
        ("DICOM series", "the only one" if config.series is None else str(config.series)),
        ("Labels", ", ".join(map(str, config.label)) or "none"),
        ("Lower threshold", _given(config.lower_hu)),
        ("Upper threshold", _given(config.upper_hu)),
        ("Veins kept", f"{config.vein_stub_mm:g} mm"),
    )
    return Table("Parameters of this run", ("Parameter", "Value"), rows)


def _given(threshold: float | None) -> str:
    return "from the histogram" if threshold is None else f"{threshold:g} HU"
