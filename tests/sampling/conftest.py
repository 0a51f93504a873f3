"""Chambers that several tests of sampling need."""

import numpy as np
import pytest

from auricle.sampling.chamber import Chamber, chamber
from auricle.simulation.anatomy import AtriumShape
from auricle.simulation.atrium import atrium
from auricle.surface.shapes import icosphere


@pytest.fixture(scope="session")
def sphere_chamber() -> Chamber:
    """Sphere of radius 30 mm, 642 vertices, the 144 harmonics of degree 11 and less."""
    return chamber(icosphere(radius=30.0, subdivisions=3), 144)


@pytest.fixture(scope="session")
def open_chamber(sphere_chamber: Chamber) -> Chamber:
    """The same sphere with its top, above 20 mm, out of reach."""
    accessible = sphere_chamber.mesh.vertices[:, 2] < 20.0
    return Chamber(sphere_chamber.mesh, sphere_chamber.basis, np.asarray(accessible))


@pytest.fixture(scope="session")
def atrium_chamber() -> Chamber:
    """A generated atrium of 2,374 vertices and 150 harmonics, all of it accessible."""
    shape = AtriumShape.random(np.random.default_rng(1))
    return chamber(atrium(shape, spacing=3.0), 150)


@pytest.fixture(scope="session")
def fine_chamber() -> Chamber:
    """Sphere of radius 30 mm, 2,562 vertices, the 256 harmonics of degree 15 and less."""
    return chamber(icosphere(radius=30.0, subdivisions=4), 256)


@pytest.fixture(scope="session")
def cut_chamber(fine_chamber: Chamber) -> Chamber:
    """The same with its top, above 20 mm, out of reach."""
    accessible = fine_chamber.mesh.vertices[:, 2] < 20.0
    return Chamber(fine_chamber.mesh, fine_chamber.basis, np.asarray(accessible))
