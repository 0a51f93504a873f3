"""The results of a study's cases, read back in the order of the study."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from auricle.study.cohort.case import Case
from auricle.study.cohort.case_files import CaseFiles


@dataclass(frozen=True, eq=False)
class KeptCase:
    """A finished case.

    Attributes
    ----------
    case
        Its name, source and key.
    values
        What was found; ``case`` is the name, which tells it from all others of the study.
    timings
        Seconds by stage.
    """

    case: Case
    values: dict[str, Any]
    timings: dict[str, float]


@dataclass(frozen=True, eq=False)
class Cohort:
    """All that is on disk of a study.

    Attributes
    ----------
    finished
        Cases with a result.
    missing
        Cases without, and why, in one line each.
    """

    finished: tuple[KeptCase, ...]
    missing: tuple[tuple[Case, str], ...]


def gather(cases: Sequence[Case], folder: Path) -> Cohort:
    """What the folder of a study holds of its cases."""
    files = CaseFiles(folder)
    by_key = {case.key: case for case in cases}.values()
    finished = tuple(
        KeptCase(case, {"case": case.name, **files.values(case.key)}, files.timings(case.key))
        for case in by_key
        if files.is_finished(case.key)
    )
    there = {kept.case.key for kept in finished}
    missing = tuple(
        (case, files.failure(case.key) or "not computed yet")
        for case in by_key
        if case.key not in there
    )
    return Cohort(finished, missing)
