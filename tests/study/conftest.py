"""A small chamber on disk, and samples of a smooth map of it as a table."""

from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh
from auricle.surface.reading import read_surface
from auricle.surface.shapes import icosphere
from auricle.surface.writing import write_surface


def chamber_mesh() -> Mesh:
    """About the size of an atrium, without symmetry, 642 vertices."""
    sphere = icosphere(radius=30.0, subdivisions=3)
    x, y, z = sphere.vertices.T / 30
    return Mesh(sphere.vertices * (1 + 0.15 * x * y + 0.1 * z**3)[:, None], sphere.faces)


def times_at(positions: np.ndarray) -> np.ndarray:
    """A smooth activation map, ms."""
    x, y, z = positions.T / 30
    return 100 + 30 * x + 20 * y * z


@pytest.fixture(scope="session")
def chamber_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A closed surface with a smooth map, a region of its left half, and a vector."""
    mesh = chamber_mesh()
    place = tmp_path_factory.mktemp("chamber") / "chamber.vtp"
    fields = [
        FieldMap(mesh, times_at(mesh.vertices), "LAT", "ms"),
        FieldMap(mesh, (mesh.vertices[:, 0] > 0).astype(float), "left"),
        FieldMap(mesh, np.ones(mesh.n_vertices), "everywhere"),
        FieldMap(mesh, mesh.vertices, "direction"),
    ]
    write_surface(place, mesh, fields)
    return place


@pytest.fixture(scope="session")
def _harmonics(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("harmonics")


_read_once = cache(read_surface)


@pytest.fixture(scope="module")
def solved_once(_harmonics: Path) -> Iterator[None]:
    """A chamber is read, and its harmonics are solved, once for all tests."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("AURICLE_CACHE", str(_harmonics))
        patch.setattr("auricle.study.preparation.read_surface", _read_once)
        yield


@pytest.fixture(scope="session")
def truth() -> Callable[[np.ndarray], np.ndarray]:
    """The map that the chamber holds, by position."""
    return times_at


@pytest.fixture
def table(tmp_path: Path) -> Callable[..., Path]:
    """Writes samples as CSV: positions in mm, LAT in ms, and a column ``sd`` if given."""

    def written(positions: np.ndarray, values: np.ndarray, *further: np.ndarray) -> Path:
        rows = np.column_stack([positions, values, *further])
        header = "x_mm,y_mm,z_mm,LAT_ms" + ",sd_ms" * len(further)
        path = tmp_path / "samples.csv"
        np.savetxt(path, rows, delimiter=",", header=header, comments="", fmt="%.9g")
        return path

    return written
