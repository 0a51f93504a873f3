"""A small surface with fields on disk, and the program run as a user runs it."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere
from auricle.surface.writing import write_surface

Run = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture(scope="session")
def auricle() -> Run:
    """Runs `auricle ARGUMENTS…` in a process of its own."""

    def run(*arguments: object, **environment: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "auricle", *map(str, arguments)],
            capture_output=True,
            text=True,
            timeout=300,
            env={**os.environ, "COLUMNS": "200", "NO_COLOR": "1", **environment},
            check=False,
        )

    return run


def bumpy_sphere() -> Mesh:
    """About the size of an atrium, without symmetry, 642 vertices."""
    sphere = icosphere(radius=30.0, subdivisions=3)
    x, y, z = sphere.vertices.T / 30
    return Mesh(sphere.vertices * (1 + 0.15 * x * y + 0.1 * z**3)[:, None], sphere.faces)


@pytest.fixture(scope="session")
def surface(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A surface with a smooth field in ms, one with NaN, one constant and one without values."""
    mesh = bumpy_sphere()
    smooth = 80 + mesh.vertices[:, 0] + 0.02 * mesh.vertices[:, 1] ** 2
    holed = np.where(mesh.vertices[:, 2] > 20, np.nan, np.cos(mesh.vertices[:, 0] / 10))
    place = tmp_path_factory.mktemp("surface") / "chamber.vtp"
    write_surface(
        place,
        mesh,
        [
            FieldMap(mesh, smooth, "local_activation_time", "ms"),
            FieldMap(mesh, holed, "bipolar_voltage", "mV"),
            FieldMap(mesh, np.full(len(smooth), 7.0), "constant"),
            FieldMap(mesh, np.full(len(smooth), np.nan), "nothing"),
        ],
    )
    return place
