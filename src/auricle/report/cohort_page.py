"""The page of a cohort: the paper's tables and figures over all cases, and what became of them."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any

from matplotlib.figure import Figure

from auricle.atomic import write_bytes, write_text
from auricle.errors import InputError
from auricle.progress import Progress, silent
from auricle.report.cohort_answers import study_answers
from auricle.report.cohort_charts import (
    feature_error_figure,
    feature_spectra_figure,
    geometry_spectra_figure,
    quality_figure,
    tau_figure,
    width_figure,
)
from auricle.report.cohort_cost_tables import cost_tables
from auricle.report.cohort_csv import count_csv, decay_csv
from auricle.report.cohort_further_tables import (
    bootstrap_table,
    class_table,
    recovered_table,
    resolution_table,
    segmentation_table,
    thinned_table,
)
from auricle.report.cohort_pictures import (
    rebuilt_maps_picture,
    rebuilt_surfaces_picture,
    thinned_maps_picture,
)
from auricle.report.cohort_tables import (
    assumption_table,
    case_name,
    case_table,
    count_table,
    decay_table,
    power_table,
    reading_table,
)
from auricle.report.gallery import drawn_files
from auricle.report.html import Caption, captioned, rendered
from auricle.report.reproduction_page import reproduction_markdown
from auricle.report.reproduction_tables import reproduction_tables
from auricle.report.tables import Table
from auricle.report.wording import counted, listed, printable
from auricle.study.cohort.costs import Timed
from auricle.study.paper.claims import claims
from auricle.study.paper.surfaces import pictured_surfaces
from auricle.study.paper.tables import (
    Values,
    count_rows,
    decay_rows,
    decays_by_range,
    headline_decays,
)

CAPTIONS: Mapping[str, Caption] = MappingProxyType(
    {
        "figure_1.svg": Caption(
            "Figure 1: the spectrum of the geometry",
            "(a) Size of the coefficients of x, y and z of one atrium, as what each harmonic moves "
            "the surface by. (b) Power accumulated over the harmonics, a line an atrium, without "
            "the constant; the crosses are what the paper prints for 85 and 90 %.",
            "Coefficients falling with the harmonic, and curves of accumulated power that reach "
            "95 % within a few harmonics, far to the left of the printed crosses.",
        ),
        "figure_2.svg": Caption(
            "Figure 2: error of the rebuilt surface",
            "Mean over the atria (dots) with one standard deviation (band), single atria thin. GD "
            "from the original's points to the rebuilt surface; MSE vertex by vertex for "
            "harmonics, to the nearest point left for Qslim. On these axes an exponential would "
            "bend down ever more steeply: the errors fall more nearly as powers.",
            "Two charts of errors falling with the number of coefficients or points, a curve for "
            "each method.",
        ),
        "figure_3.png": Caption(
            "Figure 3: the atrium from 50, 250 and 500 harmonics, and points",
            "(a, b, c) rebuilt from harmonics, all vertices kept; (d, e, f) thinned out by Qslim. "
            "Coloured by the distance to the original surface, mm.",
            "Six views of one atrium, rounder with fewer harmonics and more angular with fewer "
            "points, beside the original.",
        ),
        "figure_4.png": Caption(
            "Figure 4: focal maps on the recovered atrium",
            "Map and surface from the same number of harmonics; small, medium and wide foci from "
            "top to bottom.",
            "An atrium with two coloured spots in each panel; small spots are smeared with few "
            "harmonics.",
        ),
        "figure_4_points.png": Caption(
            "Figure 4, by points: the same maps thinned out in R⁴",
            "Qslim with the map as the fourth component: its points gather where the map changes. "
            "Each map has a surface of its own; colours are linear between its points.",
            "The same atrium, more angular with fewer points, its spots sharp with as few as 50.",
        ),
        "feature_error.svg": Caption(
            "Error of the maps: harmonics against points",
            "Geometric mean over the atria with one standard deviation (band). Qslim of the "
            "geometry reads the map at its points; in R⁴ it places them knowing the map, which no "
            "mapping procedure does before it has mapped. Dotted: the error that leaves the "
            "largest share of Table 1.",
            "Three charts of errors falling with the number of harmonics or points; for small foci "
            "points placed in R⁴ fall first, for wide ones harmonics.",
        ),
        "figure_5.svg": Caption(
            "Figure 5: the spectra of the focal maps",
            "Share of the power in each harmonic, mean over cases and placements, over bands of a "
            "tenth of a decade. What a Gaussian holds falls off as exp(−σ²κ²); the level tails "
            "far down are the mesh's.",
            "Three charts with falling curves, that of the wide foci first.",
        ),
        "decay.svg": Caption(
            "τ of every atrium",
            "The exponential fitted to evenly spread counts from 10 on, without a floor; red: as "
            "printed.",
            "Pairs of decay constants joined by lines, with means here and as printed.",
        ),
        "width.svg": Caption(
            "Harmonics against the width of a focus",
            "One focus at every placement; dots: median of a case, lines from least to most.",
            "Counts falling with the width along the dashed line of the closed form.",
        ),
    }
)
"""Captions of the figures, in the order of the page."""


def write_cohort(
    documents: Sequence[Timed],
    folder: Path,
    *,
    progress: Progress = silent,
) -> Path:
    """Write a study's tables, figures and, last, its page into `folder`; returns the page.

    ``table1.csv`` and ``decay.csv`` hold the numbers, ``figures/`` the figures,
    ``reproduction.md`` the conventions; ``report.html`` alone is complete.

    Parameters
    ----------
    documents
        The cases that succeeded, in the order of the study.
    folder
        Where to.
    progress
        Told how many figures are drawn.

    Raises
    ------
    InputError
        If there is no case.
    OutputError
        If the folder cannot be written.
    """
    values = [document.values for document in documents]
    counts, decays = count_rows(values), decay_rows(values)
    figures = drawn_files(_figures(values), progress)
    page = cohort_page(documents, figures)
    for name, content in figures.items():
        write_bytes(folder / "figures" / name, content)
    write_text(folder / "table1.csv", count_csv(counts))
    write_text(folder / "decay.csv", decay_csv(decays))
    write_text(folder / "reproduction.md", reproduction_markdown(values))
    write_text(folder / "report.html", page)
    return folder / "report.html"


def cohort_page(documents: Sequence[Timed], figures: Mapping[str, bytes]) -> str:
    """The page as HTML, complete in itself; the same documents give the same text.

    Parameters
    ----------
    documents
        As `write_cohort` takes them.
    figures
        Content by file name.

    Raises
    ------
    InputError
        If there is no case.
    """
    values = [document.values for document in documents]
    counts, decays = count_rows(values), decay_rows(values)
    headline, found = headline_decays(decays), claims(values)
    shown = {figure.caption.title: figure for figure in captioned(figures, CAPTIONS)}
    by_name = {
        name: [shown[caption.title]] for name, caption in CAPTIONS.items() if caption.title in shown
    }
    context: dict[str, Any] = {
        "kinds": _kinds(values),
        "answers": study_answers(values, counts, decays, found),
        "claims": found,
        "counts": count_table(counts),
        "decay": decay_table(
            decays_by_range(decays),
            "τ, mean ± deviation over cases (harmonics or points), by the counts it is fitted to",
        ),
        "ranges": _ranges(values[0]),
        "assumptions": assumption_table(headline),
        "readings": reading_table(decays),
        "cases": case_table(values),
        "conventions": reproduction_tables(values),
        "powers": power_table(values),
        "thinned": [table for table in (thinned_table(values),) if table.rows],
        "further": [
            table
            for table in (
                class_table(values),
                resolution_table(values),
                recovered_table(values),
                segmentation_table(values),
                bootstrap_table(values),
            )
            if table.rows
        ],
        "costs": cost_tables(documents),
        "figures": {name.partition(".")[0]: by_name.get(name, []) for name in CAPTIONS},
        "parameters": _parameters(values[0]),
        "versions": [f"{name} {version}" for name, version in values[0]["versions"].items()],
        "remarks": _remarks(values),
    }
    return rendered("cohort.html.j2", context)


def _figures(values: Sequence[Values]) -> dict[str, Callable[[], Figure]]:
    example = _example(values)
    wanted: dict[str, Callable[[], Figure]] = {
        "figure_1.svg": partial(geometry_spectra_figure, values, example),
        "figure_2.svg": partial(quality_figure, values),
        "decay.svg": partial(tau_figure, values),
    }
    if example["surfaces"]:
        surfaces = pictured_surfaces(example["surfaces"])
        wanted["figure_3.png"] = partial(rebuilt_surfaces_picture, surfaces)
        if surfaces.maps:
            wanted["figure_4.png"] = partial(rebuilt_maps_picture, surfaces)
            wanted["figure_4_points.png"] = partial(thinned_maps_picture, surfaces)
    if values[0]["thinned_features"]:
        wanted["feature_error.svg"] = partial(feature_error_figure, values)
    if values[0]["features"]:
        wanted["figure_5.svg"] = partial(feature_spectra_figure, values)
    if values[0]["beyond"]["width_curve"]:
        wanted["width.svg"] = partial(width_figure, values)
    return wanted


def _example(values: Sequence[Values]) -> Values:
    """The case that is pictured: the first whose surfaces were kept, or the first."""
    if not values:
        raise InputError("no case succeeded: there is nothing to report")
    return next((each for each in values if each["surfaces"]), values[0])


def _kinds(values: Sequence[Values]) -> str:
    kinds = Counter(each["kind"] for each in values)
    words = {
        "surface": "surface file",
        "volume": "CT",
        "phantom": "generated CT",
        "generated surface": "generated surface",
    }
    return listed([counted(n, words.get(kind, kind)) for kind, n in kinds.items()])


def _ranges(values: Values) -> str:
    """What the names of the ranges of counts mean."""
    counts = sorted(values["parameters"]["fitted_counts"])
    shown = ", ".join(f"{count:,}" for count in counts[:3])
    return (
        f"Counts fitted: “even” are {shown} … {counts[-1]:,}; “even from 50” leaves the smaller "
        "ones out; “geometric” are those in steps of a third or more."
    )


def _parameters(values: Values) -> Table:
    rows = tuple(
        (
            name.replace("_", " "),
            ", ".join(map(_plain, value)) if isinstance(value, list) else _plain(value),
        )
        for name, value in values["parameters"].items()
    )
    return Table("Parameters of every case", ("Parameter", "Value"), rows)


def _plain(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:,}" if isinstance(value, int) else f"{value:g}"


def _remarks(values: Sequence[Values]) -> list[str]:
    remarks = []
    for each in values:
        name = case_name(each)
        scan = each["scan"] or {"reasons": []}
        remarks += [
            f"{name}: {printable(str(text))}" for text in (*each["remarks"], *scan["reasons"])
        ]
        if each["shell"]["cap_areas_mm2"]:
            share = sum(each["shell"]["cap_areas_mm2"]) / each["shell"]["area_mm2"]
            remarks.append(
                f"{name}: {counted(len(each['shell']['cap_areas_mm2']), 'hole')} closed by caps, "
                f"{share:.1%} of the closed surface's area"
            )
    return remarks
