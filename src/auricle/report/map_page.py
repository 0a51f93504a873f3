"""The page of a reconstruction, and the folder it comes in."""

import csv
import io
import math
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from types import MappingProxyType

import numpy as np
from matplotlib.figure import Figure

from auricle.atomic import write_bytes, write_text
from auricle.progress import Progress, silent
from auricle.report.gallery import drawn_files
from auricle.report.html import Caption, captioned, rendered
from auricle.report.map_figures import METHODS, map_picture, progression_figure, validation_figure
from auricle.report.plan_page import Card
from auricle.report.tables import Table
from auricle.report.wording import field_words, number, percent, printable
from auricle.study.mapping_result import MappingResult
from auricle.study.sampling_store import mapping_document
from auricle.study.store import json_text
from auricle.surface.field import FieldMap
from auricle.surface.writing import write_surface

CAPTIONS: Mapping[str, Caption] = MappingProxyType(
    {
        "map.png": Caption(
            "The map, its uncertainty, and what the samples support",
            "From four sides. Black: samples; red, numbered: where to sample next. Where the "
            "wavelength is grey the samples support nothing.",
            "The surface from four sides in three rows: map, standard deviation, wavelength.",
        ),
        "progression.svg": Caption(
            "Error as the samples came",
            "Predicted with the first so many samples of the file, and with the next points "
            "proposed.",
            "A curve of the predicted error, falling with the number of samples.",
        ),
        "validation.svg": Caption(
            "Samples left out",
            "Each method predicts a tenth of the samples from the others, ten times. The noise of "
            "the samples is part of every error.",
            "Bars of the error of six methods.",
        ),
    }
)
"""Captions of the figures, in the order of the page."""


def map_answer(result: MappingResult) -> str:
    """The answer in a sentence."""
    if not result.verdict.enough:
        verdict = f"Not enough yet: {'; '.join(result.verdict.reasons)}"
    else:
        verdict = (
            f"Enough for an error of {percent(result.config.target_nrmse)}: the predicted error is "
            f"{percent(result.predicted_nrmse)}"
        )
    return f"{verdict}."


def write_map(result: MappingResult, folder: Path, *, progress: Progress = silent) -> Path:
    """Write a reconstruction's report, map, tables and, last, result.json; returns the report.

    Raises
    ------
    OutputError
        If the folder cannot be written.
    """
    figures = drawn_files(_figures(result), progress)
    page = map_page(result, figures)
    document = json_text(mapping_document(result))
    for name, content in figures.items():
        write_bytes(folder / "figures" / name, content)
    write_surface(
        folder / "map.vtp", result.prepared.surface, map_fields(result), space=result.prepared.space
    )
    write_text(folder / "samples.csv", samples_csv(result))
    write_text(folder / "next_points.csv", next_points_csv(result))
    write_text(folder / "report.html", page)
    write_text(folder / "timings.json", json_text({"wall_s": dict(result.seconds)}))
    write_text(folder / "result.json", document)
    return folder / "report.html"


def map_fields(result: MappingResult) -> list[FieldMap]:
    """The map and what goes with it, as fields on the analysed surface."""
    mesh, name, unit = result.prepared.surface, result.placed.name, result.placed.unit
    wavelengths = np.where(np.isfinite(result.wavelengths), result.wavelengths, np.nan)
    return [
        FieldMap(mesh, np.where(result.singular, np.nan, result.mean), name, unit),
        FieldMap(mesh, result.std, f"{name}_standard_deviation", unit),
        FieldMap(mesh, wavelengths, "supported_wavelength", "mm"),
        FieldMap(mesh, result.undersampled.astype(float), "undersampled"),
    ]


def samples_csv(result: MappingResult) -> str:
    """The samples used: place on the surface, value, and how far the others' prediction is off."""
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    residuals = result.residuals.reshape(len(result.placed), -1)
    names = ["residual"] if residuals.shape[1] == 1 else ["residual_cos", "residual_sin"]
    writer.writerow(
        ["row", "x_mm", "y_mm", "z_mm", "distance_mm", "value", "n_merged", *names, "doubted"]
    )
    positions = result.placed.sites.positions(result.prepared.chamber.mesh)
    for index, position in enumerate(positions.tolist()):
        writer.writerow(
            [
                int(result.placed.kept[index]) + 1,
                *(f"{value:.3f}" for value in position),
                f"{result.placed.distances[index]:.3f}",
                f"{result.placed.values[index]:.6g}",
                int(result.placed.counts[index]),
                *(f"{value:.4g}" for value in residuals[index]),
                int(index in result.doubted),
            ]
        )
    return file.getvalue()


def next_points_csv(result: MappingResult) -> str:
    """Where to sample next, best first, with the error predicted once each is taken."""
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(["order", "x_mm", "y_mm", "z_mm", "predicted_nrmse"])
    for order, (point, error) in enumerate(
        zip(result.next_points, result.next_nrmse, strict=True), start=1
    ):
        place = (f"{value:.3f}" for value in point.position.tolist())
        writer.writerow([order, *place, f"{error:.5f}"])
    return file.getvalue()


