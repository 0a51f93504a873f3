"""Pictures: the surface and the maps on it, seen from named directions, with colour bars."""

from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import NDArray

from auricle.arrays import Floats, PerVertex
from auricle.report.labels import signal_label
from auricle.report.palettes import UNKNOWN, ColourScale, scale_for_field
from auricle.report.rasterizer import Image, Raster, coarser, finer, paint, rasterize, render
from auricle.report.views import STANDARD_VIEWS, View, cameras
from auricle.study.result import CaseResult, Signal
from auricle.surface.distance import point_to_surface
from auricle.surface.mesh import Mesh

WIDTH = 7.0
"""Width of a figure, inches."""

RESOLUTION = 150
"""Pixels in an inch of a figure."""

SUPERSAMPLING = 2

FRONT_AND_BACK = (STANDARD_VIEWS["AP"], STANDARD_VIEWS["PA"])

DISTANCE_SCALE = ColourScale(
    "distance", (0.0, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0), "distance to the original (mm)"
)
"""The same in every report, so that surfaces can be compared."""

FOCUS_SCALE = ColourScale(
    "perceptual",
    tuple(float(step) for step in np.linspace(0, 1, 11).round(1)),
    "simulated map (no unit; 1 at the centre of a lone focus)",
)

LARGEST_PANEL = 2.5
"""Side of a panel, inches, when a figure has few."""

_AXES_NOTE = (
    "views by the axes of the file, taken as x to the patient's left, y to the back, z to the head"
)


def reconstruction_picture(result: CaseResult) -> Figure:
    """The surface and what few harmonics make of it, the paper's Figure 3 a–c, front and back.

    Colour is the distance from the rebuilt to the original surface.
    """
    rebuilt = {
        count: Mesh(positions, result.surface.faces)
        for count, positions in sorted(result.reconstructions.items())
    }
    everything = np.vstack([result.surface.vertices, *(mesh.vertices for mesh in rebuilt.values())])
    n_columns = 1 + len(rebuilt)
    figure, grid = _panels(2, n_columns)
    size = _pixels(n_columns)
    for row, camera in zip(grid, cameras(everything, FRONT_AND_BACK, **size), strict=True):
        _show(row[0], render(result.surface, camera))
        row[0].set_ylabel(camera.view.name)
    grid[0, 0].set_title("original")
    errors = {error.n_modes: error.gd_mean_mm for error in result.geometry_errors}
    for column, (count, mesh) in enumerate(rebuilt.items(), start=1):
        distances = point_to_surface(mesh.vertices, result.surface)
        for row, camera in zip(grid, cameras(everything, FRONT_AND_BACK, **size), strict=True):
            _show(row[column], render(mesh, camera, distances, scale=DISTANCE_SCALE))
        grid[0, column].set_title(f"{count} harmonics")
        if count in errors:
            grid[1, column].set_xlabel(f"mean distance {errors[count]:.2g} mm")
    if rebuilt:
        _add_bar(figure, grid, DISTANCE_SCALE, extend="max")
    figure.supxlabel(_AXES_NOTE, fontsize="x-small")
    return figure


def fields_picture(result: CaseResult, *, style: str = "perceptual") -> Figure:
    """Each map that came with the surface, front and back; places without a value are grey.

    Parameters
    ----------
    result
        The case, with at least one field.
    style
        One of `auricle.report.palettes.STYLES`.
    """
    figure, grid = _panels(len(result.fields), 2)
    surface = result.surface
    views = cameras(surface.vertices, FRONT_AND_BACK, **_pixels(2))
    rasters = [rasterize(surface, finer(camera, SUPERSAMPLING)) for camera in views]
    for row, signal in zip(grid, result.fields, strict=True):
        scale = scale_for_field(signal.field, signal_label(signal), style=style)
        for axes, raster in zip(row, rasters, strict=True):
            _show(axes, _painted(raster, surface, signal, scale))
            axes.set_title(raster.camera.view.name)
        _add_bar(figure, row, scale, extend=_extension(signal.field.values, scale), side="right")
    if any(not signal.field.sampled.all() for signal in result.fields):
        patch = Patch(color="#{:02x}{:02x}{:02x}".format(*UNKNOWN), label="not sampled")
        figure.legend(handles=[patch], loc="outside upper right", frameon=False)
    figure.supxlabel(_AXES_NOTE, fontsize="x-small")
    return figure


