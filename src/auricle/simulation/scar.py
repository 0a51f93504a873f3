"""Scars: patches of low voltage with an uneven boundary and a border of known width."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import robust_laplacian
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu
from scipy.special import expit

from auricle.arrays import Floats, PerVertex
from auricle.errors import InputError
from auricle.surface.fast_marching import FastMarching, VoronoiCells
from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh

_TEN_TO_NINETY = 2 * np.log(9.0)
"""Distance over which the logistic function climbs from 10 to 90 %."""
_LEAST_SLOPE = 0.2


@dataclass(frozen=True)
class ScarTissue:
    """What a scar is like.

    The defaults are middling clinical values: 0.5 mV is the usual threshold below which a bipolar
    voltage counts as scar, 1.5 mV and more as healthy. They are not those of any cohort.

    Attributes
    ----------
    radius
        Of a patch if its boundary were even, mm.
    border
        Width over which the voltage climbs from 10 to 90 % of the way, across the boundary, mm.
    roughness
        Standard deviation of the boundary's distance from even, mm.
    correlation
        Distance along the surface at which that deviation is hardly correlated (0.1), mm.
    scar_voltage, healthy_voltage
        Deep inside and far outside, mV.
    """

    radius: float = 12.0
    border: float = 4.0
    roughness: float = 3.0
    correlation: float = 15.0
    scar_voltage: float = 0.1
    healthy_voltage: float = 2.0

    def __post_init__(self) -> None:
        lengths = (self.radius, self.border, self.correlation)
        if not (min(lengths) > 0 and self.roughness >= 0):
            raise InputError(
                f"a scar of radius {self.radius}, border {self.border}, roughness "
                f"{self.roughness}, correlation {self.correlation} mm: give positive lengths"
            )


def scar_map(
    mesh: Mesh,
    *,
    centres: Sequence[int],
    rng: np.random.Generator,
    tissue: ScarTissue | None = None,
) -> FieldMap:
    """Voltage map with one patch of scar around each centre.

    The boundary is where the distance to the nearest centre, plus a random field, equals the
    radius; across it the voltage follows a logistic function of the distance from it (to first
    order: that sum over the length of its gradient).

    Parameters
    ----------
    mesh
        The surface.
    centres
        Vertex indices, at least one.
    rng
        Source of randomness.
    tissue
        Sizes and voltages; `ScarTissue()` by default.

    Returns
    -------
    FieldMap
        ``bipolar_voltage``, mV.

    Raises
    ------
    InputError
        If there is no centre or one is out of range.
    """
    if not len(centres):
        raise InputError("no centres: give at least one vertex")
    scar = tissue or ScarTissue()
    patches = VoronoiCells(FastMarching(mesh))
    for centre in centres:
        patches.add([centre])
    far = 4 * mesh.area**0.5
    level = np.minimum(patches.distances, far) - scar.radius
    if scar.roughness > 0:
        level += scar.roughness * random_field(mesh, correlation=scar.correlation, rng=rng)
    slope = np.maximum(_gradient_length(mesh, level), _LEAST_SLOPE)
    healthy = expit(_TEN_TO_NINETY * level / (slope * scar.border))
    voltage = scar.scar_voltage + (scar.healthy_voltage - scar.scar_voltage) * healthy
    return FieldMap(mesh, voltage, "bipolar_voltage", "mV")


def random_field(mesh: Mesh, *, correlation: float, rng: np.random.Generator) -> PerVertex:
    """A smooth Gaussian random field of mean 0 and variance 1 over the area, shape (n,).

    White noise through (κ² − Δ)⁻², which has a Matérn covariance of smoothness 3 whose range is
    `correlation` = √(8·3)/κ, where the correlation has fallen to about 0.1 (Lindgren, Rue and
    Lindström 2011, §2). The field is then shifted and scaled to its mean and variance.

    Raises
    ------
    InputError
        If the correlation length is not positive.
    """
    if not correlation > 0:
        raise InputError(f"a correlation length of {correlation} mm: give a positive one")
    centred = mesh.vertices - mesh.vertices.mean(axis=0)
    stiffness, mass = robust_laplacian.mesh_laplacian(centred, mesh.faces)
    areas = mass.diagonal()
    inverse_square = correlation**2 / 24.0
    factors = splu(
        csc_array(mass + inverse_square * stiffness),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    field = factors.solve(np.sqrt(areas) * rng.normal(size=mesh.n_vertices))
    field = factors.solve(areas * field)
    field -= areas @ field / areas.sum()
    scaled: PerVertex = field / np.sqrt(areas @ field**2 / areas.sum())
    return scaled


def _gradient_length(mesh: Mesh, values: PerVertex) -> PerVertex:
    """Length of the gradient at the vertices, from the area-weighted mean of their triangles'."""
    corners = mesh.vertices[mesh.faces]
    opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    turned = np.cross(mesh.face_normals[:, None, :], opposite)
    doubled = np.maximum(2 * mesh.face_areas, np.finfo(float).tiny)
    # Twice the area times the gradient: what the mean over the triangles of a vertex weighs.
    flows: Floats = (values[mesh.faces][:, :, None] * turned).sum(axis=1) / doubled[:, None]
    gradient = np.zeros((mesh.n_vertices, 3))
    doubled_area = np.zeros(mesh.n_vertices)
    for corner in range(3):
        np.add.at(gradient, mesh.faces[:, corner], flows)
        np.add.at(doubled_area, mesh.faces[:, corner], doubled)
    tiny = np.finfo(float).tiny
    length: PerVertex = np.linalg.norm(gradient, axis=1) / np.maximum(doubled_area, tiny)
    return length
