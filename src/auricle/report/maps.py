"""Maps: values on the surface beside one another, with the places of samples drawn on them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from auricle.arrays import PerVertex, Points, Truths
from auricle.report.palettes import UNKNOWN, ColourScale
from auricle.report.rasterizer import Raster, coarser, finer, paint, rasterize
from auricle.report.views import STANDARD_VIEWS, View, cameras
from auricle.surface.mesh import Mesh

WIDTH = 7.0
"""Width of a figure, inches."""

RESOLUTION = 150
"""Pixels in an inch of a figure."""

FOUR_SIDES = tuple(STANDARD_VIEWS[name] for name in ("AP", "PA", "LL", "RL"))

_SUPERSAMPLING = 2
_DEPTH_MM = 1.5
"""How far behind the surface seen a mark may lie and still count as on it."""

_AXES_NOTE = (
    "views by the axes of the file, taken as x to the patient's left, y to the back, z to the head"
)


@dataclass(frozen=True, eq=False)
class MapPanel:
    """One map and how it is coloured.

    Attributes
    ----------
    title
        What it is.
    values
        One number a vertex, shape (n,); NaN is grey. None draws the bare surface.
    scale
        Colours of the values.
    unknown
        What grey stands for on it.
    """

    title: str
    values: PerVertex | None = None
    scale: ColourScale | None = None
    unknown: str = ""


@dataclass(frozen=True, eq=False)
class Marks:
    """Places drawn as dots on every panel.

    Attributes
    ----------
    label
        What they are, for the legend.
    positions
        Shape (m, 3), mm; those on the far side are not shown.
    colour
        Of the dots.
    numbered
        Whether each carries its number in the order given, from 1.
    """

    label: str
    positions: Points
    colour: str = "black"
    numbered: bool = False


def maps_picture(
    mesh: Mesh,
    panels: Sequence[MapPanel],
    *,
    marks: Sequence[Marks] = (),
    views: Sequence[View] = FOUR_SIDES,
) -> Figure:
    """Every map from every view: a row a map, a column a view, a colour bar at its end.

    Parameters
    ----------
    mesh
        The surface drawn.
    panels
        What is drawn on it, at least one.
    marks
        Places shown on all of them.
    views
        Directions to look from.
    """
    side = WIDTH / (len(views) + 0.6)
    tall = _height_over_width(mesh, views)
    height = len(panels) * (side * tall + 0.15) + 1.0
    figure = Figure(figsize=(WIDTH, height), layout="constrained")
    grid = figure.subplots(len(panels), len(views), squeeze=False)
    width = round(RESOLUTION * side)
    rasters = [
        rasterize(mesh, finer(camera, _SUPERSAMPLING))
        for camera in cameras(mesh.vertices, views, width=width, height=round(width * tall))
    ]
    for row, panel in zip(grid, panels, strict=True):
        for axes, raster in zip(row, rasters, strict=True):
            _draw(axes, raster, mesh, panel, marks)
        row[0].set_ylabel(panel.title)
        if panel.scale is not None:
            _add_bar(figure, row, panel)
    for axes, view in zip(grid[0], views, strict=True):
        axes.set_title(view.name)
    handles = [*_mark_entries(marks), *_grey_entries(panels)]
    if handles:
        figure.legend(handles=handles, loc="outside upper center", ncols=3, frameon=False)
    figure.supxlabel(_AXES_NOTE, fontsize="x-small")
    return figure


def _height_over_width(mesh: Mesh, views: Sequence[View]) -> float:
    """Shape of a tile that fits the surface from every view."""
    axes = np.array([(view.right, view.up) for view in views])
    wide, high = np.ptp(np.einsum("vac,nc->van", axes, mesh.vertices), axis=2).max(axis=0)
    return float(np.clip(high / wide, 0.4, 2.0))


def visible(raster: Raster, mesh: Mesh, positions: Points) -> Truths:
    """Which places on the surface are seen, and not hidden behind another part of it."""
    placed = raster.camera.project(positions)
    columns, rows = np.floor(placed[:, 0]).astype(int), np.floor(placed[:, 1]).astype(int)
    height, width = raster.faces.shape
    inside = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
    faces = np.full(len(positions), -1)
    faces[inside] = raster.faces[rows[inside], columns[inside]]
    seen = faces >= 0
    depth = np.full(len(positions), np.inf)
    corners = raster.camera.project(mesh.vertices)[:, 2][mesh.faces[faces[seen]]]
    weights = raster.weights[rows[seen], columns[seen]]
    depth[seen] = (corners * weights).sum(axis=1)
    shown: Truths = seen & (placed[:, 2] > depth - _DEPTH_MM)
    return shown


def _draw(axes: Axes, raster: Raster, mesh: Mesh, panel: MapPanel, marks: Sequence[Marks]) -> None:
    image = coarser(paint(raster, mesh, panel.values, scale=panel.scale), _SUPERSAMPLING)
    axes.imshow(image, interpolation="antialiased")
    axes.set_xticks([])
    axes.set_yticks([])
    axes.spines[:].set_visible(False)
    for group in marks:
        shown = np.flatnonzero(visible(raster, mesh, group.positions))
        places = raster.camera.project(group.positions[shown]) / _SUPERSAMPLING - 0.5
        axes.scatter(
            places[:, 0], places[:, 1], s=_dot_size(group), c=group.colour, lw=0.4, ec="white"
        )
        if group.numbered:
            for index, (x, y, _) in zip(shown.tolist(), places, strict=True):
                axes.annotate(
                    str(index + 1), (x, y), xytext=(3, 2), textcoords="offset points", size=6
                )


def _dot_size(group: Marks) -> float:
    """Area of a dot, square points: many dots are drawn smaller."""
    return float(np.clip(1500 / max(len(group.positions), 1), 4, 16))


def _add_bar(figure: Figure, row: Sequence[Axes], panel: MapPanel) -> None:
    scale, values = panel.scale, panel.values
    if scale is None or values is None:
        return
    known = values[np.isfinite(values)]
    below = bool(len(known)) and bool(known.min() < scale.boundaries[0])
    above = bool(len(known)) and bool(known.max() > scale.boundaries[-1])
    extend = {(True, False): "min", (False, True): "max", (True, True): "both"}
    bar = figure.colorbar(
        ScalarMappable(scale.norm, scale.colormap),
        ax=row,
        extend=extend.get((below, above), "neither"),
        spacing="uniform",
        label="\n(".join(scale.label.rsplit(" (", 1)),
    )
    bar.set_ticks(scale.boundaries)
    bar.minorticks_off()


def _mark_entries(marks: Sequence[Marks]) -> list[Line2D]:
    return [
        Line2D(
            [], [], ls="none", marker="o", ms=4, mec="white", color=group.colour, label=group.label
        )
        for group in marks
        if len(group.positions)
    ]


def _grey_entries(panels: Sequence[MapPanel]) -> list[Patch]:
    colour = "#{:02x}{:02x}{:02x}".format(*UNKNOWN)
    words = dict.fromkeys(
        panel.unknown
        for panel in panels
        if panel.unknown and panel.values is not None and np.isnan(panel.values).any()
    )
    return [Patch(color=colour, label=each) for each in words]
