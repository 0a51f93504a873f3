"""A study's cases, each computed once: resumed, shared out, with failures kept beside results."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

from auricle.study.cohort.case import Case
from auricle.study.cohort.case_files import CaseFiles
from auricle.study.cohort.execution import Outcome, Work


class Crew(Protocol):
    """Those who do the work, here or on a cluster."""

    def outcomes(self, cases: Sequence[Case], work: Callable[[Case], Outcome]) -> Iterator[Outcome]:
        """Outcomes of all cases, as they come."""


@dataclass(frozen=True)
class Standing:
    """Where a study stands when a case has ended.

    Attributes
    ----------
    case
        The one that ended.
    outcome
        How.
    n_done, n_total
        Cases that have ended, those found finished included, and all of them.
    seconds_left
        For the rest, at the pace so far, s.
    """

    case: Case
    outcome: Outcome
    n_done: int
    n_total: int
    seconds_left: float


def unheard(standing: Standing) -> None:
    """Take no notice."""


@dataclass(frozen=True)
class Tally:
    """How the cases of a run ended.

    Attributes
    ----------
    found
        Cases that had their result before.
    computed
        Cases that got it now.
    failed
        Cases without, and why.
    """

    found: tuple[Case, ...]
    computed: tuple[Case, ...]
    failed: tuple[tuple[Case, str], ...]


def run_cases(
    cases: Sequence[Case],
    work: Work,
    crew: Crew,
    *,
    tell: Callable[[Standing], None] = unheard,
) -> Tally:
    """Compute the cases that have no result yet; a failed one is tried again, once a run.

    Whatever interrupts this, a later call with the same folder goes on where it stood.

    Parameters
    ----------
    cases
        Of this run; equal keys are computed once.
    work
        What is done with a case.
    crew
        Who does it.
    tell
        Told each case that ends.

    Raises
    ------
    OutputError
        If results cannot be written.
    """
    files = CaseFiles(work.folder)
    by_key = {case.key: case for case in cases}
    finished = {key for key in by_key if files.is_finished(key)}
    pending = [case for case in by_key.values() if case.key not in finished]
    ended: dict[str, Outcome] = {}
    start = time.monotonic()
    for outcome in crew.outcomes(pending, work):
        case = by_key[outcome.key]
        if outcome.error is not None:
            files.keep_failure(case.key, name=case.name, error=outcome.error)
        ended[outcome.key] = outcome
        pace = (time.monotonic() - start) / len(ended)
        left = pace * (len(pending) - len(ended))
        tell(Standing(case, outcome, len(finished) + len(ended), len(by_key), left))
    return Tally(
        tuple(case for case in by_key.values() if case.key in finished),
        tuple(case for case in pending if ended[case.key].error is None),
        tuple((case, error) for case in pending if (error := ended[case.key].error)),
    )
