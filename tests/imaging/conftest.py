"""Small CT volumes, and DICOM series of them to be spoilt."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pydicom
import pytest

from auricle.errors import FormatError
from auricle.imaging.dicom_writing import write_dicom_series
from auricle.imaging.reading import read_volume
from auricle.imaging.volume import Volume

Edit = Callable[[Any], None]


@pytest.fixture
def oblique_affine() -> np.ndarray:
    """Axes turned about three angles, 0.5 × 0.6 × 0.7 mm, far from the origin; right-handed."""
    affine = np.eye(4)
    turn = np.eye(3)
    for axis, angle in enumerate(np.radians([10, 20, -30])):
        rotation = np.eye(3)
        first, second = (axis + 1) % 3, (axis + 2) % 3
        rotation[[first, second], [first, second]] = np.cos(angle)
        rotation[first, second] = -np.sin(angle)
        rotation[second, first] = np.sin(angle)
        turn = turn @ rotation
    affine[:3, :3] = turn * [0.5, 0.6, 0.7]
    affine[:3, 3] = [-123.456, 77.7, 1234.5]
    return affine


@pytest.fixture(scope="session")
def straight_affine() -> np.ndarray:
    """Axial slices of 0.5 × 0.5 mm, 1 mm apart."""
    affine = np.diag([0.5, 0.5, 1.0, 1.0])
    affine[:3, 3] = [-10.0, -20.0, 300.0]
    return affine


@pytest.fixture(scope="session")
def small_volume(straight_affine: np.ndarray) -> Volume:
    """Eight by seven by ten voxels of noise from air to bone, no two slices alike."""
    voxels = np.random.default_rng(5).integers(-1024, 1500, (8, 7, 10), dtype=np.int16)
    return Volume(voxels, straight_affine)


@pytest.fixture(scope="session")
def ct_files(tmp_path_factory: pytest.TempPathFactory, small_volume: Volume) -> dict[str, bytes]:
    """`small_volume` as ten DICOM slices, IM0001.dcm to IM0010.dcm: their bytes by name."""
    folder = tmp_path_factory.mktemp("written") / "ct"
    write_dicom_series(small_volume, folder)
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture
def ct_folder(tmp_path: Path, ct_files: dict[str, bytes]) -> Path:
    """A folder of its own with the files of `ct_files`."""
    folder = tmp_path / "ct"
    folder.mkdir()
    for name, content in ct_files.items():
        (folder / name).write_bytes(content)
    return folder


@pytest.fixture
def edit() -> Callable[..., None]:
    """Change tags of DICOM files: ``edit(paths, lambda dataset: …)``, or copy with changes."""

    def change(paths: Path | list[Path], spoil: Edit, *, into: Path | None = None) -> None:
        for path in [paths] if isinstance(paths, Path) else paths:
            dataset = pydicom.dcmread(path)
            spoil(dataset)
            target = path if into is None else into / path.name
            target.parent.mkdir(parents=True, exist_ok=True)
            dataset.save_as(target, enforce_file_format=True)

    return change


@pytest.fixture
def fault_of() -> Callable[..., str]:
    """The one line a folder is refused with, its path taken off: ``fault_of(folder)``."""

    def refused(folder: Path, **options: int) -> str:
        with pytest.raises(FormatError) as caught:
            read_volume(folder, **options)
        text = str(caught.value)
        assert text.startswith(f"{folder}: ")
        assert text.isprintable()
        return text.removeprefix(f"{folder}: ")

    return refused
