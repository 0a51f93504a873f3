"""The chamber: a surface closed for the sake of its harmonics, and the part one can sample."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from auricle.arrays import Floats, PerVertex, Truths, read_only
from auricle.errors import InputError, SurfaceError
from auricle.progress import Progress, silent
from auricle.spectral.harmonics import Harmonics, manifold_harmonics
from auricle.surface.capping import cap_holes
from auricle.surface.fast_marching import FastMarching
from auricle.surface.geodesics import GeodesicDistances
from auricle.surface.mesh import Mesh


@dataclass(frozen=True, eq=False)
class Chamber:
    """What samples are planned and maps are reconstructed on.

    Attributes
    ----------
    mesh
        Closed: holes (cut veins, the mitral ring) are capped, so that the harmonics can carry a
        map's slope across a rim. Vertices of the real surface come first.
    basis
        Its harmonics.
    accessible
        Which vertices lie on the real surface, rims included, shape (n,): errors, areas and
        designs are of these only.
    """

    mesh: Mesh
    basis: Harmonics
    accessible: Truths

    def __post_init__(self) -> None:
        object.__setattr__(self, "accessible", read_only(self.accessible, np.bool_))
        if self.accessible.shape != (self.mesh.n_vertices,):
            raise InputError("`accessible` must be one truth a vertex of the chamber")
        if not self.accessible.any():
            raise SurfaceError("no vertex is accessible: allow some part of the surface")

    @cached_property
    def accessible_areas(self) -> PerVertex:
        """Vertex areas, 0 where not accessible, shape (n,), mm²."""
        areas: PerVertex = np.where(self.accessible, self.basis.areas, 0.0)
        return areas

    @property
    def accessible_area(self) -> float:
        """Area one can sample, mm²."""
        return float(self.accessible_areas.sum())

    @cached_property
    def geodesics(self) -> GeodesicDistances:
        """Distances along the closed surface by the heat method, factorised once."""
        return GeodesicDistances(self.mesh)

    @cached_property
    def marching(self) -> FastMarching:
        """Distances along the closed surface by fast marching, which can stop early."""
        return FastMarching(self.mesh)

    @cached_property
    def accessible_gram(self) -> Floats:
        """Inner products of the harmonics over the accessible area, shape (k, k).

        The identity where all is accessible; its leading block is that of the leading harmonics.
        """
        if self.accessible.all():
            return np.eye(self.basis.n_modes)
        hidden = ~self.accessible
        inaccessible = self.basis.modes[hidden] * np.sqrt(self.basis.areas[hidden])[:, None]
        gram: Floats = np.eye(self.basis.n_modes) - inaccessible.T @ inaccessible
        return gram

    def mean(self, values: PerVertex) -> float:
        """Mean over the accessible area."""
        return float(self.accessible_areas @ values / self.accessible_area)

    def rms(self, values: PerVertex) -> float:
        """Root mean square over the accessible area."""
        return float(np.sqrt(self.accessible_areas @ values**2 / self.accessible_area))

    def nrmse(self, values: PerVertex, truth: PerVertex) -> float:
        """Area-weighted RMS error relative to the true map's deviation from its mean."""
        return self.rms(values - truth) / self.rms(truth - self.mean(truth))


def chamber(surface: Mesh, n_modes: int, *, seed: int = 1, progress: Progress = silent) -> Chamber:
    """Close a surface and solve for its harmonics.

    Parameters
    ----------
    surface
        One sound piece, with or without holes.
    n_modes
        How many harmonics, the constant one included.
    seed
        Of the eigensolver.
    progress
        Told the number of harmonics found.

    Raises
    ------
    SurfaceError
        If the surface is unsound or its holes are too large to close.
    SolverError
        If the harmonics miss their certificate.

    Examples
    --------
    >>> from auricle.surface.shapes import icosphere
    >>> ball = chamber(icosphere(radius=10.0, subdivisions=2), 9)
    >>> bool(ball.accessible.all()), ball.basis.n_modes
    (True, 9)
    """
    capped = cap_holes(surface)
    basis = manifold_harmonics(capped.mesh, n_modes, seed=seed, progress=progress)
    return Chamber(capped.mesh, basis, capped.original)