def map_page(result: MappingResult, figures: Mapping[str, bytes]) -> str:
    """The report as one HTML page, complete in itself."""
    prepared = result.prepared
    context = {
        "source": prepared.source,
        "source_name": printable(prepared.source.name),
        "samples_source": result.samples_source,
        "samples_name": printable(result.samples_source.name),
        "n_samples": len(result.placed),
        "area_cm2": prepared.chamber.accessible_area / 100,
        "answer": map_answer(result),
        "cards": _cards(result),
        "reasons": [printable(reason) for reason in result.verdict.reasons],
        "remarks": [
            printable(str(each)) for each in (*prepared.repairs, *prepared.remarks, *result.remarks)
        ],
        "figures": captioned(figures, CAPTIONS),
        "tables": _tables(result),
        "coverage": result.coverage,
        "hyper": result.hyperparameters,
        "parameters": _parameters_table(result),
        "versions": [f"{name} {version}" for name, version in result.versions.items()],
    }
    return rendered("map.html.j2", context)


def _figures(result: MappingResult) -> dict[str, Callable[[], Figure]]:
    wanted: dict[str, Callable[[], Figure]] = {
        "map.png": partial(map_picture, result),
        "progression.svg": partial(progression_figure, result),
    }
    if result.cross_validation:
        wanted["validation.svg"] = partial(validation_figure, result)
    return wanted


def _cards(result: MappingResult) -> tuple[Card, ...]:
    unit = f" {result.placed.unit}" if result.placed.unit else ""
    noise = result.hyperparameters.noise
    if result.config.cycle_length_ms is not None:
        noise *= result.config.cycle_length_ms * math.sqrt(2) / (2 * math.pi)
        unit = unit or " ms"
    cards = [
        Card(
            "Predicted error",
            percent(result.predicted_nrmse),
            f"of the map's deviation; target {percent(result.config.target_nrmse)}",
        ),
        Card(
            "Widest gap",
            f"{number(result.coverage.radius_mm, digits=2)} mm",
            "from any place to its nearest sample: smaller features can lie there unseen",
        ),
        Card(
            "Noise of a sample",
            f"{number(noise, digits=2)}{printable(unit)}",
            "standard deviation, as given"
            if _is_given(result)
            else "standard deviation, estimated",
        ),
    ]
    if result.brackets:
        finest = result.brackets[-1]
        cards.append(
            Card(
                "Bandwidth",
                f"{finest.lower:,} to {finest.upper:,} harmonics",
                f"hold {percent(finest.share)} of the variation",
            )
        )
    return tuple(cards)


def _is_given(result: MappingResult) -> bool:
    return result.config.noise is not None or result.placed.noise is not None


def _tables(result: MappingResult) -> list[Table]:
    tables = [_coverage_table(result)]
    if result.brackets:
        tables.append(_bandwidth_table(result))
    if result.next_points:
        tables.append(_next_table(result))
    if result.cross_validation:
        tables.append(_validation_table(result))
    return tables


def _bandwidth_table(result: MappingResult) -> Table:
    rows = tuple(
        (percent(math.sqrt(1 - each.share)), f"{each.lower:,}", f"{each.upper:,}")
        for each in result.brackets
    )
    head = ("Error", "Harmonics at least", "Harmonics at most")
    return Table("Bandwidth of the map, as the samples so far have it", head, rows)


def _next_table(result: MappingResult) -> Table:
    points = zip(result.next_points, result.next_nrmse.tolist(), strict=True)
    rows = tuple(
        (str(order), *(number(x, digits=4) for x in point.position.tolist()), percent(error))
        for order, (point, error) in enumerate(points, start=1)
    )
    head = ("Next point", "x, mm", "y, mm", "z, mm", "predicted error then")
    return Table("Where to sample next (frame of the surface's file)", head, rows)


def _validation_table(result: MappingResult) -> Table:
    rows = tuple(
        (METHODS[name], number(error.rms), percent(error.relative))
        for name, error in result.cross_validation.items()
    )
    unit = result.placed.unit if result.config.cycle_length_ms is None else ""
    head = ("Method", _with_unit("Error", unit), "of the samples' deviation")
    return Table("Samples left out, predicted from the others", head, rows)


def _with_unit(words: str, unit: str) -> str:
    """Words with their unit after a comma, where there is one."""
    return f"{words}, {printable(unit)}" if unit else words


def _coverage_table(result: MappingResult) -> Table:
    found = result.coverage
    rows = [
        ("Samples used", f"{len(result.placed):,}"),
        ("Density", f"{number(found.density_per_cm2)} per cm²"),
        ("Median distance to the nearest other", f"{number(found.spacing_mm)} mm"),
        ("Farthest place from any sample", f"{number(found.radius_mm)} mm"),
        *(
            (f"Area within {radius:g} mm of a sample", percent(share))
            for radius, share in found.within.items()
        ),
        ("Area too sparsely sampled for the map's bandwidth", percent(result.undersampled_share)),
        (
            "Mean square of the standardised left-out residuals (1 is right)",
            number(result.loo_variance),
        ),
    ]
    return Table("The samples", ("Quantity", "Value"), tuple(rows))


def _parameters_table(result: MappingResult) -> Table:
    config, hyper = result.config, result.hyperparameters
    cycle = config.cycle_length_ms
    rows = [
        ("Values", field_words(result.placed.name)),
        ("Cycle length", "none" if cycle is None else f"{cycle:g} ms"),
        ("Farthest off the surface", f"{config.max_distance_mm:g} mm"),
        ("Isolated samples count less", "yes" if config.robust else "no"),
        ("Correlation length (fitted)", f"{number(hyper.length)} mm"),
        ("Amplitude (fitted)", number(hyper.amplitude)),
        ("Vertices to simplify to", f"{config.n_vertices:,}"),
        ("Harmonics to solve for", f"{config.n_modes:,}"),
        ("Seed", str(config.seed)),
    ]
    return Table("Parameters of this run", ("Parameter", "Value"), tuple(rows))
