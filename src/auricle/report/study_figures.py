"""Figures of a study's maps: reconstruction beside the vendor's, and points against error."""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from auricle.arrays import PerVertex
from auricle.report.labels import figure_text, with_unit
from auricle.report.maps import MapPanel, Marks, maps_picture
from auricle.report.palettes import ColourScale, round_boundaries
from auricle.report.plan_figures import wavelength_panel
from auricle.report.wording import field_words
from auricle.study.map_study import FieldAnalysis

WIDTH = 7.0
GREY = "#9a9a9a"
MOST_DOTS = 200
"""Points up to which they are drawn on the map itself: more would hide it."""
_SHORT: Mapping[str, str] = MappingProxyType(
    {
        "local_activation_time": "activation",
        "bipolar_voltage": "bipolar",
        "unipolar_voltage": "unipolar",
    }
)
"""Words for colour bars, which are short."""
_VELOCITIES = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.5)
"""Boundaries of the colours of velocities, m/s; the same in every report."""


def field_picture(field: FieldAnalysis) -> Figure:
    """Reconstruction, the vendor's map, uncertainty and velocity; with the points if they are few.

    Where the points say nothing there is no map to show but the vendor's.
    """
    panels = [] if field.knows_nothing else [_own_panel(field)]
    if field.vendor_values is not None:
        panels.append(MapPanel("system's", field.vendor_values, _scale(field), "no value"))
    if not field.knows_nothing:
        panels.append(_deviation_panel(field))
    if field.velocity is not None:
        scale = ColourScale("perceptual", _VELOCITIES, "velocity (m/s)")
        panels.append(MapPanel("velocity", field.velocity.local, scale, "not mapped"))
    marks = _marks(field) if len(field.rebuilt.placed) <= MOST_DOTS else []
    surface = field.rebuilt.prepared.surface
    return maps_picture(surface, panels or [MapPanel("points")], marks=marks)


def support_picture(field: FieldAnalysis) -> Figure:
    """The finest wavelength that the points support, with the points."""
    panel = wavelength_panel(field.rebuilt.wavelengths)
    return maps_picture(field.rebuilt.prepared.surface, [panel], marks=_marks(field))


def redundancy_figure(field: FieldAnalysis) -> Figure:
    """Expected error against the number of points, as those missed least are left out."""
    figure = Figure(figsize=(WIDTH, 3.2), layout="constrained")
    axes = figure.subplots()
    less = field.redundancy
    if less is not None:
        errors = 100 * less.nrmse
        axes.plot(less.counts, errors, color="#0072b2", label="points missed least left out")
        axes.plot(less.counts[:1], errors[:1], "o", color="#0072b2", label="all points")
        kept = int(less.counts[0]) - less.n_redundant
        axes.axvline(kept, color=GREY, lw=0.8, ls="--", label=f"{kept:,}: error up by 5 %")
    target = 100 * field.rebuilt.config.target_nrmse
    axes.axhline(target, color="#777777", lw=0.8, label=f"target {target:g} %")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.xaxis.set_major_formatter("{x:,.0f}")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.yaxis.set_minor_formatter("{x:g}")
    axes.tick_params(axis="y", which="both", labelsize=7)
    axes.set_xlabel("points (number)")
    axes.set_ylabel("expected error, nRMSE (%)")
    axes.grid(color="#e4e4e4", lw=0.5, which="both")
    axes.legend(frameon=False)
    return figure


def _own_panel(field: FieldAnalysis) -> MapPanel:
    result = field.rebuilt
    hidden = result.singular | ~field.mapped
    words = "not mapped, or no direction" if result.singular.any() else "not mapped"
    return MapPanel("rebuilt", np.where(hidden, np.nan, result.mean), _scale(field), words)


def _deviation_panel(field: FieldAnalysis) -> MapPanel:
    result = field.rebuilt
    label = with_unit("standard deviation", figure_text(result.placed.unit))
    values = result.std[field.mapped]
    top = float(values.max()) if len(values) else 1.0
    edges = round_boundaries(np.linspace(0.0, top or 1.0, 100))
    scale = ColourScale("distance", tuple(edges.tolist()), label)
    return MapPanel("uncertainty", np.where(field.mapped, result.std, np.nan), scale, "not mapped")


def _scale(field: FieldAnalysis) -> ColourScale:
    """One scale for the reconstruction and the vendor's map."""
    result = field.rebuilt
    cyclic = result.config.cycle_length_ms is not None
    values = _shown(field)
    known = values[np.isfinite(values)]
    middle = float(np.median(known))
    if np.ptp(known) <= 1e-6 * abs(middle):
        known = middle + 0.1 * max(abs(middle), 1.0) * np.linspace(-1, 1, 11)
    edges = round_boundaries(known)
    short = _SHORT.get(field.name, field_words(field.name))
    label = with_unit(figure_text(short), figure_text(result.placed.unit))
    return ColourScale("cyclic" if cyclic else "perceptual", tuple(edges.tolist()), label)


def _shown(field: FieldAnalysis) -> PerVertex:
    """Values that set the scale: the samples' and, if that is all, the vendor's."""
    if field.knows_nothing and field.vendor_values is not None:
        return field.vendor_values
    return field.rebuilt.placed.values


def _marks(field: FieldAnalysis) -> list[Marks]:
    places = field.rebuilt.placed.sites.positions(field.rebuilt.prepared.chamber.mesh)
    less = field.redundancy
    redundant = np.zeros(len(places), dtype=bool)
    if less is not None:
        redundant[less.redundant] = True
    return [
        Marks("redundant points", places[redundant], colour=GREY),
        Marks("points", places[~redundant]),
    ]
