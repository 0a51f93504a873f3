"""What ARCHITECTURE.md and pyproject.toml say of the code, held against the code."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "src" / "auricle"
MAP = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
LONGEST_FILE = 400
LINES_OF_THE_MAP = 140
QUOTED = re.compile(r"`([^`\n]+)`")
A_PATH = re.compile(r"[\w./-]+(\.(py|md|toml|cff|j2)|/)")


def rooms() -> list[str]:
    """Names of the folders of the package, sub-rooms included, as the map writes them."""
    folders = (module.parent for module in PACKAGE.rglob("__init__.py"))
    return sorted(folder.relative_to(PACKAGE).as_posix() for folder in folders if folder != PACKAGE)


def named_paths(text: str) -> list[str]:
    return [quote for quote in QUOTED.findall(text) if A_PATH.fullmatch(quote)]


def layers() -> list[str]:
    """Every name in the layers of the import contract, without the marks of optional ones."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    (contract,) = (
        contract
        for contract in settings["tool"]["importlinter"]["contracts"]
        if contract["type"] == "layers"
    )
    return [name for layer in contract["layers"] for name in re.findall(r"\w+", layer)]


def exists(path: str) -> bool:
    """Whether a path of the map, from the root or from the package, leads to something."""
    return (ROOT / path).exists() or (PACKAGE / path).exists()


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """A copy of the package and its contracts, to offend against."""
    pytest.importorskip("importlinter", reason="no import-linter: install the group `lint`")
    shutil.copytree(
        PACKAGE, tmp_path / "src" / "auricle", ignore=shutil.ignore_patterns("__pycache__")
    )
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    return tmp_path


def checked_imports(folder: Path) -> subprocess.CompletedProcess[str]:
    """What import-linter says of the copy of the package in `folder`."""
    program = "from importlinter.cli import lint_imports_command; lint_imports_command()"
    return subprocess.run(
        [sys.executable, "-P", "-c", program, "--no-cache", "--no-logo"],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(folder / "src"), "PYTHONIOENCODING": "utf-8"},
        capture_output=True,
        encoding="utf-8",
        timeout=60,
        check=False,
    )


def test_the_map_is_short_enough_to_be_read():
    assert len(MAP.splitlines()) <= LINES_OF_THE_MAP


def test_the_map_names_many_files():
    assert len(named_paths(MAP)) > 40


@pytest.mark.parametrize("path", sorted(set(named_paths(MAP))))
def test_every_file_the_map_names_exists(path):
    assert exists(path)


@pytest.mark.parametrize("room", rooms())
def test_every_room_is_on_the_map(room):
    assert f"`{room}`" in MAP


@pytest.mark.parametrize("module", sorted(path.name for path in PACKAGE.glob("[!_]*.py")))
def test_every_module_outside_the_rooms_is_on_the_map(module):
    assert f"`{module}`" in MAP


@pytest.mark.parametrize("room", sorted({room.partition("/")[0] for room in rooms()}))
def test_every_room_has_a_layer(room):
    assert room in layers()


def test_no_source_file_is_longer_than_a_person_reads():
    lengths = {
        path.relative_to(ROOT).as_posix(): len(path.read_text(encoding="utf-8").splitlines())
        for path in PACKAGE.rglob("*.py")
    }
    assert {path: lines for path, lines in lengths.items() if lines > LONGEST_FILE} == {}


def test_the_code_as_it_stands_keeps_its_contracts(copy):
    outcome = checked_imports(copy)
    assert outcome.returncode == 0, outcome.stdout


def test_an_import_upwards_breaks_the_contract(copy):
    offender = copy / "src" / "auricle" / "surface" / "mesh.py"
    offender.write_text(
        offender.read_text(encoding="utf-8") + "\nfrom auricle.spectral import power\n",
        encoding="utf-8",
    )
    outcome = checked_imports(copy)
    assert outcome.returncode != 0
    assert "auricle.surface is not allowed to import auricle.spectral" in outcome.stdout


def test_a_room_without_a_layer_breaks_the_contract(copy):
    room = copy / "src" / "auricle" / "helpers"
    room.mkdir()
    (room / "__init__.py").write_text('"""A room nobody placed."""\n', encoding="utf-8")
    outcome = checked_imports(copy)
    assert outcome.returncode != 0
    assert "auricle.helpers" in outcome.stdout


def test_drawing_outside_the_report_breaks_the_contract(copy):
    offender = copy / "src" / "auricle" / "sampling" / "criteria.py"
    offender.write_text(
        offender.read_text(encoding="utf-8") + "\nimport matplotlib\n", encoding="utf-8"
    )
    outcome = checked_imports(copy)
    assert outcome.returncode != 0
    assert "only report draws BROKEN" in outcome.stdout
