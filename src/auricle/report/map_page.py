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

NOTHING_KNOWN = Caption(
    "The samples and where to go next",
    "From four sides. Black: samples; red, numbered: where to sample next.",
    "The bare surface from four sides with the samples and the next points on it.",
)
"""Caption of the first figure where there is no map to show."""


_OTHER_FIELDS = ("supported_wavelength", "undersampled")


def map_answer(result: MappingResult) -> str:
    """The answer in a sentence."""
    if not result.verdict.enough:
        verdict = f"Not enough yet: {printable('; '.join(result.verdict.reasons))}"
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
    write_surface(
        folder / "map.vtp", result.prepared.surface, map_fields(result), space=result.prepared.space
    )
    for name, content in figures.items():
        write_bytes(folder / "figures" / name, content)
    write_text(folder / "samples.csv", samples_csv(result))
    write_text(folder / "next_points.csv", next_points_csv(result))
    write_text(folder / "report.html", page)
    write_text(folder / "timings.json", json_text({"wall_s": dict(result.seconds)}))
    write_text(folder / "result.json", document)
    return folder / "report.html"


def map_fields(result: MappingResult) -> list[FieldMap]:
    """The map and what goes with it, as fields on the analysed surface."""
    mesh, unit = result.prepared.surface, printable(result.placed.unit)
    name = printable(result.placed.name) or "values"
    if name in _OTHER_FIELDS:
        name = f"sampled_{name}"
    wavelengths = np.where(np.isfinite(result.wavelengths), result.wavelengths, np.nan)
    return [
        FieldMap(mesh, np.where(result.singular, np.nan, result.mean), name, unit),
        FieldMap(mesh, result.std, f"{name}_standard_deviation", unit),
        FieldMap(mesh, wavelengths, _OTHER_FIELDS[0], "mm"),
        FieldMap(mesh, result.undersampled.astype(float), _OTHER_FIELDS[1]),
    ]


def samples_csv(result: MappingResult) -> str:
    """The samples used: place on the surface, value, and how far the others' prediction is off.

    ``row`` counts the samples of the file from 1; residuals are empty where nothing is known.
    """
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    unit = f"_{printable(result.placed.unit)}" if result.placed.unit else ""
    places = ("row", "x_mm", "y_mm", "z_mm", "distance_mm")
    writer.writerow([*places, f"value{unit}", "n_merged", f"residual{unit}", "doubted"])
    positions = result.placed.sites.positions(result.prepared.chamber.mesh)
    for index, position in enumerate(positions.tolist()):
        residual = float(result.residuals[index])
        writer.writerow(
            [
                int(result.placed.kept[index]) + 1,
                *(f"{value:.3f}" for value in position),
                f"{result.placed.distances[index]:.3f}",
                f"{result.placed.values[index]:.6g}",
                int(result.placed.counts[index]),
                f"{residual:.4g}" if math.isfinite(residual) else "",
                int(index in result.doubted),
            ]
        )
    return file.getvalue()


def next_points_csv(result: MappingResult) -> str:
    """Where to sample next, best first, with the error predicted once each is taken.

    The error is empty where nothing is known of the map.
    """
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(["order", "x_mm", "y_mm", "z_mm", "predicted_nrmse"])
    for order, (point, error) in enumerate(
        zip(result.next_points, result.next_nrmse, strict=True), start=1
    ):
        place = (f"{value:.3f}" for value in point.position.tolist())
        writer.writerow([order, *place, f"{error:.5f}" if math.isfinite(error) else ""])
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
        "known": not result.knows_nothing,
        "detail_words": "" if result.knows_nothing else _detail_words(result),
        "made_of": _made_of(result),
        "area_cm2": prepared.chamber.accessible_area / 100,
        "answer": map_answer(result),
        "cards": _cards(result),
        "remarks": [
            printable(str(each)) for each in (*prepared.repairs, *prepared.remarks, *result.remarks)
        ],
        "figures": captioned(figures, _captions(result)),
        "tables": _tables(result),
        "coverage": result.coverage,
        "hyper": result.hyperparameters,
        "parameters": _parameters_table(result),
        "versions": [f"{name} {version}" for name, version in result.versions.items()],
    }
    return rendered("map.html.j2", context)


def _captions(result: MappingResult) -> Mapping[str, Caption]:
    return {**CAPTIONS, "map.png": NOTHING_KNOWN} if result.knows_nothing else CAPTIONS


def _figures(result: MappingResult) -> dict[str, Callable[[], Figure]]:
    wanted: dict[str, Callable[[], Figure]] = {"map.png": partial(map_picture, result)}
    if len(result.progression.counts):
        wanted["progression.svg"] = partial(progression_figure, result)
    if result.cross_validation:
        wanted["validation.svg"] = partial(validation_figure, result)
    return wanted


def _cards(result: MappingResult) -> tuple[Card, ...]:
    gap = Card(
        "Widest gap",
        f"{number(result.coverage.radius_mm, digits=2)} mm",
        "from any place to its nearest sample: smaller features can lie there unseen",
    )
    if result.knows_nothing:
        return (gap,)
    error = Card(
        "Predicted error",
        percent(result.predicted_nrmse),
        f"of the map's deviation; target {percent(result.config.target_nrmse)}. "
        f"{percent(result.smooth_nrmse)} if all that was fitted as noise is noise, and none of it "
        "detail of the map",
    )
    stated = result.noise_stated
    known = "none stated" if stated is None else f"stated: {_with_unit(stated, result)}"
    noise = Card(
        "Noise of a sample",
        _with_unit(result.noise_fitted, result),
        f"standard deviation, fitted; {known}",
    )
    cards = [error, gap, noise]
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


