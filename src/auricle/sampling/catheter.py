"""Multi-electrode catheters: samples that come many at a time, in a prescribed pattern."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from auricle.arrays import Floats, Integers, Truths, read_only
from auricle.errors import InputError
from auricle.sampling.candidates import candidates
from auricle.sampling.chamber import Chamber
from auricle.sampling.farthest_point import farthest_point_sampling
from auricle.sampling.sites import Sites
from auricle.surface.mesh import Mesh

_INSIDE = -1e-9
"""Least barycentric weight of a point that counts as inside a triangle."""


@dataclass(frozen=True, eq=False)
class ElectrodePattern:
    """Where a catheter's electrodes lie when it is pressed flat.

    Attributes
    ----------
    name
        Of the pattern.
    offsets
        From the placement's centre, shape (e, 2), mm.
    """

    name: str
    offsets: Floats

    def __post_init__(self) -> None:
        object.__setattr__(self, "offsets", read_only(self.offsets, np.float64))
        shape = self.offsets.shape
        if len(shape) != 2 or shape[1] != 2 or not shape[0] or not np.isfinite(self.offsets).all():
            raise InputError(f"offsets of shape {shape}: give two finite numbers an electrode")

    @property
    def radius(self) -> float:
        """Distance of the farthest electrode from the centre, mm."""
        return float(np.linalg.norm(self.offsets, axis=1).max())


@dataclass(frozen=True, eq=False)
class Placements:
    """Sites of a catheter's electrodes, placement by placement.

    Attributes
    ----------
    sites
        Electrodes that lie on allowed surface, shape (m,).
    placement
        Index of the placement of each, shape (m,), ascending.
    electrode
        Index of each in the pattern, shape (m,).
    centres
        Vertex at the centre of each placement, shape (p,).
    n_off
        Number of electrodes left out since they fell on caps, forbidden surface or beyond reach.
    """

    sites: Sites
    placement: Integers
    electrode: Integers
    centres: Integers
    n_off: int


def grid_catheter(*, rows: int = 4, columns: int = 4, spacing: float = 4.0) -> ElectrodePattern:
    """Electrodes on a grid about the centre: 4 × 4 at 3 to 4 mm is a common one.

    >>> grid_catheter(rows=2, columns=1, spacing=3.0).offsets.tolist()
    [[0.0, -1.5], [0.0, 1.5]]
    """
    _require(min(rows, columns) >= 1 and spacing > 0, "rows, columns and spacing")
    x, y = np.meshgrid(np.arange(columns) - (columns - 1) / 2, np.arange(rows) - (rows - 1) / 2)
    return ElectrodePattern(
        f"grid {rows} × {columns}, {spacing:g} mm",
        spacing * np.column_stack([x.ravel(), y.ravel()]),
    )


def star_catheter(
    *, splines: int = 5, radii: Sequence[float] = (4.0, 8.0, 12.0, 16.0)
) -> ElectrodePattern:
    """Electrodes at the same radii (mm) along equally spaced splines: 20 poles by default.

    The outermost of the default lie 16 mm out, where `placed` starts to be approximate.
    """
    _require(splines >= 1 and len(radii) >= 1 and min(radii, default=0) > 0, "splines and radii")
    angles = 2 * np.pi * np.arange(splines) / splines
    spokes = np.column_stack([np.cos(angles), np.sin(angles)])
    offsets = (spokes[:, None] * np.asarray(radii)[:, None]).reshape(-1, 2)
    return ElectrodePattern(f"star of {splines} × {len(radii)}", offsets)


def circular_catheter(*, electrodes: int = 20, diameter: float = 20.0) -> ElectrodePattern:
    """Electrodes equally spaced around a loop: 10 or 20, 15 to 20 mm across."""
    _require(electrodes >= 1 and diameter > 0, "electrodes and diameter")
    angles = 2 * np.pi * np.arange(electrodes) / electrodes
    offsets = diameter / 2 * np.column_stack([np.cos(angles), np.sin(angles)])
    return ElectrodePattern(f"loop of {electrodes}, {diameter:g} mm", offsets)


def linear_catheter(*, gaps: Sequence[float] = (2.0, 5.0, 2.0)) -> ElectrodePattern:
    """Electrodes in a row with these gaps (mm) between them, about their middle.

    >>> linear_catheter(gaps=(2.0, 2.0)).offsets[:, 0].tolist()
    [-2.0, 0.0, 2.0]
    """
    _require(min(gaps, default=1.0) > 0, "gaps")
    along = np.concatenate([[0.0], np.cumsum(gaps)])
    along = along - along[-1] / 2
    return ElectrodePattern(f"row of {len(along)}", np.column_stack([along, np.zeros(len(along))]))


def placed(
    chamber: Chamber,
    pattern: ElectrodePattern,
    centres: ArrayLike,
    *,
    angles: ArrayLike = 0.0,
    allowed: Truths | None = None,
) -> Placements:
    """Lay a catheter on the surface around each of some centres.

    An electrode goes to its distance from the centre along the surface, in the direction that its
    offset has in the tangent plane there: geodesic polar coordinates, their angle by projection.
    On a sphere that is exact but for the mesh; elsewhere the angle drifts with distance, so take
    it for patterns of up to about 15 mm, and wherever the wall bends less than that.

    Parameters
    ----------
    chamber
        Where to lay it.
    pattern
        The electrodes.
    centres
        Vertices under the pattern's origin, shape (p,).
    angles
        Turn of each placement about its centre, radians, shape (p,) or one for all.
    allowed
        Where electrodes may lie, shape (n,): the vertex nearest to each counts.

    Raises
    ------
    InputError
        If a centre is out of range or `allowed` is not one truth a vertex.
    """
    vertices = np.asarray(centres, dtype=np.int64).reshape(-1)
    turns = np.broadcast_to(np.asarray(angles, dtype=np.float64), vertices.shape)
    usable = candidates(chamber, 1, allowed=allowed)
    normals = _vertex_normals(chamber.mesh)
    found, placement, electrode = [], [], []
    for i, (vertex, turn) in enumerate(zip(vertices.tolist(), turns.tolist(), strict=True)):
        offsets = pattern.offsets @ _rotation(turn).T
        distances = chamber.marching.from_source([vertex], reach=2 * pattern.radius + 1.0)
        chart = _polar_chart(chamber.mesh, vertex, normals[vertex], distances)
        sites, inside = _located(chamber.mesh, chart, offsets)
        found.append(sites)
        placement.append(np.full(len(sites), i))
        electrode.append(np.flatnonzero(inside))
    every = _joined(found)
    on_surface = usable[every.nearest_vertices]
    return Placements(
        sites=every[on_surface],
        placement=_concatenated(placement)[on_surface],
        electrode=_concatenated(electrode)[on_surface],
        centres=vertices,
        n_off=len(vertices) * len(pattern.offsets) - int(on_surface.sum()),
    )


def planned_placements(
    chamber: Chamber,
    pattern: ElectrodePattern,
    count: int,
    *,
    allowed: Truths | None = None,
    existing: Sites | None = None,
    rng: np.random.Generator | None = None,
) -> Placements:
    """Placements whose centres are farthest points; nested.

    Parameters
    ----------
    chamber
        Where to sample.
    pattern
        The catheter's electrodes.
    count
        How many placements.
    allowed
        Where centres and electrodes may lie, shape (n,); only accessible vertices ever do.
    existing
        Points taken already, which new centres keep away from.
    rng
        Turns each placement at random; without it none is turned.

    Raises
    ------
    InputError
        If fewer than `count` vertices are allowed.
    """
    centres = farthest_point_sampling(chamber, count, allowed=allowed, existing=existing)
    angles = np.zeros(count) if rng is None else rng.uniform(0, 2 * np.pi, count)
    return placed(chamber, pattern, centres, angles=angles, allowed=allowed)


def _require(holds: bool, what: str) -> None:
    if not holds:
        raise InputError(f"{what} of a catheter: give positive numbers, at least one of each")


def _rotation(turn: float) -> Floats:
    return np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])


def _vertex_normals(mesh: Mesh) -> Floats:
    normals = np.zeros_like(mesh.vertices)
    for corner in range(3):
        np.add.at(normals, mesh.faces[:, corner], mesh.face_normals)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    unit: Floats = normals / np.maximum(lengths, np.finfo(float).tiny)
    return unit


def _polar_chart(mesh: Mesh, centre: int, normal: Floats, distances: Floats) -> Floats:
    """Polar coordinates about a vertex as plane ones, shape (n, 2), mm; NaN beyond reach."""
    axis = np.eye(3)[np.abs(normal).argmin()]
    first = np.cross(axis, normal)
    first = first / np.linalg.norm(first)
    offsets = mesh.vertices - mesh.vertices[centre]
    flat = offsets @ np.column_stack([first, np.cross(normal, first)])
    lengths = np.linalg.norm(flat, axis=1)
    scale = np.where(np.isfinite(distances), distances, np.nan)
    chart: Floats = flat * (scale / np.maximum(lengths, np.finfo(float).tiny))[:, None]
    return chart


def _located(mesh: Mesh, chart: Floats, offsets: Floats) -> tuple[Sites, Truths]:
    """Sites at chart coordinates, and which of the offsets lie on the charted surface.

    Where the chart folds over and several triangles hold a point, the first counts.
    """
    faces = mesh.faces[np.isfinite(chart[mesh.faces]).all(axis=(1, 2))]
    a, b, c = (chart[faces[:, corner]] for corner in range(3))
    twice_area = _cross(b - a, c - a)
    upright = twice_area > 0
    faces, a, b, c = faces[upright], a[upright], b[upright], c[upright]
    corners = np.zeros((len(offsets), 3), dtype=np.int64)
    weights = np.zeros((len(offsets), 3))
    inside = np.zeros(len(offsets), dtype=np.bool_)
    for i, point in enumerate(offsets):
        shares = (
            np.stack(
                [
                    _cross(b - point, c - point),
                    _cross(c - point, a - point),
                    _cross(a - point, b - point),
                ]
            )
            / twice_area[upright]
        )
        held = shares.min(axis=0) >= _INSIDE
        inside[i] = held.any()
        if inside[i]:
            face = int(held.argmax())
            corners[i] = faces[face]
            weights[i] = np.maximum(shares[:, face], 0.0) / np.maximum(shares[:, face], 0.0).sum()
    return Sites(corners[inside], weights[inside]), inside


def _cross(u: Floats, v: Floats) -> Floats:
    crossed: Floats = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    return crossed


def _joined(parts: Sequence[Sites]) -> Sites:
    return Sites(
        _concatenated([sites.corners.ravel() for sites in parts]),
        np.concatenate([np.empty(0), *(sites.weights.ravel() for sites in parts)]),
    )


def _concatenated(parts: Sequence[Integers]) -> Integers:
    return np.concatenate([np.empty(0, np.int64), *parts])
