"""The page of a sampling plan, and the folder it comes in."""

import csv
import io
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import MappingProxyType

from matplotlib.figure import Figure

from auricle.atomic import write_bytes, write_text
from auricle.progress import Progress, silent
from auricle.report.gallery import drawn_files
from auricle.report.html import Caption, captioned, rendered
from auricle.report.plan_figures import need_figure, plan_picture, tail_figure
from auricle.report.tables import Table
from auricle.report.wording import counted, number, percent, printable
from auricle.sampling.literature import FILL_DISTANCES_MM, samples_for_fill, second_opinions
from auricle.sampling.recommendation import ACQUISITIONS
from auricle.study.plan_result import PlanResult
from auricle.study.sampling_store import plan_document
from auricle.study.store import json_text
from auricle.surface.writing import write_surface

CAPTIONS: Mapping[str, Caption] = MappingProxyType(
    {
        "plan.png": Caption(
            "Where to sample",
            "The planned points from four sides. Below: the finest wavelength they support at each "
            "place; detail finer than that cannot be told from noise there.",
            "The surface from four sides with the planned points on it.",
        ),
        "need.svg": Caption(
            "Points against error",
            "What other errors would take, if the points are spread evenly on purpose and if they "
            "are not.",
            "Two falling curves of the number of points over the error.",
        ),
        "tail.svg": Caption(
            "How fast the error of such maps falls",
            "Thin: each map drawn. Thick: the one the number is read from.",
            "Falling curves of the error over the number of harmonics.",
        ),
    }
)
"""Captions of the figures, in the order of the page."""

_DESIGNS: Mapping[str, str] = MappingProxyType(
    {
        "farthest": "one after another where the surface is farthest from all before (farthest-"
        "point sampling by distance along the surface)",
        "pivoted_qr": "by pivoted QR of the harmonics, which is best where points are scarce",
        "a_optimal": "one after another where they lower the expected error most (A-optimal)",
        "d_optimal": "one after another where they tell most (D-optimal)",
    }
)


@dataclass(frozen=True)
class Card:
    """One number of the answer: what it is, the number, what it means."""

    title: str
    value: str
    text: str


def plan_answer(result: PlanResult) -> str:
    """The answer in a sentence, or two where points are given or taken already."""
    advised = result.recommendation
    asked = f"{printable(result.wanted)} with an error of {percent(result.config.target_nrmse)}"
    if advised.unreachable is not None:
        sentence = (
            f"No number of points maps {asked}: {printable(advised.unreachable)}. The least error "
            f"to expect is {percent(advised.predicted_nrmse)}."
        )
    else:
        evenly = result.config.acquisition == "planned"
        how = "evenly spread" if evenly else "taken wherever the catheter is"
        spacing = number(advised.spacing_mm or 0.0, digits=2)
        points = counted(advised.n_samples or 0, "point")
        verb = "Take" if _is_plain(result) else "It takes"
        sentence = f"{verb} {points}, {how}, one every {spacing} mm, to map {asked}."
    return " ".join([sentence, *_about_plan(result)])


def _is_plain(result: PlanResult) -> bool:
    """Whether the points planned are those recommended, no more, no less and anywhere."""
    config = result.config
    changed = (config.n_samples, config.catheter, config.forbid)
    return not len(result.existing) and all(each is None for each in changed)


def _about_plan(result: PlanResult) -> tuple[str, ...]:
    """What is planned, where that is not the number recommended, one at a time."""
    plan = result.plan
    if plan is None or _is_plain(result):
        return ()
    taken, planned = len(result.existing), len(result.positions)
    parts = [f"{counted(taken, 'point')} taken already"] * bool(taken)
    if result.placements is not None:
        placements = counted(len(result.placements.centres), "placement")
        parts.append(f"{counted(planned, 'electrode')} in {placements} planned")
    elif planned:
        parts.append(f"{planned:,} planned")
    error = percent(plan.predicted_nrmse)
    advised_none = result.recommendation.n_samples is None
    enough = "" if planned or advised_none else ", which is enough"
    return (f"Here: {' and '.join(parts)}{enough}; plain least squares on them errs by {error}.",)


