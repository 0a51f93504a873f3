"""Figures of a sampling plan: the points on the surface, the error against their number."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, LogLocator, NullFormatter

from auricle.report.labels import figure_text, unit_of, with_unit
from auricle.report.maps import MapPanel, Marks, maps_picture
from auricle.report.palettes import ColourScale, round_boundaries
from auricle.report.wording import field_words
from auricle.simulation.map_classes import MAP_CLASSES
from auricle.study.plan_result import PlanResult
from auricle.surface.field import FieldMap

WIDTH = 7.0
_COLOURS = {"planned": "#0072b2", "unplanned": "#d55e00"}
WAVELENGTHS = (5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 50.0, 70.0, 100.0)
"""Boundaries of the colours of wavelengths, mm; the same in every report."""


def plan_picture(result: PlanResult) -> Figure:
    """The planned points on the surface, over an example of the map and what they support."""
    panels = [] if result.example is None else [_example_panel(result, result.example)]
    panels.append(wavelength_panel(result.wavelengths))
    marks = []
    if len(result.positions):
        marks.append(Marks("planned points", result.positions))
    if len(result.existing):
        taken = result.existing.positions(result.prepared.chamber.mesh)
        marks.append(Marks("taken already", taken, colour="#d00000"))
    return maps_picture(result.prepared.surface, panels, marks=marks)


def _example_panel(result: PlanResult, example: FieldMap) -> MapPanel:
    """One such map: of a class as drawn, of times within a cycle in colours that close."""
    boundaries = tuple(float(edge) for edge in round_boundaries(example.values))
    name = "such a map" if result.config.map_class else figure_text(field_words(example.name))
    kind = MAP_CLASSES.get(result.config.map_class or "")
    cyclic = result.config.cycle_length_ms is not None or (kind is not None and kind.is_circular)
    palette = "cyclic" if cyclic else "perceptual"
    label = with_unit(name, unit_of(example))
    return MapPanel(
        "such a map", example.values, ColourScale(palette, boundaries, label), "unknown"
    )


def wavelength_panel(wavelengths: np.ndarray) -> MapPanel:
    """What the samples support, as a map: grey where not even the longest waves are."""
    values = np.where(np.isfinite(wavelengths), wavelengths, np.nan)
    scale = ColourScale("distance", WAVELENGTHS, "finest wavelength (mm)")
    return MapPanel("finest detail", values, scale, "no detail supported")


def need_figure(result: PlanResult) -> Figure:
    """Recommended points against the error they reach, planned and unplanned; one at least."""
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
    logarithmic(axes)
    axes.xaxis.set_major_locator(
        FixedLocator([100 * target for target in sorted({key[0] for key in result.by_target})])
    )
    axes.set_xlabel("error, nRMSE (% of the map's deviation); line: the target")
    axes.set_ylabel("points to take (number)")
    axes.legend(frameon=False)
    return figure


def logarithmic(axes: Axes) -> None:
    """Both axes logarithmic, with plain numbers at 1, 2 and 5 times the powers of ten."""
    axes.set_xscale("log")
    axes.set_yscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter("{x:,g}")
        axis.set_minor_formatter(NullFormatter())
    axes.grid(color="#e4e4e4", lw=0.5)


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
    logarithmic(axes)
    axes.set_ylim(max(0.1, float(used[used > 0].min(initial=100.0)) / 2), 130)
    axes.set_xlabel("harmonics k (number)")
    axes.set_ylabel("error that remains, nRMSE (%)")
    axes.legend(frameon=False)
    return figure