def foci_picture(result: CaseResult) -> Figure:
    """Simulated maps, a row for every number of foci, a column for every width.

    Each row is seen from the direction that shows most of its foci.
    """
    counts = sorted({signal.details["n_foci"] for signal in result.simulated})
    widths = sorted({signal.details["width_mm"] for signal in result.simulated})
    figure, grid = _panels(len(counts), len(widths))
    raster_from = partial(_raster_from, result.surface, _pixels(len(widths)))
    rasters: dict[str, Raster] = {}
    for row, count in zip(grid, counts, strict=True):
        signals = [signal for signal in result.simulated if signal.details["n_foci"] == count]
        narrowest = min(signals, key=lambda signal: signal.details["width_mm"])
        view = best_view(result.surface, narrowest.field.values)
        if view.name not in rasters:
            rasters[view.name] = raster_from(view)
        for signal in signals:
            axes = row[widths.index(signal.details["width_mm"])]
            _show(axes, _painted(rasters[view.name], result.surface, signal, FOCUS_SCALE))
            axes.set_title(f"{signal_label(signal)} ({view.name})", fontsize="small")
    _add_bar(figure, grid, FOCUS_SCALE, extend="max")
    figure.supxlabel(_AXES_NOTE, fontsize="x-small")
    return figure


def best_view(surface: Mesh, values: PerVertex) -> View:
    """Of the standard views, the one in which most of a positive map is seen.

    Each view counts the sum of the map over its pixels; the first of equal ones wins.
    """
    views = tuple(STANDARD_VIEWS.values())
    sums = []
    for camera in cameras(surface.vertices, views, width=80, height=80):
        raster = rasterize(surface, camera)
        seen = raster.outside & (raster.faces >= 0)
        corners = surface.faces[raster.faces[seen]]
        sums.append(float((values[corners] * raster.weights[seen]).sum()))
    return views[int(np.argmax(sums))]


def _raster_from(surface: Mesh, size: dict[str, int], view: View) -> Raster:
    (camera,) = cameras(surface.vertices, [view], **size)
    return rasterize(surface, finer(camera, SUPERSAMPLING))


def _painted(raster: Raster, surface: Mesh, signal: Signal, scale: ColourScale) -> Image:
    return coarser(paint(raster, surface, signal.field.values, scale=scale), SUPERSAMPLING)


def _panels(n_rows: int, n_columns: int) -> tuple[Figure, NDArray[Any]]:
    """A figure of square panels without axes, with room for titles and a colour bar below."""
    height = n_rows * (_side(n_columns) + 0.3) + 1.0
    figure = Figure(figsize=(WIDTH, height), layout="constrained")
    grid = figure.subplots(n_rows, n_columns, squeeze=False)
    for axes in grid.flat:
        axes.set_xticks([])
        axes.set_yticks([])
        axes.spines[:].set_visible(False)
    return figure, grid


def _side(n_columns: int) -> float:
    """Side of a panel, inches."""
    return min(WIDTH / n_columns, LARGEST_PANEL)


def _pixels(n_columns: int) -> dict[str, int]:
    """Size of a panel's picture, pixels."""
    side = round(RESOLUTION * _side(n_columns))
    return {"width": side, "height": side}


def _show(axes: Axes, image: Image) -> None:
    axes.imshow(image, interpolation="antialiased")


def _extension(values: Floats, scale: ColourScale) -> str:
    """Which ends of the colour bar must point on, since values lie beyond them."""
    known = values[np.isfinite(values)]
    below = known.min() < scale.boundaries[0]
    above = known.max() > scale.boundaries[-1]
    return {(False, False): "neither", (True, False): "min", (False, True): "max"}.get(
        (bool(below), bool(above)), "both"
    )


def _add_bar(
    figure: Figure,
    panels: NDArray[Any],
    scale: ColourScale,
    *,
    extend: str,
    side: str = "bottom",
) -> None:
    bar = figure.colorbar(
        ScalarMappable(scale.norm, scale.colormap),
        ax=panels,
        extend=extend,
        location=side,
        spacing="uniform",
        # Beside a panel there is no room for one line.
        label="\n(".join(scale.label.rsplit(" (", 1)) if side == "right" else scale.label,
    )
    bar.set_ticks(scale.boundaries)
    bar.minorticks_off()