def _detail_words(result: MappingResult) -> str:
    """Which truth the errors are meant against."""
    fitted = _with_unit(result.noise_fitted, result)
    if result.noise_stated is None:
        return (
            f"No noise was stated, and the samples alone cannot tell it from detail too fine for "
            f"them: all that was fitted as noise ({fitted}) counts as detail of the map"
        )
    stated = _with_unit(result.noise_stated, result)
    if result.noise_fitted <= result.noise_stated:
        return f"The noise stated ({stated}) explains all that was fitted as noise ({fitted})"
    return (
        f"Of what was fitted as noise ({fitted}), what goes beyond the noise stated ({stated}) "
        "counts as detail of the map"
    )


def _made_of(result: MappingResult) -> str:
    """What the map is a mean of, if of more than the Gaussian process."""
    if result.hyperparameters is None or not result.hyperparameters.splines:
        return ""
    splines = sorted(result.hyperparameters.splines, key=lambda term: term.power)
    shares = " and ".join(percent(term.share) for term in splines)
    bounded = (
        "; it does not go beyond a least or largest value that many samples share, and is "
        "steeper between the two if most samples share them"
    )
    return (
        f"The map is the mean of a Gaussian process over the harmonics "
        f"({percent(1 - sum(term.share for term in splines))}) and of splines through space "
        f"({shares}), rougher ones first, all smoothed for the same noise and weighed by what they "
        f"miss of samples left out with their neighbours; where they differ it is less sure"
        f"{bounded if result.config.cycle_length_ms is None else ''}"
    )


def _with_unit(value: float, result: MappingResult) -> str:
    """A value of the map with its unit, where that is stated."""
    unit = printable(result.placed.unit)
    return f"{number(value, digits=2)} {unit}" if unit else number(value, digits=2)


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
    known = not result.knows_nothing
    rows = []
    for order, (point, error) in enumerate(
        zip(result.next_points, result.next_nrmse.tolist(), strict=True), start=1
    ):
        place = (number(x, digits=4) for x in point.position.tolist())
        rows.append((str(order), *place, *[percent(error)] * known))
    head = ("Next point", "x, mm", "y, mm", "z, mm", *["predicted error then"] * known)
    return Table("Where to sample next (frame of the surface's file)", head, tuple(rows))


def _validation_table(result: MappingResult) -> Table:
    rows = tuple(
        (METHODS[name], number(error.rms), percent(error.relative))
        for name, error in result.cross_validation.items()
    )
    cyclic = result.config.cycle_length_ms is not None
    unit = "of cosine and sine, no unit" if cyclic else printable(result.placed.unit)
    head = ("Method", f"Error, {unit or 'no unit stated'}", "of the samples' deviation")
    return Table("Samples left out, predicted from the others", head, rows)


def _coverage_table(result: MappingResult) -> Table:
    found = result.coverage
    rows = [
        ("Places sampled", f"{len(result.placed):,}"),
        ("Density", f"{number(found.density_per_cm2)} per cm²"),
        ("Median distance to the nearest other", _millimetres(found.spacing_mm)),
        ("Farthest place from any sample", f"{number(found.radius_mm)} mm"),
        *(
            (f"Area within {radius:g} mm of a sample", percent(share))
            for radius, share in found.within.items()
        ),
    ]
    if not result.knows_nothing:
        rows += [
            (
                "Area too sparsely sampled for the map's bandwidth",
                percent(result.undersampled_share),
            ),
            (
                "Mean square of the standardised left-out residuals (1 is right)",
                number(result.loo_variance),
            ),
        ]
    return Table("The samples", ("Quantity", "Value"), tuple(rows))


def _parameters_table(result: MappingResult) -> Table:
    config, cycle = result.config, result.config.cycle_length_ms
    rows = [
        ("Values", field_words(result.placed.name)),
        ("Unit of the values", printable(result.placed.unit) or "not stated"),
        ("Noise stated", _noise_words(result)),
        ("Target error", percent(config.target_nrmse)),
        ("Cycle length", "none" if cycle is None else f"{cycle:g} ms"),
        ("Farthest off the surface", f"{config.max_distance_mm:g} mm"),
        ("Isolated samples count less", "yes" if config.robust else "no"),
        ("No next point where this field is not 0", printable(config.forbid or "none")),
        *_fitted_rows(result),
        ("Vertices to simplify to", f"{config.n_vertices:,}"),
        ("Harmonics to solve for", f"{config.n_modes:,}"),
        ("Seed", str(config.seed)),
    ]
    return Table("Parameters of this run", ("Parameter", "Value"), tuple(rows))


def _millimetres(length: float) -> str:
    return f"{number(length)} mm" if math.isfinite(length) else "–"


def _noise_words(result: MappingResult) -> str:
    config = result.config
    if config.noise_column is not None:
        return f"by sample, column {printable(config.noise_column)}"
    return "none" if config.noise is None else _with_unit(config.noise, result)


def _fitted_rows(result: MappingResult) -> list[tuple[str, str]]:
    found = result.hyperparameters
    if found is None:
        return []
    cyclic = result.config.cycle_length_ms is not None
    amplitude = (
        f"{number(found.amplitude)}, of cosine and sine"
        if cyclic
        else _with_unit(found.amplitude, result)
    )
    averaged = f" (the likeliest of {len(found.terms)} averaged)" if len(found.terms) > 1 else ""
    return [
        ("Correlation length (fitted)", f"{number(found.length)} mm{averaged}"),
        ("Smoothness ν (fitted)", f"{found.smoothness:g}{averaged}"),
        ("Amplitude (fitted)", amplitude),
    ]
