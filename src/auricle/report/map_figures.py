"""Figures of a reconstruction: map, uncertainty, what the samples support, and their error."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from auricle.report.labels import figure_text, with_unit
from auricle.report.maps import MapPanel, Marks, maps_picture
from auricle.report.palettes import ColourScale, round_boundaries
from auricle.report.plan_figures import wavelength_panel
from auricle.report.wording import field_words
from auricle.study.mapping_result import MappingResult

WIDTH = 7.0
METHODS = {
    "gaussian_process": "this map (Gaussian process over harmonics)",
    "nearest": "nearest sample",
    "inverse_distance": "inverse distance",
    "harmonic": "linear along the surface (harmonic)",
    "linear_radial": "radial functions, linear",
    "thin_plate": "radial functions, thin plate",
}
"""Names of the methods in words."""


def map_picture(result: MappingResult) -> Figure:
    """Map, standard deviation and supported wavelength, with the samples and the next points."""
    unit = result.placed.unit
    values = np.where(result.singular, np.nan, result.mean)
    cyclic = result.config.cycle_length_ms is not None
    palette = "cyclic" if cyclic else "perceptual"
    label = with_unit(
        figure_text(field_words(result.placed.name)), figure_text(unit) if unit else ""
    )
    panels = [
        MapPanel(
            "map",
            values,
            ColourScale(palette, _boundaries(values), label),
            "no direction (singular)",
        ),
        MapPanel(
            "uncertainty",
            result.std,
            ColourScale(
                "distance",
                _boundaries(result.std),
                with_unit("standard deviation", figure_text(unit) if unit else ""),
            ),
        ),
        wavelength_panel(result.wavelengths),
    ]
    mesh = result.prepared.chamber.mesh
    marks = [Marks("samples", result.placed.sites.positions(mesh))]
    if result.next_points:
        places = np.array([point.position for point in result.next_points])
        marks.append(Marks("next points", places, colour="#d00000", numbered=True))
    return maps_picture(result.prepared.surface, panels, marks=marks)


def _boundaries(values: np.ndarray) -> tuple[float, ...]:
    edges = round_boundaries(values) if np.isfinite(values).any() else np.array([0.0, 1.0])
    return tuple(float(edge) for edge in edges)


def progression_figure(result: MappingResult) -> Figure:
    """Predicted error as the samples came, and as it would go on with the next points."""
    figure = Figure(figsize=(WIDTH, 3.6), layout="constrained")
    axes = figure.subplots()
    counts, errors = result.progression.counts, 100 * result.progression.predicted_nrmse
    axes.plot(counts, errors, "o-", color="#0072b2", label="samples in the order of the file")
    if result.next_points:
        ahead = len(result.placed) + np.arange(len(result.next_points) + 1)
        following = 100 * np.concatenate([[result.predicted_nrmse], result.next_nrmse])
        axes.plot(ahead, following, ".-", color="#d00000", label="with the next points proposed")
    axes.axhline(100 * result.config.target_nrmse, color="#777777", lw=0.8, label="target")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.xaxis.set_major_formatter("{x:,.0f}")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_xlabel("samples (number)")
    axes.set_ylabel("predicted error, nRMSE (%)")
    axes.grid(color="#e4e4e4", lw=0.5, which="both")
    axes.legend(frameon=False)
    return figure


def validation_figure(result: MappingResult) -> Figure:
    """Error of each method on samples that were kept from it."""
    figure = Figure(figsize=(WIDTH, 2.6), layout="constrained")
    axes = figure.subplots()
    names = list(result.cross_validation)[::-1]
    errors = [100 * result.cross_validation[name].relative for name in names]
    colours = ["#0072b2" if name == "gaussian_process" else "#bbbbbb" for name in names]
    bars = axes.barh([METHODS[name] for name in names], errors, color=colours)
    axes.bar_label(bars, fmt="%.3g", padding=2)
    axes.margins(x=0.1)
    axes.set_xlabel("error of left-out samples (% of the samples' deviation)")
    return figure
