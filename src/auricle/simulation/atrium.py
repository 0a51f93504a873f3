"""A generated left atrium: the smooth union of a body, four veins and an appendage, as a mesh."""

import numpy as np
from scipy.special import eval_legendre

from auricle.arrays import Floats, Points
from auricle.errors import InputError, SurfaceError
from auricle.simulation.anatomy import AtriumShape, Tube, vector
from auricle.simulation.implicit import (
    Coordinates,
    ellipsoid_distance,
    half_space_distance,
    smooth_maximum,
    smooth_minimum,
    sphere_distance,
    swept_distance,
)
from auricle.surface.extraction import extract_surface
from auricle.surface.mesh import Mesh
from auricle.surface.topology import euler_number, pieces

__all__ = ["AtriumShape", "atrium"]

_MARGIN = 10.0
"""mm around a part beyond which it cannot touch the surface: more than any blend's reach."""
_SWEEP_STEP = 0.7
"""mm between the spheres that make a tube: the scallops between them stay below 0.02 mm."""
_ANNULUS_BLEND, _AORTA_BLEND, VEIN_BLEND, LOBE_BLEND, _CUT_BLEND = 6.0, 10.0, 9.0, 4.0, 2.5
AORTA_RADIUS = 14.0


def atrium(shape: AtriumShape, *, spacing: float = 0.8) -> Mesh:
    """Surface of a generated left atrium: closed, one piece, without handles.

    Parameters
    ----------
    shape
        The anatomy, in the axes and about the origin that `auricle.simulation.anatomy` states.
    spacing
        Edge of the grid the surface is extracted on, mm; the mesh has about
        1.5·area/spacing² vertices.

    Returns
    -------
    Mesh
        Outward, mm; the same to the last bit for the same shape and spacing.

    Raises
    ------
    InputError
        If the spacing is not between 0.3 and 3 mm.
    SurfaceError
        If the parts do not make one piece without handles (veins grown together, say).

    Examples
    --------
    >>> mesh = atrium(AtriumShape.random(np.random.default_rng(1)), spacing=2.0)
    >>> euler_number(mesh.faces)
    2
    """
    if not 0.3 <= spacing <= 3.0:
        raise InputError(f"a spacing of {spacing} mm: give 0.3 to 3 mm")
    axes = _axes(shape, spacing)
    mesh = extract_surface(
        -_distance(shape, axes),
        level=0.0,
        spacing=(spacing, spacing, spacing),
        origin=vector([axis[0] for axis in axes]),
    )
    if pieces(mesh.faces).any() or euler_number(mesh.faces) != 2:
        raise SurfaceError(
            "the parts of this atrium do not make one piece without handles: change its shape"
        )
    return mesh


def _axes(shape: AtriumShape, spacing: float) -> Coordinates:
    """Grid lines along x, y and z with room for every part, mm."""
    semi_axes = np.asarray(shape.semi_axes)
    boxes = [_box(tube) for tube in (*shape.veins, shape.appendage, *shape.lobes)]
    low = np.min([-semi_axes, *(low for low, _ in boxes)], axis=0) - _MARGIN
    high = np.max([semi_axes, *(high for _, high in boxes)], axis=0) + _MARGIN
    x, y, z = (np.arange(start, stop, spacing) for start, stop in zip(low, high, strict=True))
    return x, y, z


def _distance(shape: AtriumShape, axes: Coordinates) -> Floats:
    """Distance to the atrium at the grid's nodes, mm, negative inside; exact in no place."""
    distance = body_distance(shape, _grid(axes))
    for vein in shape.veins:
        _unite(distance, axes, vein, blend=VEIN_BLEND, is_cut=True)
    for lobe in (shape.appendage, *shape.lobes):
        _unite(distance, axes, lobe, blend=LOBE_BLEND, is_cut=False)
    return distance


def body_distance(shape: AtriumShape, at: Coordinates) -> Floats:
    """Bumpy ellipsoid, flattened at the mitral annulus and dented by the root of the aorta."""
    semi_axes = np.asarray(shape.semi_axes)
    body = ellipsoid_distance(at, semi_axes)
    x, y, z = (coordinate / axis for coordinate, axis in zip(at, semi_axes, strict=True))
    radius = np.maximum(np.sqrt(x**2 + y**2 + z**2), 0.1)
    for bump in shape.bumps:
        cosine = (bump.axis[0] * x + bump.axis[1] * y + bump.axis[2] * z) / radius
        body -= bump.height * eval_legendre(bump.degree, cosine)
    normal = np.asarray(shape.annulus_normal)
    annulus = half_space_distance(at, shape.annulus_depth * normal, normal)
    body = smooth_maximum(body, annulus, blend=_ANNULUS_BLEND)
    aorta = semi_axes * (-0.15, -0.9, 0.35) - (0.0, AORTA_RADIUS, 0.0)
    return smooth_maximum(body, -sphere_distance(at, aorta, AORTA_RADIUS), blend=_AORTA_BLEND)


def _unite(distance: Floats, axes: Coordinates, tube: Tube, *, blend: float, is_cut: bool) -> None:
    """Blend a tube into `distance`, in place, in the part of the grid it can reach."""
    low, high = _box(tube)
    i, j, k = (
        slice(*np.searchsorted(axis, (start - _MARGIN, stop + _MARGIN)))
        for axis, start, stop in zip(axes, low, high, strict=True)
    )
    near = _tube_distance(_grid((axes[0][i], axes[1][j], axes[2][k])), tube, is_cut=is_cut)
    distance[i, j, k] = smooth_minimum(distance[i, j, k], near, blend=blend)


def _tube_distance(at: Coordinates, tube: Tube, *, is_cut: bool) -> Floats:
    fractions = tube_fractions(tube)
    swept = swept_distance(at, tube.centre_line(fractions), tube.radius(fractions))
    if not is_cut:
        return swept
    before, tip = tube.centre_line(np.array([0.99, 1.0]))
    normal = (tip - before) / np.linalg.norm(tip - before)
    return smooth_maximum(swept, half_space_distance(at, tip, normal), blend=_CUT_BLEND)


def tube_fractions(tube: Tube) -> Floats:
    """Where the spheres of a tube sit: from half a radius upstream of the ostium to the tip."""
    upstream = -0.5 * tube.radii[0] / tube.length
    bent = tube.length + float(np.linalg.norm(tube.bend))
    return np.linspace(upstream, 1.0, int(np.ceil((1.0 - upstream) * bent / _SWEEP_STEP)))


def _box(tube: Tube) -> tuple[Points, Points]:
    """Lowest and highest coordinates of a tube, mm."""
    line, radius = tube.centre_line(tube_fractions(tube)), max(tube.radii)
    return line.min(axis=0) - radius, line.max(axis=0) + radius


def _grid(axes: Coordinates) -> Coordinates:
    x, y, z = axes
    return x[:, None, None], y[None, :, None], z[None, None, :]
