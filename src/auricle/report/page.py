"""The page: one HTML file that tells a case to a cardiologist, complete in itself."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from auricle.report.answer import answer_sentence, focal_advice, measured_advice
from auricle.report.html import Caption, captioned, rendered
from auricle.report.tables import (
    DENSITY,
    HARMONICS,
    LEAST,
    NYQUIST,
    PLANNED,
    SPACING,
    UNPLANNED,
    WAVELENGTH,
    Table,
    geometry_table,
    measured_error_table,
    points_table,
    quantity_table,
    signals_table,
    surface_table,
)
from auricle.report.wording import number, printable
from auricle.sampling.criteria import POINTS_PER_HARMONIC
from auricle.spectral.weyl import trusted_modes
from auricle.study.result import CaseResult

CAPTIONS: Mapping[str, Caption] = MappingProxyType(
    {
        "fields.png": Caption(
            "The maps on the surface",
            "Each map as it was analysed, from the front and from the back. Grey: not sampled.",
            "The surface from the front and the back, coloured by each map's values.",
        ),
        "foci.png": Caption(
            "Simulated focal sources",
            "Bell-shaped foci of known width σ: for each width and number the map that was "
            "analysed.",
            "Small pictures of the surface, each with one to several coloured spots.",
        ),
        "cumulative_power.svg": Caption(
            "How much of a map the first harmonics hold",
            "Where a curve crosses a line of 85, 90, 95 or 99 %, read the number of harmonics "
            "below and the error that remains on the right.",
            "Curves of the share of power, rising with the number of harmonics, one a map.",
        ),
        "spectrum.svg": Caption(
            "How fine the maps are",
            "Power of each harmonic; the further right, the finer the detail (wavelength above). "
            "A smooth map falls off early, one with jumps falls slowly.",
            "Curves of power, falling with the number of harmonics, one a map.",
        ),
        "field_error.svg": Caption(
            "Error of the rebuilt maps",
            "Measured on the real surface where the map was sampled, relative to the map's "
            "standard deviation.",
            "Curves of the error of each map, falling with the number of harmonics.",
        ),
        "surface_reconstruction.png": Caption(
            "The surface rebuilt from few harmonics",
            "Coloured by the distance to the analysed surface, mm.",
            "The surface rebuilt from rising numbers of harmonics beside the original.",
        ),
        "geometry_error.svg": Caption(
            "Distance of the rebuilt surface",
            "How far the surface rebuilt from k harmonics lies from the analysed one, mm.",
            "Curves of four distances in mm, falling with the number of harmonics.",
        ),
    }
)
"""Captions of the figures, in the order of the page."""


def report_page(
    result: CaseResult,
    figures: Mapping[str, bytes],
    *,
    scan: Mapping[str, Any] | None = None,
) -> str:
    """The report as one HTML page: styles and figures inside, no script, no network.

    Names from the file are escaped. The same result and figures give the same text.

    Parameters
    ----------
    result
        The case.
    figures
        Content of the figures by file name (`.svg`, `.png`), as `figure_files` has them; those
        that are missing are left out, those without an entry in `CAPTIONS` come last.
    scan
        What to tell of the CT the surface was found in, as `segmentation_context` has it.
    """
    maps, foci = measured_advice(result), focal_advice(result)
    context = {
        "result": result,
        "scan": scan,
        "source_name": printable(result.source.name),
        "answer": answer_sentence(result),
        "cards": (*maps, *foci),
        "points": points_table(result),
        "remarks": [printable(remark) for remark in result.remarks],
        "repairs": [printable(str(repair)) for repair in result.repairs],
        "figures": captioned(figures, CAPTIONS),
        "tables": _number_tables(result),
        "surface": surface_table(result),
        "certificate": _certificate_words(result),
        "parameters": _parameters_table(result),
        "per_harmonic": POINTS_PER_HARMONIC,
        "n_trusted": trusted_modes(result.n_shell_vertices),
        "cap_share": sum(result.cap_areas_mm2) / result.shell_area_mm2,
        "versions": [f"{name} {version}" for name, version in result.versions.items()],
    }
    return rendered("report.html.j2", context)


def _number_tables(result: CaseResult) -> tuple[Table, ...]:
    return (
        quantity_table(result, HARMONICS),
        quantity_table(result, LEAST),
        quantity_table(result, PLANNED),
        quantity_table(result, SPACING),
        quantity_table(result, UNPLANNED),
        quantity_table(result, DENSITY),
        quantity_table(result, WAVELENGTH),
        quantity_table(result, NYQUIST),
        measured_error_table(result),
        quantity_table(result, HARMONICS, with_constant=True),
        signals_table(result),
        geometry_table(result),
    )


def _certificate_words(result: CaseResult) -> str:
    """The evidence that the harmonics are complete and accurate, in plain words."""
    found = result.certificate
    complete = (
        "none is missing"
        if found.eigenvalues_below_gap == found.n_modes
        else "the two counts differ, so these results must not be used"
    )
    again = "; ".join(printable(each) for each in found.retries)
    return (
        f"{found.n_asked:,} harmonics were asked for and {found.n_modes:,} computed. A count that "
        f"does not rely on the solver (matrix inertia) finds {found.eigenvalues_below_gap:,} "
        f"eigenvalues below {number(found.gap_per_mm2)}/mm²: {complete}. "
        f"They solve their equation to {number(found.largest_residual, digits=2)} and are "
        f"perpendicular to {number(found.largest_orthogonality_error, digits=2)} (relative); "
        f"{found.n_zero_modes} of them constant. Operator: {result.laplacian} Laplacian; solver: "
        f"{printable(found.method)}. " + (f"Searched again: {again}." if again else "")
    ).strip()


def _parameters_table(result: CaseResult) -> Table:
    config = result.config
    widths = ", ".join(f"{width:g}" for width in config.focus_widths_mm)
    return Table(
        "Parameters of this run",
        ("Parameter", "Value"),
        (
            ("Vertices to simplify to", f"{config.n_vertices:,}"),
            ("Harmonics to solve for", f"{config.n_modes:,}"),
            ("Fields", ", ".join(printable(name) for name in config.fields) or "all"),
            ("Widths σ of simulated foci", f"{widths} mm" if widths else "none"),
            ("Numbers of simulated foci", ", ".join(map(str, config.focus_counts)) or "none"),
            ("Seed", str(config.seed)),
        ),
    )
