"""Pictures of a segmented CT: slices in three planes, the surface, the histogram of the region."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from auricle.arrays import Floats
from auricle.report.maps import MapPanel, Marks, maps_picture
from auricle.study.segmented import SegmentedCase
from auricle.surface.mesh import Mesh

WIDTH = 7.0
"""Width of a figure, inches."""
SHARES = (0.25, 0.5, 0.75)
"""Where the slices lie between the ends of the atrium."""
FILL, OUTLINE = "#ff3b30", "#ffd60a"
_WINDOW = (-120.0, 550.0)
_ABOVE_BLOOD = 150.0
_BELOW_LOWEST, _BIN = -200.0, 10.0
_COLOURS = {"wall": "#777777", "lower": "#d55e00", "growing": "#cc79a7", "upper": "#0072b2"}
_WORDS = {
    "wall": "wall",
    "lower": "surface (half height)",
    "growing": "chambers told apart",
    "upper": "brighter: another structure",
}


@dataclass(frozen=True)
class Plane:
    """A way to cut, as radiologists hang it: patient's left or back to the right of the picture.

    Attributes
    ----------
    name
        Of the plane.
    axis, across, up
        Axes of LPS: the one cut across, the picture's horizontal and its vertical one.
    downwards
        Whether the vertical axis grows towards the bottom of the picture.
    """

    name: str
    axis: int
    across: int
    up: int
    downwards: bool = False


PLANES = (
    Plane("axial", 2, 0, 1, downwards=True),
    Plane("coronal", 1, 0, 2),
    Plane("sagittal", 0, 1, 2),
)


def overlay_picture(case: SegmentedCase) -> Figure:
    """The CT in three planes at three depths, the mask tinted, the surface's outline on it."""
    slices = case.slices
    extent = np.array(slices.shape) * slices.spacing
    ratios = [extent[plane.up] / extent[plane.across] for plane in PLANES]
    side = WIDTH / len(SHARES)
    figure = Figure(figsize=(WIDTH, side * sum(ratios) + 0.9), layout="constrained")
    grid = figure.subplots(len(PLANES), len(SHARES), squeeze=False, height_ratios=ratios)
    inside = np.argwhere(case.slices_mask.voxels)
    low, high = inside.min(axis=0), inside.max(axis=0)
    for row, plane in zip(grid, PLANES, strict=True):
        row[0].set_ylabel(plane.name)
        for axes, share in zip(row, SHARES, strict=True):
            index = round(float(low[plane.axis] + share * (high - low)[plane.axis]))
            _draw_slice(axes, case, plane, index)
    handles = [
        Patch(color=FILL, alpha=0.35, label="mask"),
        Line2D([], [], color=OUTLINE, label="surface"),
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=2, frameon=False)
    figure.supxlabel("mm, LPS: x to the patient's left, y to the back, z to the head", size=7)
    return figure


def _draw_slice(axes: Axes, case: SegmentedCase, plane: Plane, index: int) -> None:
    slices = case.slices
    low, high = _WINDOW
    if case.segmentation is not None:
        high = case.segmentation.thresholds.blood + _ABOVE_BLOOD
    step = slices.spacing
    start = slices.origin - step / 2
    stop = start + step * slices.shape
    bounds = (start[plane.across], stop[plane.across], start[plane.up], stop[plane.up])
    axes.imshow(
        _cut(slices.voxels, plane, index),
        cmap="gray",
        vmin=low,
        vmax=high,
        origin="lower",
        extent=bounds,
        interpolation="bilinear",
    )
    tint = _cut(case.slices_mask.voxels, plane, index)
    axes.imshow(
        np.ma.masked_equal(tint, False),
        cmap=ListedColormap([FILL]),
        alpha=0.3,
        origin="lower",
        extent=bounds,
        interpolation="nearest",
    )
    place = float(slices.origin[plane.axis] + index * step[plane.axis])
    lines = section(case.endocardium.mesh, axis=plane.axis, place=place)
    axes.add_collection(LineCollection(_flat(lines, plane), colors=OUTLINE, linewidths=0.7))
    if plane.downwards:
        axes.invert_yaxis()
    axes.set_title(f"{'xyz'[plane.axis]} = {place:.0f} mm", fontsize="small")
    axes.tick_params(labelsize=6)


