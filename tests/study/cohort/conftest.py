"""Stand-ins for the computation of a case, in a module that worker processes find too."""

import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest

STAND_INS = '''
import hashlib, os, time
from dataclasses import dataclass
from pathlib import Path
from auricle.errors import InputError


@dataclass(frozen=True)
class Parameters:
    seconds: float = 0.0
    rounds: int = 3


@dataclass(frozen=True)
class Document:
    values: dict
    timings: dict


def digest(source, *, parameters):
    """A hash for a result, found by work that takes a while; "bad" and "deadly" inputs."""
    text = source.read_text()
    if text.startswith("bad"):
        raise InputError(f"{source}: bad from the first line: export it again")
    if text.startswith("fault"):
        raise ZeroDivisionError("by nought")
    if text.startswith("deadly"):
        os._exit(7)
    start = time.perf_counter()
    time.sleep(parameters.seconds)
    for _ in range(parameters.rounds):
        text = hashlib.sha256(text.encode()).hexdigest()
    threads = os.environ.get("OMP_NUM_THREADS")
    values = {"digest": text, "name": source.name, "threads": threads, "n": len(source.read_text())}
    return Document(values, {"hash": time.perf_counter() - start})
'''


@pytest.fixture
def stand_ins(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    """Module with `Parameters` and the case function `digest`."""
    folder = tmp_path / "modules"
    folder.mkdir()
    (folder / "case_stand_ins.py").write_text(STAND_INS)
    monkeypatch.syspath_prepend(folder)
    yield import_module("case_stand_ins")
    del sys.modules["case_stand_ins"]


@pytest.fixture
def inputs(tmp_path: Path) -> Path:
    """A folder of twenty inputs."""
    folder = tmp_path / "inputs"
    folder.mkdir()
    for index in range(20):
        (folder / f"atrium{index:02}.vtp").write_text(f"surface {index}\\n" * (index + 1))
    return folder
