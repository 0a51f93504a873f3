"""A study as its author writes it: ``study.toml``, every key checked, unknown ones refused."""

import os
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from auricle.errors import InputError
from auricle.study.cohort.sources import expanded, is_generated

DATA_VARIABLE = "AURICLE_DATA"
"""Environment variable naming the folder of the cases that begin with ``$AURICLE_DATA/``."""

_TEXTS = ("title", "description", "licence")
_LISTS = ("cases", "optional_cases")
_TABLE = "parameters"


@dataclass(frozen=True)
class Study:
    """What shall be computed on which cases.

    Attributes
    ----------
    sources
        The cases: files, folders of one scan, or generated ones, in the order of the file.
    title, description, licence
        Words for the report and the crate; the licence is that of the inputs.
    parameters
        The table ``[parameters]`` as it was written, not checked yet.
    remarks
        What was left out, for the user to know.
    """

    sources: tuple[str, ...]
    title: str = "A study of left atria"
    description: str = ""
    licence: str = ""
    parameters: Mapping[str, Any] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()


def chosen_study(entries: Sequence[str]) -> Study:
    """The study of one TOML file, or of the cases that paths and generated ones stand for.

    Raises
    ------
    InputError
        As `read_study`, or if an entry stands for nothing.
    """
    if len(entries) == 1 and entries[0].lower().endswith(".toml"):
        return read_study(Path(entries[0]))
    return Study(expanded(entries))


def read_study(path: Path) -> Study:
    """The study a TOML file describes.

    ::

        title = "Twenty atria"
        cases = ["atria/*.vtp", "scans/patient1", "phantom:seed=1..7,preset=medium"]
        optional_cases = ["$AURICLE_DATA/meshes/*.vtk"]

        [parameters]
        n_vertices = 10000

    Paths are relative to the file, or to the folder named by ``AURICLE_DATA``. Optional cases are
    left out, with a remark, where that variable is not set.

    Raises
    ------
    InputError
        If the file cannot be read, is not TOML, or has an unknown key, a value of another kind,
        or a case that does not exist; the message names the file and the key.
    """
    table = _table(path)
    _require_known(path, table)
    try:
        sources = expanded(_placed(table.get("cases", []), path.parent))
        more, remarks = _optional(table.get("optional_cases", []), path.parent)
    except InputError as fault:
        raise InputError(f"{path}: {fault}") from fault
    together = tuple(dict.fromkeys((*sources, *more)))
    if not together:
        raise InputError(f"{path}: no cases: give a list `cases` of paths or generated cases")
    texts = {key: table[key] for key in _TEXTS if key in table}
    return Study(together, **texts, parameters=table.get(_TABLE, {}), remarks=remarks)


def _table(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as fault:
        raise InputError(f"{path}: {fault.strerror}: give a TOML file") from fault
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as fault:
        raise InputError(f"{path}: not TOML ({fault}): correct it") from fault


def _require_known(path: Path, table: Mapping[str, Any]) -> None:
    known = (*_TEXTS, *_LISTS, _TABLE)
    for key, value in table.items():
        if key not in known:
            raise InputError(f"{path}: unknown key {key!r}: a study has {', '.join(known)}")
        if key in _TEXTS and not isinstance(value, str):
            raise InputError(f"{path}: {key}: is no text: put it in quotes")
        if key in _LISTS and not (
            isinstance(value, list) and all(isinstance(each, str) for each in value)
        ):
            raise InputError(f'{path}: {key}: is no list of texts: write {key} = ["…", "…"]')
        if key == _TABLE and not isinstance(value, dict):
            raise InputError(f"{path}: {key}: is no table: begin it with [{key}]")


def _optional(patterns: Sequence[str], base: Path) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Optional cases whose folder is there, and a remark on the others."""
    there = [each for each in patterns if not _of_data(each) or os.environ.get(DATA_VARIABLE)]
    left = len(patterns) - len(there)
    remark = f"{left} optional entries left out: set {DATA_VARIABLE} to have their cases too"
    return expanded(_placed(there, base)), (remark,) if left else ()


def _placed(patterns: Sequence[str], base: Path) -> list[str]:
    return [_from_data(each) if _of_data(each) else _from_base(each, base) for each in patterns]


def _of_data(pattern: str) -> bool:
    return pattern.startswith(f"${DATA_VARIABLE}/")


def _from_data(pattern: str) -> str:
    folder = os.environ.get(DATA_VARIABLE)
    if not folder:
        raise InputError(f"{pattern}: {DATA_VARIABLE} is not set: name the folder of the data")
    return str(Path(folder) / pattern.partition("/")[2])


def _from_base(pattern: str, base: Path) -> str:
    return pattern if is_generated(pattern) else str(base / pattern)