def _cut(voxels: NDArray[np.generic], plane: Plane, index: int) -> NDArray[np.generic]:
    """One slice, rows along the picture's vertical axis."""
    taken: NDArray[np.generic] = np.take(voxels, index, axis=plane.axis)
    return taken.T if plane.across < plane.up else taken


def _flat(lines: Floats, plane: Plane) -> list[NDArray[np.float64]]:
    return list(lines[:, :, [plane.across, plane.up]])


def section(mesh: Mesh, *, axis: int, place: float) -> Floats:
    """Where a plane across an axis cuts a surface.

    Parameters
    ----------
    mesh
        The surface, mm.
    axis
        0, 1 or 2.
    place
        Coordinate of the plane on that axis, mm.

    Returns
    -------
    Floats
        Segments, one a face that is cut, shape (s, 2, 3), mm.

    Examples
    --------
    >>> from auricle.surface.shapes import icosphere
    >>> segments = section(icosphere(radius=10.0, subdivisions=4), axis=2, place=6.0)
    >>> bool(np.allclose(np.linalg.norm(segments[..., :2], axis=-1), 8.0, atol=0.05))
    True
    """
    corners = mesh.vertices[mesh.faces]
    height = corners[:, :, axis] - place
    above = height > 0
    cut = above.any(axis=1) & ~above.all(axis=1)
    corners, height, above = corners[cut], height[cut], above[cut]
    # the corner that is alone on its side, with the edges to the two others
    alone = np.where(above.sum(axis=1) == 1, above.argmax(axis=1), (~above).argmax(axis=1))
    row = np.arange(len(corners))
    ends = []
    for turn in (1, 2):
        other = (alone + turn) % 3
        share = height[row, alone] / (height[row, alone] - height[row, other])
        ends.append(
            corners[row, alone] + share[:, None] * (corners[row, other] - corners[row, alone])
        )
    segments: Floats = np.stack(ends, axis=1)
    return segments


def surface_picture(case: SegmentedCase) -> Figure:
    """The surface from four sides, the ostia of veins and appendage marked."""
    return maps_picture(case.endocardium.mesh, [MapPanel("endocardium")], marks=tuple(_ostia(case)))


def _ostia(case: SegmentedCase) -> Iterator[Marks]:
    """Places on the surface nearest to where the branches leave."""
    if case.segmentation is None:
        return
    colours = {"vein": "#0072b2", "appendage": "#009e73", "leak": "#d00000"}
    for kind, colour in colours.items():
        places = [each.ostium for each in case.segmentation.branches if each.kind == kind]
        if places:
            yield Marks(_KINDS[kind], _on_surface(case.endocardium.mesh, np.array(places)), colour)


_KINDS = {"vein": "veins", "appendage": "appendage", "leak": "cut: no vein"}


def _on_surface(mesh: Mesh, places: Floats) -> Floats:
    """The vertex nearest to each place, shape (n, 3), mm."""
    nearest: Floats = mesh.vertices[
        [int(np.argmin(np.linalg.norm(mesh.vertices - place, axis=1))) for place in places]
    ]
    return nearest


def histogram_figure(case: SegmentedCase) -> Figure:
    """How often each HU occurs where the atrium was looked for, and the thresholds read off it."""
    figure = Figure(figsize=(WIDTH, 3.4), layout="constrained")
    axes = figure.subplots()
    if case.segmentation is None:
        return figure
    found, thresholds = case.segmentation, case.segmentation.thresholds
    edges = np.arange(_BELOW_LOWEST, thresholds.upper + 3 * _ABOVE_BLOOD, _BIN)
    voxel_ml = found.image.voxel_volume / 1000
    for values, colour, label in (
        (found.image.voxels, "#9aa5b1", "the region looked at"),
        (found.image.voxels[found.mask.voxels], FILL, "the atrium"),
    ):
        counts, _ = np.histogram(values, edges)
        axes.stairs(counts * voxel_ml, edges, fill=True, alpha=0.6, color=colour, label=label)
    for name, colour in _COLOURS.items():
        value = getattr(thresholds, name)
        axes.axvline(value, color=colour, lw=1.2, label=f"{_WORDS[name]}: {value:.0f} HU")
    axes.set_yscale("log")
    axes.set_xlim(edges[0], edges[-1])
    axes.set_xlabel("CT number (HU)")
    axes.set_ylabel(f"volume per {_BIN:g} HU (ml)")
    axes.legend(frameon=False, fontsize="small")
    return figure
