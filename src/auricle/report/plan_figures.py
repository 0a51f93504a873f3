"""Figures of a sampling plan: the points on the surface, the error against their number."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from auricle.report.labels import figure_text, unit_of, with_unit
from auricle.report.maps import MapPanel, Marks, maps_picture
from auricle.report.palettes import ColourScale, round_boundaries
from auricle.report.wording import field_words
from auricle.study.planning import PlanResult

WIDTH = 7.0
_COLOURS = {"planned": "#0072b2", "unplanned": "#d55e00"}
WAVELENGTHS = (5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 50.0, 70.0, 100.0)
"""Boundaries of the colours of wavelengths, mm; the same in every report."""


def plan_picture(result: PlanResult) -> Figure:
    """The planned points on the surface, over an example of the map and what they support."""
    panels = []
    if result.example is not None:
        values = result.example.values
        boundaries = tuple(float(edge) for edge in round_boundaries(values))
        title = (
            "such a map"
            if result.config.map_class
            else figure_text(field_words(result.example.name))
        )
        label = with_unit("such a map", unit_of(result.example))
        panels.append(
            MapPanel(title, values, ColourScale("perceptual", boundaries, label), "not sampled")
        )
    panels.append(wavelength_panel(result.wavelengths))
    marks = [Marks("planned points", result.positions)]
    if len(result.existing):
        taken = result.existing.positions(result.prepared.chamber.mesh)
        marks.append(Marks("taken already", taken, colour="#d00000"))
    return maps_picture(result.prepared.surface, panels, marks=marks)


def wavelength_panel(wavelengths: np.ndarray) -> MapPanel:
    """What the samples support, as a map: grey where not even the longest waves are."""
    values = np.where(np.isfinite(wavelengths), wavelengths, np.nan)
    scale = ColourScale("distance", WAVELENGTHS, "finest wavelength (mm)")
    return MapPanel(
        "supported", values, scale, "nothing supported" if np.isnan(values).any() else ""
    )


def need_figure(result: PlanResult) -> Figure:
    """Recommended points against the error they reach, planned and unplanned."""
    figure = Figure(figsize=(WIDTH, 3.8), layout="constrained")
    axes = figure.subplots()
    for how, colour in _COLOURS.items():
        found = {
            target: each.n_samples
            for (target, kind), each in sorted(result.by_target.items())
            if kind == how and each.n_samples is not None
        }
        label = "evenly spread, as planned" if how == "planned" else "wherever the catheter is"
        errors = [100 * target for target in found]
        axes.plot(errors, list(found.values()), "o-", color=colour, label=label)
    axes.axvline(100 * result.config.target_nrmse, color="#777777", lw=0.8)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.xaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_major_formatter("{x:,.0f}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_xticks([100 * target for target in sorted({key[0] for key in result.by_target})])
    axes.set_xlabel("error, nRMSE (% of the map's deviation); line: the target")
    axes.set_ylabel("points to take (number)")
    axes.grid(color="#e4e4e4", lw=0.5, which="both")
    axes.legend(frameon=False)
    return figure


def tail_figure(result: PlanResult) -> Figure:
    """Error that remains with rising numbers of harmonics: every map drawn, and the one used."""
    figure = Figure(figsize=(WIDTH, 3.8), layout="constrained")
    axes = figure.subplots()
    counts = np.arange(1, result.tails.n_modes + 1)
    for row in result.tails.squared_errors:
        axes.plot(counts, 100 * np.sqrt(row), color="#56b4e9", lw=0.6, alpha=0.6)
    used = 100 * np.sqrt(result.tails.at(result.config.quantile))
    share = f"{result.config.quantile:.0%}"
    label = f"{share} of maps lie below" if result.tails.n_maps > 1 else "the map"
    axes.plot(counts, used, color="#0072b2", lw=1.8, label=label)
    axes.axhline(100 * result.config.target_nrmse, color="#777777", lw=0.8, label="target")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_ylim(max(0.1, float(used[used > 0].min(initial=100.0)) / 2), 130)
    axes.xaxis.set_major_formatter("{x:,.0f}")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.set_xlabel("harmonics k (number)")
    axes.set_ylabel("error that remains, nRMSE (%)")
    axes.set_title(figure_text(result.wanted), fontsize="medium")
    axes.grid(color="#e4e4e4", lw=0.5)
    axes.legend(frameon=False)
    return figure