def write_plan(result: PlanResult, folder: Path, *, progress: Progress = silent) -> Path:
    """Write a plan's report, figures, points and, last, its result.json; returns the report.

    Raises
    ------
    OutputError
        If the folder cannot be written.
    """
    figures = drawn_files(_figures(result), progress)
    page = plan_page(result, figures)
    document = json_text(plan_document(result))
    for name, content in figures.items():
        write_bytes(folder / "figures" / name, content)
    prepared = result.prepared
    write_surface(folder / "surface.vtp", prepared.surface, prepared.fields, space=prepared.space)
    write_text(folder / "points.csv", points_csv(result))
    write_text(folder / "report.html", page)
    write_text(folder / "timings.json", json_text({"wall_s": dict(result.seconds)}))
    write_text(folder / "result.json", document)
    return folder / "report.html"


def points_csv(result: PlanResult) -> str:
    """The planned points in the order to take them, in the frame of the surface's file.

    Of a catheter with the number of its placement and of the electrode in it, from 1.
    """
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    placed = result.placements
    writer.writerow(["order", "x_mm", "y_mm", "z_mm", *["placement", "electrode"] * bool(placed)])
    for index, position in enumerate(result.positions.tolist()):
        row = [str(index + 1), *(f"{value:.3f}" for value in position)]
        if placed is not None:
            row += [str(placed.placement[index] + 1), str(placed.electrode[index] + 1)]
        writer.writerow(row)
    return file.getvalue()


def plan_page(result: PlanResult, figures: Mapping[str, bytes]) -> str:
    """The report as one HTML page, complete in itself."""
    prepared, config, plan = result.prepared, result.config, result.plan
    many = result.tails.n_maps > 1
    source_words = (
        f"{result.tails.n_maps} maps of the kind are drawn on this very surface; the number "
        f"suffices for {percent(config.quantile)} of them."
        if many
        else f"The number is read from {printable(result.tails.source)}."
    )
    context = {
        "source": prepared.source,
        "source_name": printable(prepared.source.name),
        "area_cm2": prepared.chamber.accessible_area / 100,
        "wanted": printable(result.wanted),
        "answer": plan_answer(result),
        "cards": _cards(result),
        "remarks": [
            printable(str(each)) for each in (*prepared.repairs, *prepared.remarks, *result.remarks)
        ],
        "figures": captioned(figures, CAPTIONS),
        "tables": [_need_table(result), _opinion_table(result)],
        "source_words": source_words,
        "per_harmonic": ACQUISITIONS[config.acquisition].per_harmonic,
        "design_words": _design_words(result),
        "bound": _bound_words(result),
        "radius_mm": None if plan is None else plan.coverage.radius_mm,
        "parameters": _parameters_table(result),
        "versions": [f"{name} {version}" for name, version in result.versions.items()],
    }
    return rendered("plan.html.j2", context)


def _figures(result: PlanResult) -> dict[str, Callable[[], Figure]]:
    wanted: dict[str, Callable[[], Figure]] = {"tail.svg": partial(tail_figure, result)}
    if any(each.n_samples is not None for each in result.by_target.values()):
        wanted["need.svg"] = partial(need_figure, result)
    if result.plan is not None:
        wanted["plan.png"] = partial(plan_picture, result)
    return wanted


def _design_words(result: PlanResult) -> str:
    if not len(result.positions):
        return ""
    if result.placements is None:
        return f"The points are placed {_DESIGNS[result.config.design]}."
    off = result.placements.n_off
    return (
        f"The catheter ({printable(str(result.config.catheter))}) is laid one after another where "
        "the surface is farthest from all placements before; "
        f"{counted(off, 'electrode')} of it fall off the surface and are left out."
    )


