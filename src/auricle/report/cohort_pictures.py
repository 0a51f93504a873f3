"""Pictures of a cohort's example: the paper's Figures 3 and 4, by the z-buffer."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure

from auricle.report.palettes import ColourScale
from auricle.report.pictures import DISTANCE_SCALE, FOCUS_SCALE, RESOLUTION, best_view
from auricle.report.rasterizer import Image, render
from auricle.report.views import STANDARD_VIEWS, Camera, View, cameras
from auricle.study.paper.surfaces import PicturedSurfaces
from auricle.surface.distance import point_to_surface
from auricle.surface.mesh import Mesh

WIDTH = 9.0
"""Width of a figure, inches."""
SIDE = 0.85
"""Height of a panel over its width."""
_NOTE = "axes of the file, taken as x to the patient's left, y to the back, z to the head"


def rebuilt_surfaces_picture(surfaces: PicturedSurfaces) -> Figure:
    """Figure 3: the atrium from 50, 250 and 500 harmonics (a, b, c), and points of Qslim (d, e, f).

    Colour is the distance to the original, drawn first.
    """
    rows = [("harmonics", surfaces.mha), ("points", surfaces.qslim)]
    n_columns = 1 + max(len(meshes) for _, meshes in rows)
    figure, grid = _panels(len(rows), n_columns)
    everything = np.vstack(
        [surfaces.original.vertices, *(m.vertices for _, meshes in rows for m in meshes.values())]
    )
    camera = _camera(everything, STANDARD_VIEWS["AP"], n_columns)
    _show(grid[0, 0], render(surfaces.original, camera))
    grid[0, 0].set_title(f"original, {surfaces.original.n_vertices:,} points", fontsize="small")
    back = _camera(everything, STANDARD_VIEWS["PA"], n_columns)
    _show(grid[1, 0], render(surfaces.original, back))
    grid[1, 0].set_title("original from the back", fontsize="small")
    letters = iter("abcdefgh")
    for row, (name, meshes) in zip(grid, rows, strict=True):
        for axes, (count, mesh) in zip(row[1:], sorted(meshes.items()), strict=False):
            distances = point_to_surface(mesh.vertices, surfaces.original)
            _show(axes, render(mesh, camera, distances, scale=DISTANCE_SCALE))
            middle = f"median {np.median(distances):.2g} mm"
            axes.set_title(f"({next(letters)}) {count} {name}\n{middle}", fontsize="small")
    _add_bar(figure, grid, DISTANCE_SCALE)
    figure.supxlabel(f"from the front, {_NOTE}", fontsize="x-small")
    return figure


def rebuilt_maps_picture(surfaces: PicturedSurfaces) -> Figure:
    """Figure 4: focal maps on the atrium recovered with 50, 250 and 500 harmonics.

    A row for each size; map and surface are from the same number of harmonics. Last: the map as
    it was, on the original surface.
    """
    return _maps_picture(
        surfaces,
        [
            [
                (f"{count} harmonics", mesh, each.rebuilt[count])
                for count, mesh in sorted(surfaces.mha.items())
            ]
            for each in surfaces.maps
        ],
    )


def thinned_maps_picture(surfaces: PicturedSurfaces) -> Figure:
    """As `rebuilt_maps_picture`, from points of Qslim with the map in the fourth component.

    Every map has a surface of its own; colours are linear between the points' values.
    """
    return _maps_picture(
        surfaces,
        [
            [
                (f"{count} points", level.mesh, level.values)
                for count, level in sorted(each.thinned.items())
            ]
            for each in surfaces.maps
        ],
    )


def _maps_picture(
    surfaces: PicturedSurfaces, approximations: list[list[tuple[str, Mesh, np.ndarray]]]
) -> Figure:
    """A row for each map: its approximations, titled, and the map itself; from one place."""
    n_columns = len(approximations[0]) + 1
    figure, grid = _panels(len(surfaces.maps), n_columns)
    view = best_view(surfaces.original, surfaces.maps[0].values)
    meshes = [mesh for row in approximations for _, mesh, _ in row]
    everything = np.vstack([mesh.vertices for mesh in (surfaces.original, *meshes)])
    camera = _camera(everything, view, n_columns)
    for row, each, shown in zip(grid, surfaces.maps, approximations, strict=True):
        row[0].set_ylabel(f"{each.size}, σ = {each.sigma_mm:g} mm")
        itself = ("as simulated", surfaces.original, each.values)
        for axes, (title, mesh, values) in zip(row, [*shown, itself], strict=True):
            _show(axes, render(mesh, camera, values, scale=FOCUS_SCALE))
            axes.set_title(title, fontsize="small")
    _add_bar(figure, grid, FOCUS_SCALE)
    figure.supxlabel(f"seen from {view.seen_from}; {_NOTE}", fontsize="x-small")
    return figure


def _camera(points: np.ndarray, view: View, n_columns: int) -> Camera:
    side = RESOLUTION * WIDTH / n_columns
    (camera,) = cameras(points, [view], width=round(side), height=round(SIDE * side))
    return camera


def _panels(n_rows: int, n_columns: int) -> tuple[Figure, np.ndarray]:
    height = n_rows * (SIDE * WIDTH / n_columns + 0.45) + 0.9
    figure = Figure(figsize=(WIDTH, height), layout="constrained")
    grid = figure.subplots(n_rows, n_columns, squeeze=False)
    for axes in grid.flat:
        axes.set_xticks([])
        axes.set_yticks([])
        axes.spines[:].set_visible(False)
    return figure, grid


def _show(axes: Axes, image: Image) -> None:
    axes.imshow(image, interpolation="antialiased")


def _add_bar(figure: Figure, panels: np.ndarray, scale: ColourScale) -> None:
    bar = figure.colorbar(
        ScalarMappable(scale.norm, scale.colormap),
        ax=panels,
        extend="max",
        location="bottom",
        spacing="uniform",
        label=scale.label,
        aspect=50,
    )
    bar.set_ticks(scale.boundaries)
    bar.minorticks_off()
