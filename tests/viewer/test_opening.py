"""Every path auricle knows opens as what it is, and nobody's name is shown."""

import json
from pathlib import Path

import numpy as np
import pytest

from auricle.electroanatomy.points import MappingPoints
from auricle.electroanatomy.study import ElectroanatomicMap
from auricle.errors import InputError
from auricle.surface.field import FieldMap
from auricle.surface.shapes import icosphere
from auricle.surface.writing import write_surface
from auricle.viewer.open_case import OpenCase, OpenStudy, recordings_of
from auricle.viewer.opening import Detail, open_path
from auricle.viewer.workspace import Workspace

SMALL = Detail(n_vertices=400, n_modes=40)


@pytest.fixture
def workspace(tmp_path: Path) -> Workspace:
    return Workspace(tmp_path / "uploads")


@pytest.fixture
def surface(tmp_path: Path) -> Path:
    ball = icosphere(radius=20.0, subdivisions=3)
    place = tmp_path / "ball.vtp"
    write_surface(place, ball, [FieldMap(ball, ball.vertices[:, 0], "LAT", "ms")], space="LPS")
    return place


def test_a_surface_opens_with_its_fields(workspace: Workspace, surface: Path) -> None:
    open_path(workspace, surface, SMALL)
    case = workspace.require(OpenCase, "no surface")
    assert case.prepared.surface.n_vertices == 400
    assert case.prepared.chamber.basis.n_modes == 40
    told = workspace.described()
    assert (told["name"], told["views"]) == ("ball.vtp", ["explore", "plan"])
    assert told["case"]["fields"] == [{"name": "LAT", "unit": "ms"}]
    assert told["case"]["space"] == "LPS"
    json.dumps(told, allow_nan=False)


def test_a_coarse_surface_opens_with_the_harmonics_it_carries(
    workspace: Workspace, tmp_path: Path
) -> None:
    write_surface(tmp_path / "coarse.ply", icosphere(radius=20.0, subdivisions=1))
    open_path(workspace, tmp_path / "coarse.ply")
    assert workspace.require(OpenCase, "none").prepared.chamber.basis.n_modes in range(10, 42)


def test_a_reconstruction_opens_with_its_samples_to_play_back(
    workspace: Workspace, surface: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "map"
    folder.mkdir()
    (folder / "map.vtp").write_bytes(surface.read_bytes())
    (folder / "samples.csv").write_text("x_mm,y_mm,z_mm,LAT_ms\n20,0,0,5\n0,20,0,6\n")
    parameters = {"value": "LAT", "cycle_length_ms": 200.0}
    (folder / "result.json").write_text(json.dumps({"parameters": parameters}))
    open_path(workspace, folder, SMALL)
    (recording,) = workspace.require(OpenCase, "none").recordings
    assert recording.samples.values.tolist() == [5.0, 6.0]
    assert (recording.samples.unit, recording.cycle_length) == ("ms", 200.0)


@pytest.mark.parametrize("name", ["absent.vtp", "table.csv", "folder", "result"])
def test_what_cannot_be_opened_leaves_everything_as_it_was(
    workspace: Workspace, surface: Path, tmp_path: Path, name: str
) -> None:
    (tmp_path / "table.csv").write_text("x,y,z,LAT\n1,2,3,4\n")
    (tmp_path / "folder").mkdir()
    (tmp_path / "result").mkdir()
    (tmp_path / "result" / "result.json").write_text("{}")
    open_path(workspace, surface, SMALL)
    before = workspace.require(OpenCase, "none")
    with pytest.raises(InputError) as caught:
        open_path(workspace, tmp_path / name, SMALL)
    assert str(caught.value).startswith(f"{tmp_path / name}: ")
    assert ": " in str(caught.value).removeprefix(f"{tmp_path / name}: ")
    assert workspace.find(OpenCase) is before
    assert workspace.name == "ball.vtp"


def test_points_are_played_back_in_the_order_of_their_numbers() -> None:
    points = MappingPoints(
        positions=np.arange(12.0).reshape(4, 3),
        local_activation_time=np.array([10.0, 20.0, np.nan, 40.0]),
        bipolar_voltage=np.array([1.0, 2.0, 3.0, 4.0]),
        identifiers=np.array([3, 1, 2, 4]),
        included=np.array([True, True, True, False]),
    )
    found = {
        each.samples.name: each
        for each in recordings_of(ElectroanatomicMap("1", points=points, cycle_length=200.0))
    }
    assert found["local_activation_time"].samples.values.tolist() == [20.0, 10.0]
    assert found["bipolar_voltage"].samples.values.tolist() == [2.0, 3.0, 1.0]
    assert found["local_activation_time"].cycle_length == 200.0
    assert found["bipolar_voltage"].cycle_length is None


@pytest.mark.slow
def test_a_real_export_opens_and_plays_back(workspace: Workspace, real_data: Path) -> None:
    open_path(
        workspace, real_data / "maps" / "carto3-export" / "carto_flat.zip", Detail(2_000, 100)
    )
    assert workspace.require(OpenStudy, "none").described()["study"]["maps"]
    told = workspace.described()
    assert told["case"]["recordings"]
    assert told["name"].endswith("export")
