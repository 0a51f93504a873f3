"""At a rim the closed surface's harmonics carry a map's slope, the open one's cannot."""

import numpy as np
import pytest

from auricle.arrays import Floats
from auricle.sampling.chamber import Chamber, chamber
from auricle.sampling.gaussian_process import GaussianProcess
from auricle.sampling.sites import Sites
from auricle.spectral.harmonics import manifold_harmonics
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere

CUT = 15.0
"""Height at which the top of a sphere of radius 30 is cut off, mm."""


def cut_sphere() -> Mesh:
    whole = icosphere(radius=30.0, subdivisions=4)
    faces = whole.faces[(whole.vertices[whole.faces][:, :, 2] < CUT).all(axis=1)]
    used, local = np.unique(faces, return_inverse=True)
    return Mesh(whole.vertices[used], local.reshape(-1, 3))


@pytest.fixture(scope="module")
def surface() -> Mesh:
    return cut_sphere()


def rim_error(where: Chamber, surface: Mesh) -> float:
    """RMS error within 6 mm of the rim, of a map that is linear in height."""
    n_vertices = surface.n_vertices
    truth = surface.vertices[:, 2]
    chosen = np.random.default_rng(3).choice(n_vertices, 150, replace=False)
    found = GaussianProcess(where, Sites.at_vertices(chosen)).fit(truth[chosen])
    near: Floats = np.flatnonzero(truth > CUT - 6.0)
    return float(np.sqrt(np.square(found.mean[:n_vertices] - truth)[near].mean()))


def test_the_closed_basis_errs_less_at_the_rim(surface: Mesh) -> None:
    closed = chamber(surface, 144)
    everywhere = np.ones(surface.n_vertices, dtype=bool)
    opened = Chamber(surface, manifold_harmonics(surface, 144), everywhere)
    assert rim_error(closed, surface) < 0.6 * rim_error(opened, surface)