def _bound_words(result: PlanResult) -> str:
    if result.plan is None or not math.isfinite(result.plan.bound.nrmse):
        return ""
    return f"Bound for least squares: {result.plan.bound.statement}."


def _cards(result: PlanResult) -> tuple[Card, ...]:
    plan, advised = result.plan, result.recommendation
    if plan is None:
        return ()
    coverage, taken = plan.coverage, len(result.existing)
    cards = [
        Card(
            "Points planned",
            f"{len(result.positions):,}",
            (f"beside {taken:,} taken already; " if taken else "")
            + f"{number(coverage.density_per_cm2, digits=2)} per cm² in all; neighbours "
            f"{number(coverage.spacing_mm, digits=2)} mm apart in the median",
        ),
        Card(
            "Error by least squares",
            percent(plan.predicted_nrmse),
            f"of the map's deviation, from the {counted(plan.n_modes, 'harmonic')} these points "
            f"hold; {plan.stability.verdict} (noise gain {number(plan.stability.noise_gain)}). The "
            "number recommended is for the Gaussian process of auricle reconstruct",
        ),
        Card(
            "Widest gap",
            f"{number(coverage.radius_mm, digits=2)} mm",
            "from any place to its nearest point: smaller features can stay unseen",
        ),
    ]
    if advised.wavelength_mm is not None:
        cards.append(
            Card(
                "Finest detail",
                f"{number(advised.wavelength_mm, digits=2)} mm",
                "wavelength of the finest harmonic the recommended number is made for",
            )
        )
    return tuple(cards)


def _need_table(result: PlanResult) -> Table:
    targets = sorted({target for target, _ in result.by_target})
    rows = []
    for target in targets:
        cells = [percent(target)]
        for how in ACQUISITIONS:
            found = result.by_target[target, how]
            cells.append("unreachable" if found.n_samples is None else f"{found.n_samples:,}")
            cells.append("–" if found.spacing_mm is None else number(found.spacing_mm, digits=2))
        rows.append(tuple(cells))
    head = (
        "Error",
        "Points, evenly spread",
        "one every, mm",
        "Points, wherever the catheter is",
        "one every, mm",
    )
    return Table("Points for other errors", head, tuple(rows))


def _opinion_table(result: PlanResult) -> Table:
    area = result.prepared.chamber.accessible_area
    rows = [
        (
            f"{each.published.source}: {each.published.mechanism}, {each.published.setting}",
            f"{each.published.mean_per_cm2:g} ± {each.published.deviation_per_cm2:g}",
            f"{each.n_samples:,} ({each.n_low:,} to {each.n_high:,})",
        )
        for each in second_opinions(area)
    ]
    rows += [
        (
            f"{name}, {distance:g} mm",
            "–",
            f"{samples_for_fill(distance, accessible_area=area):,} at the least",
        )
        for name, distance in FILL_DISTANCES_MM.items()
    ]
    head = ("Source", "Density per cm²", "Points on this surface")
    return Table("Second opinions: what others recommend or use", head, tuple(rows))


def _parameters_table(result: PlanResult) -> Table:
    config = result.config
    rows = [
        ("To be mapped", printable(result.wanted)),
        ("Target error", percent(config.target_nrmse)),
        ("Noise of a sample, relative to the map's deviation", percent(config.noise_ratio)),
        ("Samples", config.acquisition),
        ("Catheter", config.catheter or "one point at a time"),
        ("Design of single points", config.design.replace("_", " ")),
        ("Points asked for", "as needed" if config.n_samples is None else f"{config.n_samples:,}"),
        ("No points where this field is not 0", printable(config.forbid or "none")),
        (
            "Cycle length",
            "none" if config.cycle_length_ms is None else f"{config.cycle_length_ms:g} ms",
        ),
        ("Vertices to simplify to", f"{config.n_vertices:,}"),
        ("Harmonics to solve for", f"{config.n_modes:,}"),
        ("Seed", str(config.seed)),
    ]
    return Table("Parameters of this run", ("Parameter", "Value"), tuple(rows))
