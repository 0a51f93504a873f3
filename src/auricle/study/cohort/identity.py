"""What a case's result depends on, as one hash: its input, its parameters and the code."""

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import Any

import auricle
from auricle.errors import InputError
from auricle.study.cohort.case import Case
from auricle.study.cohort.sources import case_names, is_generated
from auricle.study.provenance import versions

NOT_OF_A_CASE = (
    "cli/",
    "report/",
    "viewer/",
    "study/cohort/",
    "study/paper/claims.py",
    "study/paper/comparisons.py",
    "study/paper/decay_readings.py",
    "study/paper/printed.py",
    "study/paper/reproduction.py",
    "study/paper/statistics.py",
    "study/paper/tables.py",
)
"""Rooms and files that only look at finished cases, so that no case computes with them."""

_COMPANIONS = {
    ".pts": (".elem", ".dat"),
    ".elem": (".pts", ".dat"),
    ".mhd": (".raw", ".zraw"),
    ".nhdr": (".raw", ".gz"),
}
"""Suffixes of the files that belong to a file of this suffix, their names beginning like its."""


def identified(
    sources: Sequence[str], parameters: Any, *, among: Sequence[str] = ()
) -> tuple[Case, ...]:
    """The cases of a study with their names and keys.

    Parameters
    ----------
    sources
        Files, folders, generated cases.
    parameters
        A frozen dataclass of plain values.
    among
        All cases of the study, which the names shall tell apart; by default `sources`.

    Raises
    ------
    InputError
        If an input cannot be read.
    """
    every = among or sources
    names = dict(zip(every, case_names(every), strict=True))
    shared = {"parameters": asdict(parameters), "versions": versions(), "code": code_digest()}
    return tuple(Case(names[source], source, _key(source, shared)) for source in sources)


def _key(source: str, shared: Mapping[str, Any]) -> str:
    name = source if is_generated(source) else Path(source).name
    content = {"name": name, "input": input_digest(source), **shared}
    text = json.dumps(content, sort_keys=True, ensure_ascii=False, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def input_digest(source: str) -> str:
    """SHA-256 of a generated case's words, of a file with those that belong to it, of a folder.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    if is_generated(source):
        return hashlib.sha256(source.encode()).hexdigest()
    place = Path(source)
    digest = hashlib.sha256()
    try:
        for file in _files(place):
            with file.open("rb") as stream:
                content = hashlib.file_digest(stream, "sha256").hexdigest()
            name = file.relative_to(place).as_posix() if place.is_dir() else file.suffix
            digest.update(f"{name} {content}\n".encode())
    except OSError as fault:
        raise InputError(f"{source}: {fault.strerror}: correct the path") from fault
    return digest.hexdigest()


def _files(place: Path) -> Iterator[Path]:
    if place.is_dir():
        yield from sorted(each for each in place.rglob("*") if each.is_file())
        return
    yield place
    belonging = _COMPANIONS.get(place.suffix.lower(), ())
    if belonging:
        yield from sorted(
            each
            for each in place.parent.iterdir()
            if each.name.startswith(place.stem) and each.suffix.lower() in belonging
        )


@cache
def code_digest() -> str:
    """SHA-256 of the package's source that can enter a case: not of the page, not of the runner.

    Within one version it tells a result of changed code from one of the code at hand.
    """
    package = Path(auricle.__file__).parent
    digest = hashlib.sha256()
    for file in sorted(package.rglob("*.py")):
        name = file.relative_to(package).as_posix()
        if not name.startswith(NOT_OF_A_CASE):
            digest.update(f"{name}\n".encode())
            digest.update(file.read_bytes())
    return digest.hexdigest()
